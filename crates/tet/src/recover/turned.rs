//! Detection of surfaces with flat parts that rounding has perturbed, for example after a rotation. Flips fail there,
//! and missing parts are recovered as in the plane.

use super::rule::least_height;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::predicates::orient3d;
use rustc_hash::FxHashMap;

/// Minimum number of edges for [`lies_in_planes`].
const MANY: usize = 2000;

/// True if over 3/4 of the edges lie between two triangles that are coplanar within `height`, but not exactly.
pub(crate) fn lies_turned(surface: &TriMesh, edges: &[[u32; 2]], height: f64) -> bool {
    is_mostly_flat(surface, edges, height, |sign| sign != 0.0)
}

/// True if recovery in planes is fastest: many edges, over 3/4 of them between two triangles that are coplanar within
/// `height`, exactly or not.
pub(crate) fn lies_in_planes(surface: &TriMesh, edges: &[[u32; 2]], height: f64) -> bool {
    edges.len() > MANY && is_mostly_flat(surface, edges, height, |_| true)
}

/// True if over 3/4 of the edges lie between triangles coplanar within `height` and with a `wanted` orientation.
fn is_mostly_flat(surface: &TriMesh, edges: &[[u32; 2]], height: f64, wanted: impl Fn(f64) -> bool) -> bool {
    let sorted = |a: u32, b: u32| [a.min(b), a.max(b)];
    let mut across: FxHashMap<[u32; 2], Vec<u32>> = edges.iter().map(|&[a, b]| (sorted(a, b), Vec::new())).collect();
    for &[a, b, c] in &surface.triangles {
        for (p, q, apex) in [(a, b, c), (b, c, a), (c, a, b)] {
            if let Some(apices) = across.get_mut(&sorted(p, q)) {
                apices.push(apex);
            }
        }
    }
    let turned = across.iter().filter(|(edge, apices)| {
        let [x, y] = apices[..] else { return false };
        let corners @ [p, q, r, s] = [edge[0], edge[1], x, y].map(|v| &surface.points[v as usize]);
        wanted(orient3d(p, q, r, s)) && least_height(corners) < height
    });
    4 * turned.count() > 3 * edges.len()
}

#[cfg(test)]
mod tests {
    use super::super::rule::{coarse_height, flat_height};
    use super::*;
    use anastomesh_mesh::geometry::Point3;

    /// Two triangles at a missing diagonal, with one corner at `height` above the plane of the others.
    fn folded(height: f64) -> TriMesh {
        let points = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, height]];
        let points = points.map(|[x, y, z]| Point3::new(x, y, z)).to_vec();
        TriMesh { points, triangles: vec![[0, 2, 1], [1, 3, 0]] }
    }

    #[test]
    fn a_plate_of_single_precision_is_flat_after_a_rotation_in_doubles() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, 0.7, 1.1);
        let tilted = |x: f64, y: f64| Point3::new(x, y, f64::from((0.3 * x + 0.7 * y) as f32));
        let mut plate = TriMesh::default();
        let mut edges = Vec::new();
        for i in 0..20 {
            let (x, v) = (0.1 * f64::from(i), 4 * i);
            let corners = [(x, 0.0), (x + 0.1, 0.0), (x + 0.1, 0.13), (x, 0.13)];
            plate.points.extend(corners.map(|(x, y)| turn * tilted(f64::from(x as f32), f64::from(y as f32))));
            plate.triangles.extend([[v, v + 1, v + 2], [v, v + 2, v + 3]]);
            edges.push([v, v + 2]);
        }
        assert!(!lies_turned(&plate, &edges, flat_height(&plate.points)));
        assert!(lies_turned(&plate, &edges, coarse_height(&plate.points)));
    }

    #[test]
    fn only_what_is_nearly_flat_counts() {
        let counts = |height| lies_turned(&folded(height), &[[0, 1]], 1e-10);
        assert!(counts(1e-14) && !counts(0.0) && !counts(1e-3));
        let flat = |height| is_mostly_flat(&folded(height), &[[0, 1]], 1e-10, |_| true);
        assert!(flat(1e-14) && flat(0.0) && !flat(1e-3));
        assert!(!is_mostly_flat(&folded(0.0), &[[0, 1]], 0.0, |_| true));
    }

    #[test]
    fn three_quarters_of_the_edges_must_be_flat() {
        // Folded pairs of triangles in a row.
        let row = |flat: u32, steep: u32| {
            let (mut all, mut edges) = (TriMesh::default(), Vec::new());
            for k in 0..flat + steep {
                let part = folded(if k < flat { 1e-14 } else { 1e-3 });
                let first = all.points.len() as u32;
                all.points.extend(part.points);
                all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
                edges.push([first, first + 1]);
            }
            (all, edges)
        };
        let lies = |flat, steep| {
            let (surface, edges) = row(flat, steep);
            [lies_turned(&surface, &edges, 1e-10), lies_in_planes(&surface, &edges, 1e-10)]
        };
        assert_eq!([lies(4, 1), lies(3, 1), lies(7, 2)], [[true, false], [false, false], [true, false]]);
        assert_eq!([lies(2000, 0), lies(2001, 0), lies(1601, 400)], [[true, false], [true, true], [true, true]]);
        assert_eq!(lies(1500, 501), [false, false]);
    }
}
