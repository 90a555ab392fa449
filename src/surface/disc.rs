//! Flat disc in a regular ring: concentric rings of points, triangulated by constrained Delaunay (spade).

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Mean edge length of a relaxed wall relative to the target edge length.
pub(super) const MEAN_EDGE: f64 = 0.92;
/// Minimum number of ring corners.
const LEAST_CORNERS: u32 = 8;

/// Triangulated disc in its plane. The first points are the ring, counter-clockwise from angle `phase`.
#[derive(Clone, Debug)]
pub(super) struct Disc {
    /// Points in the plane.
    pub points: Vec<[f64; 2]>,
    /// Triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

/// Circumradius of a regular polygon with the area of a circle.
pub(crate) fn ring_radius(radius: f64, corners: u32) -> f64 {
    let t = TAU / f64::from(corners);
    radius * (t / libm::sin(t)).sqrt()
}

/// Number of cached triangulations: rings with fewer corners share theirs.
const KEPT: usize = 128;

/// Returns the disc of `radius` whose ring has `corners` points, filled at the ring's spacing. Returns `None` if the
/// triangulation does not contain the ring.
pub(super) fn disc(radius: f64, corners: u32, phase: f64) -> Option<Disc> {
    static DISCS: [OnceLock<Option<Disc>>; KEPT] = [const { OnceLock::new() }; KEPT];
    match DISCS.get(corners as usize) {
        Some(slot) => slot.get_or_init(|| unit_disc(corners)).as_ref().map(|d| d.placed(radius, phase)),
        None => unit_disc(corners).map(|d| d.placed(radius, phase)),
    }
}

impl Disc {
    /// Scales and rotates the disc.
    fn placed(&self, radius: f64, phase: f64) -> Self {
        let (s, c) = libm::sincos(phase);
        let (s, c) = (s * radius, c * radius);
        let points = self.points.iter().map(|&[x, y]| [c * x - s * y, s * x + c * y]).collect();
        Self { points, triangles: self.triangles.clone() }
    }
}

/// Disc of radius 1 with its first corner at angle 0.
fn unit_disc(corners: u32) -> Option<Disc> {
    let ring = ring_radius(1.0, corners);
    let spacing = 2.0 * ring * libm::sin(PI / f64::from(corners));
    let layers = (ring / (0.87 * spacing)).round().max(1.0) as u32;
    let mut points = circle(ring, corners, 0.0);
    for layer in (1..layers).rev() {
        let r = ring * f64::from(layer) / f64::from(layers);
        let count = ((TAU * r / spacing).round() as u32).max(5);
        points.extend(circle(r, count, 0.5 * TAU / f64::from(count) * f64::from((layers - layer) % 2)));
    }
    points.push([0.0, 0.0]);
    let mut triangles = triangulate(&points, corners)?;
    for _ in 0..3 {
        smooth(&mut points, &triangles, corners);
        triangles = triangulate(&points, corners)?;
    }
    Some(Disc { points, triangles })
}

fn circle(radius: f64, count: u32, phase: f64) -> Vec<[f64; 2]> {
    let angle = |i: u32| phase + TAU * f64::from(i) / f64::from(count);
    (0..count).map(|i| [radius * libm::cos(angle(i)), radius * libm::sin(angle(i))]).collect()
}

/// Constrained Delaunay triangulation. The constraints are the ring of the first `corners` points.
fn triangulate(points: &[[f64; 2]], corners: u32) -> Option<Vec<[u32; 3]>> {
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(points.len());
    for &[x, y] in points {
        handles.push(cdt.insert(Point2::new(x, y)).ok()?);
    }
    if cdt.num_vertices() != points.len() {
        return None;
    }
    let m = corners as usize;
    for i in 0..m {
        let (a, b) = (handles[i], handles[(i + 1) % m]);
        if !cdt.can_add_constraint(a, b) {
            return None;
        }
        cdt.add_constraint(a, b);
    }
    let triangles: Vec<[u32; 3]> = cdt.inner_faces().map(|f| f.vertices().map(|v| v.fix().index() as u32)).collect();
    // Triangle count of a disc: two for each interior point, plus the number of ring corners minus two.
    (triangles.len() == 2 * (points.len() - m) + m - 2).then_some(triangles)
}

/// Moves each interior point to the mean of its neighbours.
fn smooth(points: &mut [[f64; 2]], triangles: &[[u32; 3]], corners: u32) {
    let mut sums = vec![[0.0; 3]; points.len()];
    for t in triangles {
        for i in 0..3 {
            let (a, b) = (t[i] as usize, points[t[(i + 1) % 3] as usize]);
            sums[a] = [sums[a][0] + b[0], sums[a][1] + b[1], sums[a][2] + 1.0];
        }
    }
    for (p, s) in points.iter_mut().zip(sums).skip(corners as usize) {
        *p = [s[0] / s[2], s[1] / s[2]];
    }
}

/// Number of ring corners of a disc for a target edge length of the wall.
pub(super) fn corners(radius: f64, edge: f64) -> u32 {
    ((TAU * radius / (MEAN_EDGE * edge)).round() as u32).max(LEAST_CORNERS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_have_the_circles_area_and_good_angles() {
        for corners in 6..80 {
            let d = disc(2.0, corners, 0.1).unwrap();
            let (mut area, mut smallest) = (0.0, PI);
            for t in &d.triangles {
                let p = t.map(|v| d.points[v as usize]);
                for i in 0..3 {
                    let [a, b, c] = [p[i], p[(i + 1) % 3], p[(i + 2) % 3]];
                    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
                    let cross: f64 = u[0] * v[1] - u[1] * v[0];
                    area += cross / 6.0;
                    smallest = smallest.min(libm::atan2(cross, u[0] * v[0] + u[1] * v[1]));
                }
            }
            assert!((area - PI * 4.0).abs() < 1e-12 * area, "{corners}: area {area}");
            assert!(smallest > 0.45, "{corners}: angle {}", smallest.to_degrees());
        }
    }
}
