//! Tetrahedralization of triangles between points of a coarse grid, with or without a box around them. Triangles that
//! intersect others, or contain further points, are left out, so the complex is valid. Its triangles are kept or split,
//! and the mesh is certified.
#![no_main]

use anastomesh_fuzz::stay_on_this_thread;
use anastomesh_mesh::Point3;
use anastomesh_tet::{Boundary, InputKind, Interior, Plc, Refinement, Stuck, TetError, Tetrahedralizer};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    stay_on_this_thread();
    let Some((&mode, rest)) = bytes.split_first() else { return };
    let (places, facets) = rest.split_at(rest.len().min(3 * (4 + usize::from(mode & 15))));
    let mut plc = Plc::new(points(places, mode & 16 != 0), Vec::new());
    let inner = plc.surface.points.len() as u8;
    if inner == 0 {
        return;
    }
    if mode & 32 != 0 {
        add_box(&mut plc);
    }
    for corners in facets.chunks_exact(3).take(40) {
        let [a, b, c] = [0, 1, 2].map(|k| u32::from(corners[k] % inner));
        add(&mut plc, [a, b, c]);
    }
    let splits = mode & 64 != 0;
    let refinement = Refinement::default().max_radius_edge(2.0).max_points(200);
    let made = Tetrahedralizer::new()
        .kind(InputKind::Plc)
        .interior(Interior::None)
        .boundary(if splits { Boundary::Split } else { Boundary::Keep })
        .refine((mode & 128 != 0).then_some(refinement))
        .optimize(mode & 128 != 0)
        .run(&plc);
    match made {
        Ok(made) => {
            let outside = made.summary.left_out.triangles.len();
            let inside = plc.surface.triangles.len() - outside;
            assert!(made.faces.len() == inside || (splits && made.faces.len() > inside));
            assert!(mode & 32 == 0 || outside == 0);
        }
        Err(TetError::Flat | TetError::Empty { .. } | TetError::NothingEnclosed) => {
            assert!(mode & 32 == 0);
        }
        Err(TetError::Stuck { reason: Stuck::Precision | Stuck::Dangling, .. }) => {}
        Err(error) => panic!("{error}\n{plc:?}"),
    }
});

/// Returns distinct points of a grid of 4³ points or, perturbed, of 8³.
fn points(bytes: &[u8], fine: bool) -> Vec<Point3> {
    let mut points: Vec<Point3> = Vec::new();
    for b in bytes.chunks_exact(3) {
        let axis = |b: u8| if fine { f64::from(b & 7) + f64::from(b >> 3) * 1e-3 } else { f64::from(b & 3) };
        let p = Point3::new(axis(b[0]), axis(b[1]), axis(b[2]));
        if !points.contains(&p) {
            points.push(p);
        }
    }
    points
}

/// Adds a box around all points.
fn add_box(plc: &mut Plc) {
    let first = plc.surface.points.len() as u32;
    let side = |high: bool| if high { 9.0 } else { -1.0 };
    plc.surface.points.extend((0..8).map(|i| Point3::new(side(i & 1 != 0), side(i & 2 != 0), side(i & 4 != 0))));
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        plc.surface.triangles.extend([[a, b, c], [a, c, d]].map(|t| t.map(|v| v + first)));
    }
}

/// Adds a triangle unless it makes the complex invalid.
fn add(plc: &mut Plc, triangle: [u32; 3]) {
    plc.surface.triangles.push(triangle);
    if Tetrahedralizer::new().kind(InputKind::Plc).check(&*plc).is_err() {
        plc.surface.triangles.pop();
    }
}
