//! Surfaces and complexes for tests, and their files.

use anastomesh::Point3;
use anastomesh::TriMesh;
use anastomesh::io::write_surface;
use anastomesh::mesh::shapes::banded_sphere;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// Quadrilaterals of a box, oriented outwards; corner `i` has x, y, z from the bits of `i`.
pub const SIDES: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

pub fn corners(low: f64, high: f64) -> Vec<Point3> {
    let end = |bit: usize| if bit == 0 { low } else { high };
    (0..8).map(|i: usize| Point3::new(end(i & 1), end((i >> 1) & 1), end(i >> 2))).collect()
}

/// Unit cube.
pub fn cube() -> TriMesh {
    let triangles = SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { points: corners(0.0, 1.0), triangles }
}

/// Sphere with this number of rings.
pub fn sphere(rings: u32) -> TriMesh {
    banded_sphere(rings)
}

pub fn save(folder: &TempDir, name: &str, mesh: &TriMesh) -> PathBuf {
    let path = folder.path().join(name);
    write_surface(&path, mesh).expect("a file");
    path
}

pub fn text(folder: &TempDir, name: &str, content: &str) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, content).expect("a file");
    path
}

/// Points as a section of TetGen files, counted from `first`.
pub fn node_list(points: &[Point3], first: usize) -> String {
    let mut out = format!("{} 3 0 0\n", points.len());
    for (i, p) in points.iter().enumerate() {
        let _ = writeln!(out, "{} {} {} {}", i + first, p.x, p.y, p.z);
    }
    out
}

/// Cube with six square facets as a `.smesh`, counted from 1; facet `i` has marker 10 + i.
pub fn cube_smesh() -> String {
    let mut out = node_list(&cube().points, 1) + "6 1\n";
    for (i, side) in SIDES.iter().enumerate() {
        let [a, b, c, d] = side.map(|v| v + 1);
        let _ = writeln!(out, "4 {a} {b} {c} {d} {}", 10 + i);
    }
    out + "0\n0\n"
}

/// Box of 2 × 1 × 1 with a dividing wall that has a window with a mullion. The regions on both sides are connected if
/// the window is open.
pub fn rooms(window_is_open: bool) -> String {
    let mut points = Vec::new();
    for x in [0.0, 1.0, 2.0] {
        points.extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(y, z)| Point3::new(x, y, z)));
    }
    points.extend([(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)].map(|(y, z)| Point3::new(1.0, y, z)));
    let mut out = node_list(&points, 0) + "11 1\n";
    let _ = writeln!(out, "1 0 1\n4 0 3 2 1\n1 0 1\n4 8 9 10 11");
    for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        for base in [0, 4] {
            let _ = writeln!(out, "1 0 2\n4 {} {} {} {}", base + i, base + j, base + j + 4, base + i + 4);
        }
    }
    let hole = if window_is_open { "1 1 0.5 0.4\n" } else { "" };
    let _ = writeln!(out, "2 {} 3\n4 4 5 6 7\n4 12 13 14 15\n{hole}0", u32::from(window_is_open));
    out + "2\n0 0.5 0.5 0.5 7 0.01\n1 1.5 0.5 0.5 -9 0.05\n"
}

pub fn off(mesh: &TriMesh) -> String {
    let mut out = format!("OFF\n{} {} 0\n", mesh.points.len(), mesh.triangles.len());
    for p in &mesh.points {
        let _ = writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(out, "3 {a} {b} {c}");
    }
    out
}
