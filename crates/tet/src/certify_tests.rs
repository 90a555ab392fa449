//! Each condition of the certificate, by a mesh that violates it alone.

use super::*;

/// Vertices of a tetrahedron in the order that makes it positive.
fn positive(points: &[Point3], [a, b, c, d]: [u32; 4]) -> [u32; 4] {
    let [p, q, r, s] = [a, b, c, d].map(|v| &points[v as usize]);
    if orient3d(p, q, r, s) > 0.0 { [a, b, c, d] } else { [a, c, b, d] }
}

/// Two tetrahedra with the common face 0 1 2; the fifth point is at this height.
fn two(height: f64) -> TetMesh {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.2, 1.0], [0.3, 0.2, height]].map(Point3::from);
    let tets = [[0, 1, 2, 3], [0, 1, 2, 4]].map(|t| positive(&points, t)).to_vec();
    TetMesh { points: points.to_vec(), tets }
}

/// Boundary of a mesh.
fn boundary(mesh: &TetMesh) -> TriMesh {
    let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
    let faces = adjacency.boundary().map(|half| face_vertices(&mesh.tets, half));
    TriMesh { points: mesh.points.clone(), triangles: faces.collect() }
}

#[test]
fn tetrahedra_on_one_side_of_a_face_are_found() {
    let apart = two(-1.0);
    assert_eq!(certify(&apart, &boundary(&apart)), Ok(()));
    let overlapping = two(2.0);
    let Err(CertifyError::NotConforming { face }) = certify(&overlapping, &boundary(&overlapping)) else {
        panic!("the face is shared from one side")
    };
    assert!(face.iter().all(|v| *v < 3), "{face:?}");
}

#[test]
fn tetrahedra_are_positive_and_have_points() {
    let sound = two(-1.0);
    let surface = boundary(&sound);
    let not_positive = |change: &dyn Fn(&mut TetMesh)| {
        let mut mesh = sound.clone();
        change(&mut mesh);
        matches!(certify(&mesh, &surface), Err(CertifyError::NotPositive { tet: 1, .. }))
    };
    assert!(not_positive(&|mesh| mesh.tets[1][3] = 5));
    assert!(not_positive(&|mesh| mesh.tets[1].swap(0, 1)));
    assert!(not_positive(&|mesh| mesh.tets[1][3] = mesh.tets[1][0]));
    let mut flat = sound.clone();
    flat.points[4].z = 0.0;
    let surface = TriMesh { points: flat.points.clone(), ..surface.clone() };
    assert!(matches!(certify(&flat, &surface), Err(CertifyError::NotPositive { tet: 1, .. })));
}

#[test]
fn segments_are_edges() {
    let mesh = two(-1.0);
    assert_eq!(certify_segments(&mesh, &[]), Ok(()));
    assert_eq!(certify_segments(&mesh, &[[0, 1], [3, 0], [4, 2]]), Ok(()));
    assert_eq!(certify_segments(&mesh, &[[0, 1], [3, 4], [0, 2]]), Err(CertifyError::SegmentLost { segment: 1 }));
}

#[test]
fn faces_between_regions_are_triangles_of_the_input() {
    let mesh = two(-1.0);
    let outer = boundary(&mesh);
    let with_face = TriMesh { triangles: [&outer.triangles[..], &[[2, 1, 0]]].concat(), ..outer.clone() };
    let of = |facets: &TriMesh, kind, regions: &[i32]| certify_facets(&mesh, facets, kind, regions);
    let places = |result: Result<Vec<Place>, CertifyError>| result.map(|places| places.last().copied());
    for kind in [InputKind::Closed, InputKind::Plc] {
        assert_eq!(places(of(&outer, kind, &[])), Ok(Some(Place::Boundary)));
        assert_eq!(places(of(&outer, kind, &[3, 3])), Ok(Some(Place::Boundary)));
        assert!(matches!(of(&outer, kind, &[3, 4]), Err(CertifyError::RegionsMix { .. })));
    }
    for regions in [&[][..], &[3, 3], &[3, 4]] {
        assert_eq!(places(of(&with_face, InputKind::Plc, regions)), Ok(Some(Place::Inside)));
    }
    // A closed surface has no triangle inside.
    let lost = of(&with_face, InputKind::Closed, &[]);
    assert_eq!(lost, Err(CertifyError::TriangleLost { triangle: 6 }));
    let absent = TriMesh { triangles: [&outer.triangles[..], &[[0, 3, 4]]].concat(), ..outer };
    assert_eq!(of(&absent, InputKind::Plc, &[]), Err(CertifyError::FacetLost { triangle: 6 }));
}
