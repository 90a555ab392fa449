//! Synthetic meshes filled with a jittered lattice.

use crate::block::fixtures::jitter;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::geometry::{Point3, Tube, Vec3};
use rustc_hash::FxHashMap;

/// Tube (capsule about its axis) filled with cubes of edge `h`, split into six tetrahedra each. Vertices are jittered
/// by `noise · h`. The lattice is rotated by `seed`, so that tubes intersect it at all angles.
pub(super) fn lattice_tube(tube: &Tube, h: f64, noise: f64, seed: u64) -> TetMesh {
    lattice_tubes(&[*tube], h, noise, seed)
}

pub(super) fn lattice_tubes(tubes: &[Tube], h: f64, noise: f64, seed: u64) -> TetMesh {
    let axis = Vec3::new(jitter(seed, 1), jitter(seed, 2), jitter(seed, 3) + 1e-3);
    let turn = nalgebra::Rotation3::new(axis * 3.0);
    let inverse = turn.inverse();
    let (mut low, mut high) = ([i64::MAX; 3], [i64::MIN; 3]);
    for t in tubes {
        let r = t.max_radius() + 2.0 * h;
        for p in [t.a, t.b] {
            let q = inverse * p;
            for k in 0..3 {
                low[k] = low[k].min(((q[k] - r) / h).floor() as i64);
                high[k] = high[k].max(((q[k] + r) / h).ceil() as i64);
            }
        }
    }
    let mut mesh = TetMesh::default();
    let mut ids: FxHashMap<[i64; 3], u32> = FxHashMap::default();
    for x in low[0]..high[0] {
        for y in low[1]..high[1] {
            for z in low[2]..high[2] {
                add_cell([x, y, z], tubes, h, noise, seed, &turn, &mut mesh, &mut ids);
            }
        }
    }
    mesh
}

fn inside(p: &Point3, tubes: &[Tube]) -> bool {
    tubes.iter().any(|t| {
        let d = t.b - t.a;
        let s = ((p - t.a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0);
        (p - t.point(s)).norm() < t.radius(s)
    })
}

#[allow(clippy::too_many_arguments)]
fn add_cell(
    cell: [i64; 3],
    tubes: &[Tube],
    h: f64,
    noise: f64,
    seed: u64,
    turn: &nalgebra::Rotation3<f64>,
    mesh: &mut TetMesh,
    ids: &mut FxHashMap<[i64; 3], u32>,
) {
    const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let place = |c: [i64; 3]| {
        let key = (c[0] + 5000) as u64 * 100_000_007 + (c[1] + 5000) as u64 * 10_007 + (c[2] + 5000) as u64;
        let j = |k: u64| noise * jitter(seed, 3 * key + k);
        turn * (Point3::new(c[0] as f64 + j(0), c[1] as f64 + j(1), c[2] as f64 + j(2)) * h)
    };
    for path in PATHS {
        let mut corner = cell;
        let mut corners = vec![corner];
        for k in path {
            corner[k] += 1;
            corners.push(corner);
        }
        let p: Vec<Point3> = corners.iter().map(|&c| place(c)).collect();
        let centroid = Point3::from(p.iter().map(|q| q.coords).sum::<Vec3>() / 4.0);
        if !inside(&centroid, tubes) {
            continue;
        }
        let mut t = [0u32; 4];
        for (slot, (c, q)) in t.iter_mut().zip(corners.iter().zip(&p)) {
            *slot = *ids.entry(*c).or_insert_with(|| {
                mesh.points.push(*q);
                mesh.points.len() as u32 - 1
            });
        }
        if (p[1] - p[0]).cross(&(p[2] - p[0])).dot(&(p[3] - p[0])) < 0.0 {
            t.swap(2, 3);
        }
        mesh.tets.push(t);
    }
}
