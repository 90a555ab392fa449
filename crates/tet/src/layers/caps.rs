//! Flat parts of a surface without layers, such as inlets and outlets, around which layers end.
//!
//! A cap shrinks towards its centre, and a ring of layers takes the rest of its area. The cap stays in its plane, so the
//! shape of the surface does not change, but its triangles do. Where this is impossible the cap keeps its triangles, and
//! layers end with thickness zero at its rim.

use super::stack::toward;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rustc_hash::FxHashMap;

/// Maximum distance of a cap's vertices from its plane, relative to its size. Coordinates rounded to 32 bits fit.
pub(super) const FLAT: f64 = 1e-5;

/// Connected triangles without layers that have one marker.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cap {
    /// Triangles, ascending.
    pub triangles: Vec<u32>,
    /// Vertices, ascending.
    pub vertices: Vec<u32>,
    /// Point towards which the cap shrinks; `None` if it keeps its triangles.
    pub centre: Option<Point3>,
}

/// Finds the caps of a closed surface: all triangles off the wall. Triangles after the end of `is_wall` are no part of the
/// surface.
pub(super) fn caps<K: PartialEq>(surface: &TriMesh, is_wall: &[bool], markers: &[K]) -> Vec<Cap> {
    let mut caps = components(surface, is_wall, markers);
    let mut owners = vec![0_u32; surface.points.len()];
    caps.iter().flat_map(|cap| &cap.vertices).for_each(|&v| owners[v as usize] += 1);
    for cap in &mut caps {
        // A vertex cannot lie in two planes while it moves.
        let is_alone = cap.vertices.iter().all(|&v| owners[v as usize] == 1);
        cap.centre = if is_alone { centre(surface, cap) } else { None };
    }
    caps
}

fn components<K: PartialEq>(surface: &TriMesh, is_wall: &[bool], markers: &[K]) -> Vec<Cap> {
    let triangles = &surface.triangles;
    let off_wall = || (0..is_wall.len() as u32).filter(|&t| !is_wall[t as usize]);
    let mut beside: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
    for t in off_wall() {
        sides(triangles[t as usize]).for_each(|[a, b]| beside.entry([a.min(b), a.max(b)]).or_default().push(t));
    }
    let marker = |t: u32| markers.get(t as usize);
    let mut is_known = is_wall.to_vec();
    let mut caps = Vec::new();
    for first in off_wall() {
        let mut members = Vec::new();
        let mut reached = if is_known[first as usize] { Vec::new() } else { vec![first] };
        while let Some(t) = reached.pop() {
            if std::mem::replace(&mut is_known[t as usize], true) {
                continue;
            }
            members.push(t);
            let around = sides(triangles[t as usize]).filter_map(|[a, b]| beside.get(&[a.min(b), a.max(b)]));
            reached.extend(around.flatten().copied().filter(|&other| marker(other) == marker(first)));
        }
        if members.is_empty() {
            continue;
        }
        members.sort_unstable();
        let mut vertices: Vec<u32> = members.iter().flat_map(|&t| triangles[t as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        caps.push(Cap { triangles: members, vertices, centre: None });
    }
    caps
}

fn sides([a, b, c]: [u32; 3]) -> impl Iterator<Item = [u32; 2]> {
    [[a, b], [b, c], [c, a]].into_iter()
}

/// Centre of area of a cap, if the cap is flat, and its whole rim is seen from there in one turn.
fn centre(surface: &TriMesh, cap: &Cap) -> Option<Point3> {
    let corners = |t: &u32| surface.triangles[*t as usize].map(|v| surface.points[v as usize]);
    let origin = surface.points[*cap.vertices.first()? as usize];
    let (mut area, mut moment, mut total) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    for [a, b, c] in cap.triangles.iter().map(corners) {
        let normal = (b - a).cross(&(c - a));
        area += normal;
        total += normal.norm();
        moment += ((a - origin) + (b - origin) + (c - origin)) * (normal.norm() / 3.0);
    }
    let normal = area.try_normalize(0.0)?;
    let centre = origin + moment / total;
    let size = cap.vertices.iter().map(|&v| (surface.points[v as usize] - centre).norm()).fold(0.0, f64::max);
    let is_flat = |&v: &u32| (surface.points[v as usize] - centre).dot(&normal).abs() <= FLAT * size;
    let is_seen = |[a, b]: &[u32; 2]| {
        let [a, b] = [a, b].map(|&v| surface.points[v as usize] - centre);
        a.cross(&b).dot(&normal) > 0.0
    };
    let rim = rim(&surface.triangles, cap);
    (cap.vertices.iter().all(is_flat) && !rim.is_empty() && rim.iter().all(is_seen)).then_some(centre)
}

/// Edges of a cap that only one of its triangles has, in the direction of that triangle.
pub(super) fn rim(triangles: &[[u32; 3]], cap: &Cap) -> Vec<[u32; 2]> {
    let mut all: Vec<[u32; 2]> = cap.triangles.iter().flat_map(|&t| sides(triangles[t as usize])).collect();
    all.sort_unstable();
    all.iter().filter(|[a, b]| all.binary_search(&[*b, *a]).is_err()).copied().collect()
}

/// Positions of the vertices of caps: shrunk towards their centres by `share`, or unchanged. `None` off the caps.
pub(super) fn shrunk(surface: &TriMesh, caps: &[Cap], share: f64) -> Vec<Option<Point3>> {
    let mut places = vec![None; surface.points.len()];
    for cap in caps {
        for &v in &cap.vertices {
            let p = &surface.points[v as usize];
            places[v as usize] = Some(cap.centre.map_or(*p, |centre| toward(p, &centre, share)));
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::sphere_surface;

    /// Box of 2 × 1 × 1 whose ends are caps, with a vertex in the middle of one.
    fn bar() -> (TriMesh, Vec<bool>) {
        let corner = |i: usize| Point3::new((2 * (i & 1)) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2]];
        let mut triangles: Vec<[u32; 3]> = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        triangles.extend([[1, 3, 8], [3, 7, 8], [7, 5, 8], [5, 1, 8]]);
        let mut points: Vec<Point3> = (0..8).map(corner).collect();
        points.push(Point3::new(2.0, 0.4, 0.5));
        let wall = (0..triangles.len()).map(|t| t < 8).collect();
        (TriMesh { points, triangles }, wall)
    }

    #[test]
    fn flat_ends_shrink_and_others_stay() {
        let (mut surface, wall) = bar();
        let found = caps::<i32>(&surface, &wall, &[]);
        assert_eq!(found.iter().map(|cap| cap.triangles.len()).collect::<Vec<_>>(), [2, 4]);
        let centres: Vec<Point3> = found.iter().filter_map(|cap| cap.centre).collect();
        assert!((centres[1] - Point3::new(2.0, 0.5, 0.5)).norm() < 1e-12, "{centres:?}");
        let places = shrunk(&surface, &found, 0.5);
        assert!((places[1].expect("on a cap") - Point3::new(2.0, 0.25, 0.25)).norm() < 1e-12, "{places:?}");
        // Not flat.
        surface.points[8].x = 2.2;
        let found = caps::<i32>(&surface, &wall, &[]);
        assert_eq!(found.iter().map(|cap| cap.centre.is_some()).collect::<Vec<_>>(), [true, false]);
        assert_eq!(shrunk(&surface, &found, 0.5)[1], Some(surface.points[1]));
        // Each end has two markers.
        let (surface, wall) = bar();
        let markers: Vec<i32> = (0..surface.triangles.len() as i32).map(|t| t % 2).collect();
        assert!(caps(&surface, &wall, &markers).iter().all(|cap| cap.centre.is_none()));
    }

    #[test]
    fn a_closed_part_has_no_rim() {
        let sphere = sphere_surface(1);
        let found = caps(&sphere, &vec![false; sphere.triangles.len()], &[] as &[i32]);
        assert_eq!((found.len(), found[0].centre), (1, None));
    }
}
