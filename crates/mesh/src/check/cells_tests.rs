//! Offenders of the conditions on points and tetrahedra.

use super::*;
use crate::adjacency::tet_adjacency;
use crate::geometry::Vec3;
use crate::geometry::predicates::{MAX_MAGNITUDE, MIN_MAGNITUDE};
use crate::shapes::cube_lattice;
use std::collections::BTreeSet;

/// Points of a tetrahedron with its centroid at (1, 1, 2), and one above its first face.
fn points() -> Vec<Point3> {
    [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 8.0], [1.0, 1.0, 1.0]].map(Point3::from).into()
}

/// Ids of the offenders of a condition.
fn ids(line: &LineResult) -> Vec<Vec<i64>> {
    assert_eq!(line.count as usize, line.offenders.len());
    line.offenders.iter().map(|offender| offender.ids.clone()).collect()
}

#[test]
fn offenders_are_at_the_mean_of_their_points() {
    let mesh = TetMesh { points: points(), tets: vec![[1, 0, 2, 3]] };
    let line = positive_tets(&mesh);
    assert_eq!((line.offenders[0].ids.as_slice(), line.offenders[0].position), (&[0][..], Some([1.0, 1.0, 2.0])));
    assert_eq!(face_offender(&mesh.points, [0, 1, 2]).position, Some([4.0 / 3.0, 4.0 / 3.0, 0.0]));
    assert_eq!(middle(&mesh.points[..4]), Point3::new(1.0, 1.0, 2.0));
}

#[test]
fn coordinates_must_be_in_the_range_of_the_predicates() {
    let is_found =
        |x: f64| finite_points(&TetMesh { points: vec![Point3::new(1.0, x, 1.0)], tets: Vec::new() }).fails();
    for allowed in [0.0, -0.0, MIN_MAGNITUDE, -MIN_MAGNITUDE, MAX_MAGNITUDE, -MAX_MAGNITUDE] {
        assert!(!is_found(allowed), "{allowed}");
    }
    for other in [MIN_MAGNITUDE / 2.0, -2.0 * MAX_MAGNITUDE, 2.0 * MAX_MAGNITUDE, f64::INFINITY, f64::NAN] {
        assert!(is_found(other), "{other}");
    }
}

#[test]
fn copies_of_tetrahedra_are_listed_in_pairs() {
    let found = |tets: Vec<[u32; 4]>, points: Vec<Point3>| {
        let adjacency = tet_adjacency(&tets, points.len());
        ids(&no_duplicate_tets(&TetMesh { points, tets }, &adjacency))
    };
    // All faces of two copies match, those of three are crowded.
    assert_eq!(found(vec![[0, 1, 2, 3]; 2], points()), [[0, 1]]);
    assert_eq!(found(vec![[0, 1, 2, 3], [1, 0, 2, 3]], points()), [[0, 1]]);
    assert_eq!(found(vec![[0, 1, 2, 3]; 3], points()), [[0, 1], [1, 2]]);
    assert!(found(vec![[0, 1, 2, 3], [0, 1, 2, 4]], points()).is_empty());
    // Neighbours of a copy are no copies.
    let TetMesh { points, mut tets } = cube_lattice(3);
    tets.push(tets[20]);
    assert_eq!(found(tets.clone(), points), [[20, tets.len() as i64 - 1]]);
}

#[test]
fn a_face_with_both_tetrahedra_on_one_side_is_listed_once() {
    let mesh = TetMesh { points: points(), tets: vec![[0, 1, 2, 3], [1, 2, 0, 4]] };
    let line = opposite_sides(&mesh, &tet_adjacency(&mesh.tets, mesh.points.len()));
    // As the first tetrahedron has it.
    assert_eq!(ids(&line), [face_vertices(&mesh.tets, 3).map(i64::from)]);
}

#[test]
fn equal_points_are_listed_in_pairs() {
    let mut mesh = cube_lattice(4);
    let hashes: BTreeSet<u64> = mesh.points.iter().map(hash).collect();
    assert_eq!(hashes.len(), mesh.points.len());
    mesh.points.extend([mesh.points[7], mesh.points[9], mesh.points[7]]);
    let line = no_duplicate_points(&mesh);
    let pairs: BTreeSet<Vec<i64>> = ids(&line).into_iter().collect();
    assert_eq!(pairs, [[7, 125], [9, 126], [125, 127]].map(Vec::from).into());
}

#[test]
fn components_are_connected_by_faces_within_a_region() {
    // Two cubes apart.
    let mut mesh = cube_lattice(2);
    let count = mesh.points.len() as u32;
    mesh.points.extend(mesh.points.clone().iter().map(|p| p + Vec3::repeat(3.0)));
    mesh.tets.extend(mesh.tets.clone().iter().map(|tet| tet.map(|v| v + count)));
    let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
    let firsts = |region: &dyn Fn(u32) -> i32| components(&adjacency, region).collect::<Vec<u32>>();
    assert_eq!(firsts(&|_| 0), [0, 48]);
    // Layers of four cells of six tetrahedra.
    assert_eq!(firsts(&|tet| (tet / 24) as i32), [0, 24, 48, 72]);
    // Columns of two cells each.
    assert_eq!(firsts(&|tet| i32::from(tet % 24 / 6 % 3 == 0)), [0, 6, 12, 18, 48, 54, 60, 66]);
}
