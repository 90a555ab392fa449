//! Vessel shorter than any template: one layer of prisms between two discs.

use super::filled::FilledTube;
use crate::block::topology::Topology;
use crate::surface::SharedDisc;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::adjacency::face_vertices;
use std::sync::Arc;

/// Tube between two discs with equal triangles, seen along the vessel. Each triangle and its counterpart are the ends of a prism,
/// divided into three tetrahedra. `None` if the triangles differ.
pub fn wafer([first, last]: &[SharedDisc; 2]) -> Option<FilledTube> {
    if first.triangles != last.triangles || first.points.len() != last.points.len() {
        return None;
    }
    let disc = first.points.len() as u32;
    let points = first.points.iter().chain(&last.points).copied().collect();
    let mesh = TetMesh { points, tets: first.triangles.iter().flat_map(|t| prism(*t, disc)).collect() };
    let turned = first.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let ends = [turned, first.triangles.iter().map(|t| t.map(|v| v + disc)).collect()];
    let topology = Topology::of(&mesh, ends.iter().map(Vec::as_slice)).ok()?;
    let wall = topology.wall.iter().map(|&face| face_vertices(&mesh.tets, face)).collect();
    Some(FilledTube { mesh, disc, ends, wall, rings: 0, topology: Arc::new(topology) })
}

/// Tetrahedra of the prism over a triangle, which is counter-clockwise seen from its other end; the vertices there have numbers
/// larger by `disc`. The diagonal of each side leads from the smaller number in the triangle, so neighbours agree on it.
fn prism(triangle: [u32; 3], disc: u32) -> [[u32; 4]; 3] {
    let mut t = triangle;
    let least = (0..3).min_by_key(|&i| t[i]).unwrap_or_default();
    t.rotate_left(least);
    let [a, b, c] = t;
    let [a2, b2, c2] = t.map(|v| v + disc);
    if b < c {
        [[a, b, c, c2], [a, b, c2, b2], [a, b2, c2, a2]]
    } else {
        [[a, b, c, b2], [a, b2, c, c2], [a, b2, c2, a2]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::check::check_tets;
    use anastomesh_mesh::geometry::{Point3, Section, Vec3};

    fn disc(z: f64, rho: f64) -> SharedDisc {
        SharedDisc::new(&Section::new(Point3::new(0.0, 0.0, z), Vec3::z(), 1.0), rho).expect("a disc")
    }

    #[test]
    fn a_tube_of_any_length_is_valid_and_as_large_as_its_discs() {
        for (length, rho) in [(1e-3, 3.0), (0.1, 2.5), (0.5, 6.0)] {
            let FilledTube { mesh, ends, wall, .. } = wafer(&[disc(0.0, rho), disc(length, rho)]).expect("a tube");
            let report = check_tets(&mesh, None);
            assert_eq!(report.failed().count(), 0, "{report:?}");
            let rim = mesh.points.len() - 2 - ends[0].len();
            assert_eq!(wall.len(), 2 * rim);
            let share = report.counts.volume / length;
            assert!(share > 2.3 && share < 3.15, "{share}");
        }
    }

    #[test]
    fn discs_with_other_triangles_are_refused() {
        assert!(wafer(&[disc(0.0, 3.0), disc(0.1, 5.0)]).is_none());
    }
}
