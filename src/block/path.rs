//! Axis of a connector: a polyline of sections with rotation-minimizing frames.

use anastomesh_mesh::geometry::{Point3, Section, Vec3};

/// Axis of a vessel by arc length, with a frame that does not twist.
#[derive(Clone, Debug)]
pub struct AxisPath {
    stations: Vec<Station>,
    /// First frame vector of the last section.
    last_u: Vec3,
}

#[derive(Clone, Copy, Debug)]
struct Station {
    s: f64,
    origin: Point3,
    axis: Vec3,
    u: Vec3,
    radius: f64,
}

/// Position on the axis with its frame.
#[derive(Clone, Copy, Debug)]
pub struct AxisFrame {
    /// Point on the axis.
    pub origin: Point3,
    /// Unit tangent.
    pub axis: Vec3,
    /// First unit vector normal to the axis.
    pub u: Vec3,
    /// Second unit vector normal to the axis, `axis × u`.
    pub w: Vec3,
    /// Vessel radius.
    pub radius: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// Arc length 0.
    Start,
    /// Full length.
    End,
}

impl AxisPath {
    /// Creates frames along sections. Returns `None` for fewer than two sections or zero length.
    pub fn new(sections: &[Section]) -> Option<Self> {
        let (first, last) = (sections.first()?, sections.last()?);
        let station = |s: f64, x: &Section, u: Vec3| Station { s, origin: x.origin, axis: x.axis, u, radius: x.radius };
        let mut stations = vec![station(0.0, first, first.frame().0)];
        for next in &sections[1..] {
            let last = stations[stations.len() - 1];
            let step = next.origin - last.origin;
            let length = step.norm();
            if length > 1e-12 * next.radius {
                stations.push(station(last.s + length, next, transport(&last, next.axis, step)));
            }
        }
        (stations.len() > 1).then(|| Self { stations, last_u: last.frame().0 })
    }

    /// Length of the axis between its first and last section.
    pub fn length(&self) -> f64 {
        self.stations[self.stations.len() - 1].s
    }

    /// Length in radii up to each station: ∫ ds / r.
    pub fn radii(&self) -> Vec<f64> {
        let pieces = self.stations.windows(2).scan(0.0, |sum, pair| {
            *sum += radii_between(&pair[0], &pair[1]);
            Some(*sum)
        });
        std::iter::once(0.0).chain(pieces).collect()
    }

    /// Arc length at a length in radii; `radii` is the result of the function `radii`.
    pub fn arc_of(&self, radii: &[f64], sought: f64) -> f64 {
        let k = radii.partition_point(|&x| x <= sought).clamp(1, radii.len() - 1);
        let [a, b] = [&self.stations[k - 1], &self.stations[k]];
        let of_piece = ((sought - radii[k - 1]) / (radii[k] - radii[k - 1])).clamp(0.0, 1.0);
        a.s + (b.s - a.s) * share(a.radius, b.radius, of_piece)
    }

    /// Angle between the transported frame and that of the last section, about the axis.
    pub fn twist(&self) -> f64 {
        let last = &self.stations[self.stations.len() - 1];
        libm::atan2(self.last_u.dot(&last.axis.cross(&last.u)), self.last_u.dot(&last.u))
    }

    /// Position at arc length `s`; extrapolated straight beyond the ends.
    pub fn at(&self, s: f64) -> AxisFrame {
        let k = self.stations.partition_point(|x| x.s <= s).clamp(1, self.stations.len() - 1);
        let (a, b) = (&self.stations[k - 1], &self.stations[k]);
        let t = (s - a.s) / (b.s - a.s);
        let c = t.clamp(0.0, 1.0);
        let axis = (a.axis * (1.0 - c) + b.axis * c).normalize();
        let along = if t < 0.0 { a.axis * (s - a.s) } else { b.axis * (s - b.s).max(0.0) };
        let origin = a.origin + (b.origin - a.origin) * c + along;
        let u = a.u * (1.0 - c) + b.u * c;
        let u = (u - axis * axis.dot(&u)).normalize();
        AxisFrame { origin, axis, u, w: axis.cross(&u), radius: a.radius + (b.radius - a.radius) * c }
    }

    /// Arc length, angle and distance from the axis of a point near an end.
    pub fn locate(&self, p: &Point3, end: PathEnd) -> (f64, f64, f64) {
        let s0 = if end == PathEnd::Start { 0.0 } else { self.length() };
        let place = self.at(s0);
        let d = p - place.origin;
        let (x, y) = (d.dot(&place.u), d.dot(&place.w));
        (s0 + d.dot(&place.axis), libm::atan2(y, x), libm::hypot(x, y))
    }
}

impl AxisFrame {
    /// Point at an angle and a distance from the axis.
    pub fn point(&self, theta: f64, distance: f64) -> Point3 {
        self.origin + (self.u * libm::cos(theta) + self.w * libm::sin(theta)) * distance
    }
}

/// Length in radii between two stations for a linear radius: l ln(b / a) / (b − a), by a series if nearly equal.
fn radii_between(from: &Station, to: &Station) -> f64 {
    let (length, ratio) = (to.s - from.s, to.radius / from.radius);
    let x = ratio - 1.0;
    let mean = if x.abs() < 1e-5 { 1.0 - x / 2.0 + x * x / 3.0 } else { libm::log(ratio) / x };
    length / from.radius * mean
}

/// Fraction of the arc length between two radii that corresponds to a fraction of the length in radii.
fn share(a: f64, b: f64, of_radii: f64) -> f64 {
    let ratio = b / a;
    if (ratio - 1.0).abs() < 1e-5 { of_radii } else { (libm::pow(ratio, of_radii) - 1.0) / (ratio - 1.0) }
}

/// Transports a frame vector to the next station by two reflections (Wang, Jüttler, Zheng, Liu 2008).
fn transport(from: &Station, axis: Vec3, step: Vec3) -> Vec3 {
    let reflect = |x: Vec3, v: Vec3| {
        let n2 = v.norm_squared();
        if n2 > 0.0 { x - v * (2.0 * v.dot(&x) / n2) } else { x }
    };
    let (u, t) = (reflect(from.u, step), reflect(from.axis, step));
    let u = reflect(u, axis - t);
    (u - axis * axis.dot(&u)).normalize()
}
