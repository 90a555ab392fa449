//! Openings of the organ's surface where vessels leave.
//!
//! Around the end of each vessel, triangles of the organ are removed. A ring of triangles joins the rim of the vessel's end to
//! the rim of the opening. It is triangulated in projection on the plane of the end, so it does not overlap itself.

use super::bisect::{bisect, edges};
use super::error::{DomainError, GateFault};
use super::inside::{compact, passes};
use super::surface::LumenSurface;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::facets::triangulate;
use anastomesh_mesh::geometry::{Point3, Vec3, point_triangle, segment_segment};
use rustc_hash::{FxHashMap, FxHashSet};

/// Radius of an opening, in outer radii of the vessel.
const OPENING: f64 = 1.35;
/// Half the length along the axis in which triangles are removed, in outer radii.
const DEPTH: f64 = 2.5;
/// Longest edge at an opening in outer radii, its growth with the distance, and the distance up to which triangles are divided.
const EDGE: (f64, f64, f64) = (0.7, 0.5, 6.0);
/// Least cosine of the angle between a vessel and the normal of the organ.
const STEEP: f64 = 0.4;
/// Maximum passes over vertices at which the rim of an opening touches itself.
const MAX_PINCHES: usize = 10;

/// End of a vessel where it leaves the organ.
#[derive(Clone, Debug)]
pub struct Gate {
    /// Number of the cap.
    pub cap: u32,
    /// Centre of the cap.
    pub center: Point3,
    /// Normal of the cap, out of the vessel.
    pub normal: Vec3,
    /// Radius with all shells.
    pub radius: f64,
}

/// Opening of the organ's surface.
#[derive(Clone, Debug)]
pub struct Opening {
    pub gate: Gate,
    /// Rim of the opening, counterclockwise seen from outside.
    pub rim: Vec<u32>,
}

impl Gate {
    /// Ends of vessels at given places. `thickness` is that of all shells at each point of the lumen's surface.
    pub fn find(lumen: &LumenSurface, thickness: &[f64], places: &[Point3]) -> Result<Vec<Self>, DomainError> {
        if places.is_empty() {
            return Ok(Vec::new());
        }
        let mut of_caps: Vec<Vec<[u32; 3]>> = vec![Vec::new(); lumen.patches.len()];
        for (t, cap) in lumen.surface.triangles.iter().zip(&lumen.caps) {
            if let Some(cap) = cap {
                of_caps[*cap as usize].push(*t);
            }
        }
        let of_cap = |(cap, own): (u32, Vec<[u32; 3]>)| Self::of(cap, &own, &lumen.surface.points, thickness);
        let mut all: Vec<Self> = (0..).zip(of_caps).map(of_cap).collect();
        let mut found = Vec::new();
        for place in places {
            let near = |gate: &Self| (gate.center - place).norm() / gate.radius;
            let nearest = (0..all.len()).min_by(|&i, &j| near(&all[i]).total_cmp(&near(&all[j])));
            let at = place.coords.into();
            match nearest.filter(|&i| near(&all[i]) < 1.0) {
                Some(i) => found.push(all.swap_remove(i)),
                None => return Err(DomainError::Gate { at, fault: GateFault::NoEnd }),
            }
        }
        Ok(found)
    }

    /// End with these triangles.
    fn of(cap: u32, own: &[[u32; 3]], points: &[Point3], thickness: &[f64]) -> Self {
        let (mut normal, mut moment, mut area) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for t in own {
            let [a, b, c] = t.map(|v| points[v as usize]);
            let twice = (b - a).cross(&(c - a));
            normal += twice;
            area += twice.norm();
            moment += (a.coords + b.coords + c.coords) * (twice.norm() / 3.0);
        }
        let center = Point3::from(moment / area);
        let reach = |&v: &u32| (points[v as usize] - center).norm() + thickness[v as usize];
        let radius = own.as_flattened().iter().map(reach).fold(0.0, f64::max);
        Self { cap, center, normal: normal.normalize(), radius }
    }

    /// True for a place near the end, which may lie outside the organ.
    pub fn is_near(&self, p: &Point3) -> bool {
        (p - self.center).norm() < (DEPTH + 0.5) * self.radius
    }

    fn fault(&self, fault: GateFault) -> DomainError {
        DomainError::Gate { at: self.center.coords.into(), fault }
    }

    /// True for triangles that are too long for a rim of the opening.
    fn is_long(&self, corners: [&Point3; 3]) -> bool {
        let [a, b, c] = corners;
        let longest = (a - b).norm().max((b - c).norm()).max((c - a).norm());
        let (edge, growth, far) = EDGE;
        if longest <= edge * self.radius {
            return false;
        }
        let away = point_triangle(&self.center, corners).1 / self.radius;
        away < far && longest > (edge + growth * (away - 1.0).max(0.0)) * self.radius
    }

    /// True for triangles that reach into the opening.
    fn removes(&self, corners: [&Point3; 3]) -> bool {
        let ends = [-1.0, 1.0].map(|side| self.center + self.normal * (side * DEPTH * self.radius));
        let [p, q] = [&ends[0], &ends[1]];
        let [a, b, c] = corners;
        let near = |distance: f64| distance < OPENING * self.radius;
        near(point_triangle(p, corners).1)
            || near(point_triangle(q, corners).1)
            || [[a, b], [b, c], [c, a]].into_iter().any(|side| near(segment_segment([p, q], side).distance))
            || passes([p, q], corners, true)
    }

    /// Point in the frame of the end, with the normal along z, in projection on its plane.
    fn flat(&self, p: &Point3) -> Point3 {
        let axis = self.normal.iamin();
        let u = self.normal.cross(&Vec3::ith(axis, 1.0)).normalize();
        let v = self.normal.cross(&u);
        let d = p - self.center;
        Point3::new(d.dot(&u), d.dot(&v), 0.0)
    }
}

/// Opens the organ's surface at the ends of vessels. Triangles near them are divided first, where they are long.
pub fn open(organ: &TriMesh, gates: Vec<Gate>) -> Result<(TriMesh, Vec<Opening>), DomainError> {
    let mut surface = organ.clone();
    if gates.is_empty() {
        return Ok((surface, Vec::new()));
    }
    bisect(&mut surface, &|corners| gates.iter().any(|gate| gate.is_long(corners)));
    let mut removed = vec![false; surface.triangles.len()];
    let mut openings = Vec::new();
    for gate in gates {
        let own = part_to_remove(&surface, &removed, &gate)?;
        for &t in &own {
            removed[t as usize] = true;
        }
        let rims = loops(own.iter().map(|&t| surface.triangles[t as usize]));
        let Some(Ok([rim])) = rims.map(<[Vec<u32>; 1]>::try_from) else {
            return Err(gate.fault(GateFault::Rim));
        };
        openings.push(Opening { gate, rim });
    }
    let mut kept = removed.iter();
    surface.triangles.retain(|_| kept.next() == Some(&false));
    let on_rims: FxHashSet<[u32; 2]> = surface.triangles.iter().flat_map(|&t| edges(t)).collect();
    for Opening { gate, rim } in &openings {
        // A rim between two openings has no triangle beside it.
        let is_free = |[a, b]: [u32; 2]| !on_rims.contains(&[a.min(b), a.max(b)]);
        if pairs(rim).any(is_free) {
            return Err(gate.fault(GateFault::Close));
        }
    }
    let (surface, number) = compact(&surface);
    for v in openings.iter_mut().flat_map(|opening| &mut opening.rim) {
        *v = number[*v as usize];
    }
    Ok((surface, openings))
}

/// Triangles to remove for a gate: those at its end that are connected, and form a disc.
fn part_to_remove(surface: &TriMesh, removed: &[bool], gate: &Gate) -> Result<Vec<u32>, DomainError> {
    let corners = |t: u32| surface.triangles[t as usize].map(|v| &surface.points[v as usize]);
    let reached: Vec<u32> =
        (0..surface.triangles.len() as u32).filter(|&t| !removed[t as usize] && gate.removes(corners(t))).collect();
    let away = |t: u32| point_triangle(&gate.center, corners(t)).1;
    let Some(first) = reached.iter().copied().min_by(|&t, &u| away(t).total_cmp(&away(u))) else {
        return Err(gate.fault(GateFault::Far));
    };
    let mut at: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
    for &t in &reached {
        for edge in edges(surface.triangles[t as usize]) {
            at.entry(edge).or_default().push(t);
        }
    }
    let mut own: FxHashSet<u32> = [first].into_iter().collect();
    let mut queue = vec![first];
    while let Some(t) = queue.pop() {
        for edge in edges(surface.triangles[t as usize]) {
            queue.extend(at[&edge].iter().filter(|&&u| own.insert(u)));
        }
    }
    let twice = |[a, b, c]: [&Point3; 3]| (b - a).cross(&(c - a));
    let normal: Vec3 = own.iter().map(|&t| twice(corners(t))).sum();
    if normal.dot(&gate.normal) < STEEP * normal.norm() {
        return Err(gate.fault(GateFault::Flat));
    }
    for _ in 0..MAX_PINCHES {
        let pinched = pinched(own.iter().map(|&t| surface.triangles[t as usize]));
        if pinched.is_empty() {
            break;
        }
        let touches = |t: &u32| surface.triangles[*t as usize].iter().any(|v| pinched.contains(v));
        own.extend((0..surface.triangles.len() as u32).filter(|t| !removed[*t as usize] && touches(t)));
    }
    let mut own: Vec<u32> = own.into_iter().collect();
    own.sort_unstable();
    Ok(own)
}

/// Boundary edges of some triangles, directed as there, by their first vertex.
fn border(triangles: impl Iterator<Item = [u32; 3]>) -> Vec<[u32; 2]> {
    let directed: FxHashSet<[u32; 2]> = triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    let mut border: Vec<[u32; 2]> = directed.iter().copied().filter(|&[a, b]| !directed.contains(&[b, a])).collect();
    border.sort_unstable();
    border
}

/// Vertices at which the boundary of some triangles touches itself.
fn pinched(triangles: impl Iterator<Item = [u32; 3]>) -> FxHashSet<u32> {
    let border = border(triangles);
    border.windows(2).filter(|pair| pair[0][0] == pair[1][0]).map(|pair| pair[0][0]).collect()
}

/// Boundary of some triangles as loops, directed as they are. `None` if it touches itself.
fn loops(triangles: impl Iterator<Item = [u32; 3]>) -> Option<Vec<Vec<u32>>> {
    let border = border(triangles);
    let mut next: FxHashMap<u32, u32> = border.iter().map(|&[a, b]| (a, b)).collect();
    if next.len() < border.len() {
        return None;
    }
    let mut loops = Vec::new();
    for [first, _] in border {
        let (mut ring, mut v) = (Vec::new(), first);
        while let Some(w) = next.remove(&v) {
            ring.push(v);
            v = w;
        }
        if !ring.is_empty() {
            loops.push(ring);
        }
    }
    Some(loops)
}

fn pairs(ring: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    ring.iter().enumerate().map(|(i, &v)| [v, ring[(i + 1) % ring.len()]])
}

impl Opening {
    /// Triangles between the end of the vessel and the rim of the opening, oriented out of the organ. `end` are the triangles
    /// of the end with its shells. The rim of the opening begins at `first` in common numbers.
    pub fn ring(
        &self,
        end: impl Iterator<Item = [u32; 3]>,
        first: u32,
        place: &dyn Fn(u32) -> Point3,
    ) -> Result<Vec<[u32; 3]>, DomainError> {
        let Self { gate, rim } = self;
        let Some(Ok([inner])) = loops(end).map(<[Vec<u32>; 1]>::try_from) else {
            return Err(gate.fault(GateFault::Rim));
        };
        let numbers: Vec<u32> = rim.iter().map(|v| v + first).chain(inner.iter().copied()).collect();
        let flat: Vec<Point3> = numbers.iter().map(|&v| gate.flat(&place(v))).collect();
        let split = rim.len() as u32;
        let polygons = [(0..split).collect(), (split..numbers.len() as u32).collect()];
        let made = triangulate(&flat, &polygons, &[Point3::origin()]);
        let made = made.map_err(|_| gate.fault(GateFault::Rim))?;
        if !made.segments.is_empty() {
            return Err(gate.fault(GateFault::Rim));
        }
        Ok(made.triangles.into_iter().map(|t| t.map(|v| numbers[v as usize])).collect())
    }
}
