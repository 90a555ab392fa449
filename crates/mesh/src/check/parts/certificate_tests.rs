//! Certificates of single parts.

use super::*;
use crate::adjacency::tet_adjacency;
use crate::shapes::cube_lattice;

fn certificate(mesh: &TetMesh, joints: &[Vec<[u32; 3]>], caps: &[(crate::Cap, Vec<[u32; 3]>)]) -> Certificate {
    certify_with(&PartView { mesh, joints, caps }, || tet_adjacency(&mesh.tets, mesh.points.len()))
}

fn faults(certificate: &Certificate) -> Vec<Line> {
    certificate.faults.iter().map(|fault| fault.line).collect()
}

/// Mesh of these tetrahedra over six points: a triangle, two points above it, one below.
fn over_a_triangle(tets: &[[u32; 4]]) -> TetMesh {
    let points =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, 0.3, 2.0], [0.0, 0.0, -1.0]];
    TetMesh { points: points.map(Point3::from).to_vec(), tets: tets.to_vec() }
}

#[test]
fn a_certificate_has_the_worst_shape_of_the_tetrahedra() {
    // Corner of a cube: radius ratio √3 - 1, least dihedral angle atan √2.
    let mut mesh = over_a_triangle(&[[0, 1, 2, 3]]);
    mesh.points.truncate(4);
    let corner = certificate(&mesh, &[], &[]);
    assert!((corner.worst_ratio() - 0.732_050_807_568_877).abs() < 1e-12, "{}", corner.worst_ratio());
    assert!((corner.least_dihedral() - 54.735_610_317_245).abs() < 1e-9, "{}", corner.least_dihedral());
    assert_eq!(corner.broken_line(), None);
    mesh.tets[0].swap(0, 1);
    assert_eq!(certificate(&mesh, &[], &[]).broken_line(), Some(Line::PositiveTets));
}

#[test]
fn positive_tetrahedra_share_faces_in_pairs_from_opposite_sides() {
    let mut two = over_a_triangle(&[[0, 1, 2, 3], [0, 2, 1, 4]]);
    two.points[4] = two.points.pop().unwrap();
    assert_eq!(faults(&certificate(&two, &[], &[])), []);
    // Both on one side of their common face.
    let mut folded = over_a_triangle(&[[0, 1, 2, 3], [0, 1, 2, 4]]);
    folded.points.pop();
    let lines = faults(&certificate(&folded, &[], &[]));
    assert!(lines.contains(&Line::OppositeSides) && !lines.contains(&Line::PositiveTets), "{lines:?}");
    // Three tetrahedra with a common face.
    let lines = faults(&certificate(&over_a_triangle(&[[0, 1, 2, 3], [0, 1, 2, 4], [0, 2, 1, 5]]), &[], &[]));
    assert!(lines.contains(&Line::FacesSharedByTwo) && !lines.contains(&Line::PositiveTets), "{lines:?}");
}

#[test]
fn neighbors_are_told_from_folds_and_connected_meshes_from_others() {
    let told = |mesh: &TetMesh| {
        let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
        (neighbors_are_opposite(mesh, &adjacency), is_connected(&adjacency))
    };
    let cube = cube_lattice(2);
    assert_eq!(told(&cube), (true, true));
    // Seen from either of the two.
    for tets in [[[0, 1, 2, 3], [0, 1, 2, 4]], [[0, 1, 2, 4], [1, 2, 0, 3]], [[3, 0, 2, 1], [0, 1, 2, 4]]] {
        assert_eq!(told(&over_a_triangle(&tets)), (false, true));
    }
    let mut two = cube.clone();
    two.tets.extend(cube.tets.iter().map(|t| t.map(|v| v + 27)));
    two.points.extend_from_slice(&cube.points);
    assert_eq!(told(&two), (true, false));
    assert_eq!(told(&TetMesh::default()), (true, true));
}

#[test]
fn coordinates_outside_the_exact_range_are_faults() {
    for x in [f64::NAN, f64::INFINITY, 1e300, -1e300, 1e-300] {
        let mut mesh = cube_lattice(1);
        mesh.points[3].y = x;
        assert_eq!(faults(&certificate(&mesh, &[], &[])), [Line::FinitePoints], "{x}");
    }
}

#[test]
fn numbers_one_beyond_the_last_point_are_faults() {
    let mut mesh = cube_lattice(1);
    mesh.tets[2][1] = 8;
    assert_eq!(faults(&certificate(&mesh, &[], &[])), [Line::IndicesInRange]);
    let mesh = cube_lattice(1);
    assert_eq!(faults(&certificate(&mesh, &[vec![[0, 1, 8]]], &[])), [Line::LabelsMatchBoundary]);
    let cap = crate::Cap { node: 3, center: Point3::origin(), normal: Vec3::z(), radius: 1.0 };
    let with_cap = certificate(&mesh, &[], &[(cap, vec![[0, 1, 8]])]);
    assert_eq!(faults(&with_cap), [Line::LabelsMatchBoundary]);
    assert_eq!((with_cap.caps[0].faces, with_cap.caps[0].shape), (1, [false; 5]));
}

/// Square around a point, normal to an axis.
fn square(center: [f64; 3], axis: usize) -> [Point3; 4] {
    [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[u, v]| {
        let mut p = center;
        p[(axis + 1) % 3] += u;
        p[(axis + 2) % 3] += v;
        Point3::from(p)
    })
}

#[test]
fn the_middle_of_a_part_is_where_the_axes_of_its_joints_and_caps_meet() {
    let middle = |discs: &[([f64; 3], usize)]| {
        let points: Vec<Point3> = discs.iter().flat_map(|&(center, axis)| square(center, axis)).collect();
        let faces = |disc: u32| vec![[0, 1, 2], [0, 2, 3]].into_iter().map(|f| f.map(|v| v + 4 * disc)).collect();
        let mut joints: Vec<Vec<[u32; 3]>> = (0..discs.len() as u32).map(faces).collect();
        let cap = crate::Cap { node: 0, center: Point3::origin(), normal: Vec3::z(), radius: 1.0 };
        let caps: Vec<_> = joints.split_off(joints.len().min(1)).into_iter().map(|faces| (cap, faces)).collect();
        middle(&PartView { mesh: &TetMesh { points, tets: Vec::new() }, joints: &joints, caps: &caps })
    };
    let close = |p: Point3, q: [f64; 3]| assert!((p - Point3::from(q)).norm() < 1e-12, "{p:?} {q:?}");
    // Two discs of one axis: the middle between them.
    close(middle(&[([3.0, 5.0, 2.0], 2), ([3.0, 5.0, 8.0], 2)]), [3.0, 5.0, 5.0]);
    // Axes that cross at the origin. The discs pull it towards them with a hundredth of the axes' weight.
    close(middle(&[([2.0, 0.0, 0.0], 0), ([0.0, 3.0, 0.0], 1)]), [0.02 / 1.02, 0.03 / 1.02, 0.0]);
    close(middle(&[]), [0.0; 3]);
}

#[test]
fn a_straight_part_is_star_shaped_around_its_middle() {
    let mesh = cube_lattice(2);
    let boundary = crate::adjacency::boundary_faces(&mesh);
    let on = |z: f64| boundary.iter().copied().filter(|f| f.iter().all(|&v| mesh.points[v as usize].z == z)).collect();
    let joints = [on(0.0), on(1.0)];
    let part = PartView { mesh: &mesh, joints: &joints, caps: &[] };
    assert!(is_star(&part, &boundary));
    let reversed: Vec<[u32; 3]> = boundary.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(!is_star(&part, &reversed));
}
