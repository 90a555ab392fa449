//! Tetrahedralization of a sphere whose points are moved along their rays and whose edges are flipped. The surface stays
//! star-shaped around the origin, hence valid, and the mesh is certified.
#![no_main]

use anastomesh_fuzz::stay_on_this_thread;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::shapes::banded_sphere;
use anastomesh_mesh::{Point3, TriMesh};
use anastomesh_tet::{Interior, Plc, Tetrahedralizer};
use libfuzzer_sys::fuzz_target;
use std::collections::BTreeMap;

fuzz_target!(|bytes: &[u8]| {
    stay_on_this_thread();
    let Some((&mode, rest)) = bytes.split_first() else { return };
    let mut surface = banded_sphere(2 + u32::from(mode & 3));
    let (radii, flips) = rest.split_at(rest.len().min(surface.points.len()));
    for (p, &b) in surface.points.iter_mut().zip(radii) {
        // Eighths from 1/8 to 32: rounded coordinates, thin spikes, and many points in common planes.
        let scale = f64::from(b % 16 + 1) / if b & 128 == 0 { 8.0 } else { 1.0 };
        *p = Point3::from(p.coords.map(|x| if mode & 16 == 0 { x * scale } else { (x * scale * 8.0).round() / 8.0 }));
    }
    if !seen_from_origin(&surface.points, &surface.triangles) {
        return;
    }
    for &flip in flips.iter().take(300) {
        flip_edge(&mut surface, usize::from(flip));
    }
    let interior = if mode & 32 == 0 { Interior::None } else { Interior::Lattice { cell: None, clearance: None } };
    let made = Tetrahedralizer::new().interior(interior).optimize(mode & 64 != 0).run(&Plc::from(&surface));
    let made = made.unwrap_or_else(|e| panic!("{e}\n{surface:?}"));
    assert_eq!(made.faces.len(), surface.triangles.len());
});

/// Returns true if each triangle faces away from the origin. Two triangles then meet only in shared corners and edges.
fn seen_from_origin(points: &[Point3], triangles: &[[u32; 3]]) -> bool {
    triangles.iter().all(|t| {
        let [a, b, c] = t.map(|v| &points[v as usize]);
        orient3d(&Point3::origin(), a, b, c) > 0.0
    })
}

/// Flips an edge if both new triangles face away from the origin.
fn flip_edge(surface: &mut TriMesh, choice: usize) {
    let mut sides: BTreeMap<[u32; 2], (usize, u32)> = BTreeMap::new();
    for (i, &[a, b, c]) in surface.triangles.iter().enumerate() {
        sides.extend([([a, b], (i, c)), ([b, c], (i, a)), ([c, a], (i, b))]);
    }
    let Some((&[a, b], &(first, c))) = sides.iter().nth(choice % sides.len()) else { return };
    let Some(&(second, d)) = sides.get(&[b, a]) else { return };
    let exists = sides.contains_key(&[c, d]) || sides.contains_key(&[d, c]);
    let new = [[a, d, c], [d, b, c]];
    if !exists && c != d && seen_from_origin(&surface.points, &new) {
        (surface.triangles[first], surface.triangles[second]) = (new[0], new[1]);
    }
}
