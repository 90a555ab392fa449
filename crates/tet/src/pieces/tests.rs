use super::*;
use crate::options::Interior;
use anastomesh_mesh::check::check_tets;
use anastomesh_mesh::geometry::Vec3;
use anastomesh_mesh::shapes::sphere_surface;

fn filler() -> Tetrahedralizer {
    Tetrahedralizer::new().interior(Interior::Growing { growth: 1.3 })
}

/// A ball of radius 4 with several small balls missing, oriented outwards.
fn ball_with_holes(holes: u32) -> TriMesh {
    let mut all = TriMesh::default();
    let mut add = |scale: f64, at: Vec3, is_hole: bool| {
        let ball = sphere_surface(if is_hole { 3 } else { 4 });
        let first = all.points.len() as u32;
        all.points.extend(ball.points.iter().map(|p| p * scale + at));
        all.triangles.extend(ball.triangles.iter().map(|&[a, b, c]| {
            let turned = if is_hole { [a, c, b] } else { [a, b, c] };
            turned.map(|v| v + first)
        }));
    };
    add(4.0, Vec3::zeros(), false);
    for i in 0..holes {
        let turn = f64::from(i) * 2.4;
        let height = 2.0 * (2.0 * (f64::from(i) + 0.5) / f64::from(holes) - 1.0);
        let flat = (9.0 - height * height).sqrt() * if i % 2 == 0 { 0.9 } else { 0.45 };
        add(0.3, Vec3::new(flat * libm::cos(turn), flat * libm::sin(turn), height), true);
    }
    all
}

#[test]
fn pieces_fill_a_region_and_keep_its_surface() {
    let surface = ball_with_holes(7);
    let made = fill_in_pieces(&filler(), &surface, 1_500, &Watch::NOBODY).expect("filled");
    let pieces = Pieces::of(&filler(), &surface, 1_500, &Watch::NOBODY).expect("divided").pieces;
    assert!(pieces.len() > 4, "{}", pieces.len());
    assert!(pieces.iter().all(|piece| piece.surface.triangles.len() <= 1_500));
    assert_eq!(made.mesh.points[..surface.points.len()], surface.points);
    assert_eq!(made.faces, surface.triangles);
    let boundary = anastomesh_mesh::adjacency::boundary_faces(&made.mesh);
    let sorted = |faces: &[[u32; 3]]| {
        let mut keys: Vec<[u32; 3]> = faces.iter().map(|f| anastomesh_mesh::face_key(*f)).collect();
        keys.sort_unstable();
        keys
    };
    assert_eq!(sorted(&boundary), sorted(&surface.triangles));
    let faults: Vec<_> = check_tets(&made.mesh, None).failed().map(|line| line.line).collect();
    assert!(faults.is_empty(), "{faults:?}");
    let quality = anastomesh_mesh::quality::TetQuality::of(&made.mesh);
    assert!(quality.dihedral_min > 5.0, "{quality:?}");
    assert!(quality.mean > 0.75, "{quality:?}");
}

#[test]
fn threads_do_not_change_the_pieces() {
    let surface = ball_with_holes(3);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| fill_in_pieces(&filler(), &surface, 2_000, &Watch::NOBODY)).expect("filled")
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn a_region_that_cannot_be_divided_stays_whole() {
    let ball = sphere_surface(1);
    let made = Pieces::of(&filler(), &ball, 10, &Watch::NOBODY).expect("tried");
    assert_eq!(made.pieces.iter().map(|piece| piece.surface.triangles.len()).max(), Some(ball.triangles.len()));
    assert_eq!(made.points, ball.points);
}

#[test]
fn a_surface_with_a_fault_is_refused() {
    let mut open = ball_with_holes(2);
    open.triangles.pop();
    let refused = fill_in_pieces(&filler(), &open, 500, &Watch::NOBODY);
    assert!(matches!(refused, Err(TetError::Open(_))), "{:?}", refused.map(|made| made.mesh.tets.len()));
}
