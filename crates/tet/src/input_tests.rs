//! Tests of messages about unusable input: they name the cause, not its consequences, in the caller's numbering.

use super::*;
use crate::names::Names;
use anastomesh_mesh::shapes::sphere_surface;

fn error(s: &TriMesh, kind: InputKind) -> TetError {
    Tetrahedralizer::new().kind(kind).run(&Plc::from(s)).unwrap_err()
}

#[test]
fn triangles_that_are_there_twice_are_named_in_pairs() {
    let mut s = sphere_surface(1);
    let n = s.triangles.len() as u32;
    let [a, b, c] = s.triangles[5];
    s.triangles.extend([[c, a, b], s.triangles[2], [b, a, c]]);
    for kind in [InputKind::Closed, InputKind::Plc] {
        let TetError::DuplicateTriangles { pairs, count } = error(&s, kind) else { panic!("{kind:?}") };
        assert_eq!((pairs, count), (vec![[2, n + 1], [5, n], [5, n + 2]], 3));
    }
    let said = error(&s, InputKind::Closed).to_string();
    assert_eq!(said, "3 duplicate triangles: 2 (again as 81), 5 (again as 80), 5 (again as 82)");
    s.triangles.truncate(n as usize + 1);
    assert_eq!(error(&s, InputKind::Plc).to_string(), "triangle 5 is duplicated by 80");
}

/// The surface with separate corners for each triangle.
fn soup(s: &TriMesh) -> TriMesh {
    TriMesh {
        points: s.triangles.iter().flatten().map(|&v| s.points[v as usize]).collect(),
        triangles: (0..s.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    }
}

#[test]
fn corners_that_are_not_shared_are_told_from_holes() {
    let s = sphere_surface(1);
    let apart = soup(&s);
    let n = s.triangles.len();
    let found = error(&apart, InputKind::Closed);
    assert!(
        matches!(found, TetError::NotShared(EdgeFaults { count, edges, .. }) if count == n && edges == 3 * n),
        "{found}"
    );
    // A difference in the last bit is a gap.
    let mut gap = apart.clone();
    gap.points.iter_mut().enumerate().for_each(|(i, p)| p.x += 0.01 * i as f64);
    assert!(matches!(error(&gap, InputKind::Closed), TetError::Open(_)));
    // A crack along one edge, with both zeros; only that is named.
    let mut crack = TriMesh { points: vec![], triangles: vec![[0, 2, 1], [0, 1, 3], [4, 2, 3], [2, 5, 3]] };
    for (x, y, z) in [(0., 0., 0.), (1., 0., 0.), (0., 1., 0.), (0., 0., 1.), (1., -0., 0.), (-0., 0., 0.)] {
        crack.points.push(anastomesh_mesh::geometry::Point3::new(x, y, z));
    }
    let TetError::NotShared(EdgeFaults { triangles, edges, .. }) = error(&crack, InputKind::Closed) else { panic!() };
    assert_eq!((triangles, edges), (vec![0, 1, 2, 3], 8));
}

/// Two triangles per face; all counts from 10.
struct Halves;

impl Names for Halves {
    fn point(&self, id: u32) -> u32 {
        id + 10
    }

    fn triangle(&self, id: u32) -> u32 {
        id / 2 + 10
    }
}

#[test]
fn errors_are_told_in_the_numbers_of_the_caller() {
    let mut s = sphere_surface(1);
    s.triangles.truncate(4);
    let TetError::Open(EdgeFaults { triangles, edge, .. }) = error(&s, InputKind::Closed) else { panic!() };
    assert_eq!(triangles, [0, 1, 2]);
    let renamed = error(&s, InputKind::Closed).renamed(&Halves);
    let TetError::Open(EdgeFaults { triangles, edge: elsewhere, count: 3, .. }) = &renamed else { panic!("{renamed}") };
    assert_eq!((triangles.as_slice(), *elsewhere), (&[10, 10, 11][..], edge.map(|v| v + 10)));
    assert!(renamed.to_string().contains("3 triangles with an unshared edge: 10, 11; one edge is"), "{renamed}");
}
