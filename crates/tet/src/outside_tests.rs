//! Tests of triangles and segments outside the filled volume.

use super::certify::{CertifyError, certify_left_out};
use super::*;
use crate::plc::LeftOut;
use anastomesh_mesh::geometry::Point3;

const SIDES: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn add_box(plc: &mut Plc, low: f64, high: f64) {
    let first = plc.surface.points.len() as u32;
    let at = |i: usize| if i & 1 == 0 { low } else { high };
    plc.surface.points.extend((0..8).map(|i| Point3::new(at(i), at(i >> 1), at(i >> 2))));
    for [a, b, c, d] in SIDES.map(|side| side.map(|v| v + first)) {
        plc.surface.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

fn add(plc: &mut Plc, corners: [[f64; 3]; 3]) {
    let n = plc.surface.points.len() as u32;
    plc.surface.points.extend(corners.map(Point3::from));
    plc.surface.triangles.push([n, n + 1, n + 2]);
}

/// A box of side 4 with a hole of side 1 in it. Triangle 0 lies outside, 25 in the hole, 26 at an edge of the box
/// outside, 27 in the filled volume. The first and last segment lie outside.
fn with_things_outside() -> Plc {
    let mut plc = Plc::default();
    add(&mut plc, [[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.5]]);
    add_box(&mut plc, 0.0, 4.0);
    add_box(&mut plc, 1.0, 2.0);
    add(&mut plc, [[1.2, 1.2, 1.5], [1.8, 1.2, 1.5], [1.5, 1.3, 1.5]]);
    plc.surface.points.push(Point3::new(-1.0, -1.0, 2.0));
    plc.surface.triangles.push([3, 7, plc.surface.points.len() as u32 - 1]);
    add(&mut plc, [[2.5, 2.5, 3.0], [3.5, 2.5, 3.0], [3.5, 3.5, 3.0]]);
    plc.segments = vec![[1, 22], [10, 25], [11, 18]];
    plc.holes = vec![Point3::new(1.1, 1.5, 1.9)];
    plc.markers = (0..plc.surface.triangles.len() as i32).map(|i| 100 + i).collect();
    plc
}

fn tetrahedralizer() -> Tetrahedralizer {
    Tetrahedralizer::new().kind(InputKind::Plc)
}

fn volume(mesh: &TetMesh) -> f64 {
    let corners = |t: &[u32; 4]| t.map(|v| mesh.points[v as usize]);
    mesh.tets.iter().map(corners).map(|[a, b, c, d]| (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0).sum()
}

#[test]
fn what_lies_outside_or_in_a_hole_is_left_out() {
    let plc = with_things_outside();
    let kept: Vec<u32> = (0..28).filter(|i| ![0, 25, 26].contains(i)).collect();
    for interior in [Interior::None, Interior::Lattice { cell: None, clearance: None }] {
        let made = tetrahedralizer().interior(interior).run(&plc).unwrap();
        let left_out = &made.summary.left_out;
        assert_eq!((left_out.triangles.as_slice(), left_out.segments.as_slice()), (&[0, 25, 26][..], &[0, 2][..]));
        assert_eq!(made.origins, kept);
        assert_eq!(made.face_markers, kept.iter().map(|&i| 100 + i as i32).collect::<Vec<_>>());
        for (face, &origin) in made.faces.iter().zip(&made.origins) {
            assert_eq!(complex::face_key(*face), complex::face_key(plc.surface.triangles[origin as usize]));
        }
        assert_eq!(made.mesh.points[..plc.surface.points.len()], plc.surface.points);
        assert_eq!(made.summary.interior_faces, 1);
        assert!((volume(&made.mesh) - 63.0).abs() < 1e-9);
    }
}

#[test]
fn a_strict_run_refuses_it() {
    let mut plc = with_things_outside();
    let strict = tetrahedralizer().strict(true);
    let error = strict.run(&plc).unwrap_err();
    assert_eq!(error, TetError::Outside { part: InputPart::Triangles, ids: vec![0, 25, 26], count: 3 });
    for i in [26, 25, 0] {
        plc.surface.triangles.remove(i);
        plc.markers.remove(i);
    }
    let error = strict.run(&plc).unwrap_err();
    assert_eq!(error, TetError::Outside { part: InputPart::Segments, ids: vec![0, 2], count: 2 });
    plc.segments = vec![plc.segments[1]];
    let made = strict.run(&plc).unwrap();
    assert!(made.summary.left_out.is_empty() && made.origins.is_empty());
    assert_eq!(made, tetrahedralizer().run(&plc).unwrap());
}

#[test]
fn pieces_are_left_out_under_the_number_of_the_whole() {
    let plc = with_things_outside();
    let made = tetrahedralizer().boundary(Boundary::Split).sizing(Sizing::Constant(1.2)).run(&plc).unwrap();
    assert!(made.faces.len() > 25 && made.origins.len() == made.faces.len());
    let left_out = &made.summary.left_out;
    assert_eq!((left_out.triangles.as_slice(), left_out.segments.as_slice()), (&[0, 25, 26][..], &[0, 2][..]));
    assert!(made.origins.iter().zip(&made.face_markers).all(|(&o, &m)| m == 100 + o as i32));
    assert!(!made.origins.iter().any(|o| [0, 25, 26].contains(o)));
    assert!((volume(&made.mesh) - 63.0).abs() < 1e-9);
}

#[test]
fn what_cannot_be_recovered_in_pieces_is_none_of_the_mesh_outside() {
    let mut plc = with_things_outside();
    // A diagonal of the hole: valid as it is, but not recoverable once the walls of the hole are split.
    plc.segments = vec![[11, 18]];
    let wanted = Refinement::default().max_radius_edge(1.4).max_volume(0.2);
    let made = tetrahedralizer().boundary(Boundary::Split).refine(Some(wanted)).run(&plc).unwrap();
    let left_out = &made.summary.left_out;
    assert_eq!((left_out.triangles.as_slice(), left_out.segments.as_slice()), (&[0, 25, 26][..], &[0][..]));
    assert!(made.origins.iter().zip(&made.face_markers).all(|(&o, &m)| m == 100 + o as i32));
    assert!((volume(&made.mesh) - 63.0).abs() < 1e-9);
}

#[test]
fn the_certificate_finds_what_was_left_out_and_is_there() {
    let plc = with_things_outside();
    let made = tetrahedralizer().run(&plc).unwrap();
    let surface = TriMesh { points: plc.surface.points.clone(), triangles: plc.surface.triangles.clone() };
    let check = |left_out: LeftOut| certify_left_out(&made.mesh, &surface, &plc.segments, &left_out);
    assert_eq!(check(made.summary.left_out.clone()), Ok(()));
    let wrong = LeftOut { triangles: vec![0, 27], segments: vec![] };
    assert_eq!(check(wrong), Err(CertifyError::NotOutside { part: InputPart::Triangles, id: 27 }));
    let wrong = LeftOut { triangles: vec![], segments: vec![0, 1] };
    assert_eq!(check(wrong), Err(CertifyError::NotOutside { part: InputPart::Segments, id: 1 }));
}

#[test]
fn facets_that_enclose_nothing_are_no_volume() {
    let mut plc = Plc::default();
    add_box(&mut plc, 0.0, 1.0);
    plc.surface.triangles.pop();
    assert_eq!(tetrahedralizer().run(&plc).unwrap_err(), TetError::NothingEnclosed);
}
