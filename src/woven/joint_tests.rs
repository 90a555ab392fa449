//! Two blocks, merged at a common end surface and smoothed there with the optimizer of the tetrahedralizer.

use std::collections::{HashMap, HashSet};

use super::joints::{Joint, JointOptions, JointReport, smooth_joints};
use anastomesh_mesh::adjacency::boundary_faces;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::quality::TetQuality;
use anastomesh_mesh::{TetMesh, TriMesh};
use anastomesh_tet::parts::Complex;
use anastomesh_tet::parts::{OptimizeOptions, optimize};
use anastomesh_tet::{Effort, Tetrahedralizer};

const SIDES: u32 = 14;
const LAYERS: u32 = 8;
/// Distance of layers, close to that of the sides.
const STEP: f64 = 0.42;

/// Closed tube of radius 1 along z from `z0`, with flat discs at both ends. The end at z = 0 is ragged: a fixed
/// sequence displaces its vertices along z.
fn tube(z0: f64) -> TriMesh {
    let mut points = Vec::new();
    for layer in 0..=LAYERS {
        for i in 0..SIDES {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(SIDES));
            points.push(Point3::new(cos, sin, z0 + f64::from(layer) * STEP));
        }
    }
    let mut triangles = Vec::new();
    for layer in 0..LAYERS {
        for i in 0..SIDES {
            let [a, b] = [layer * SIDES + i, layer * SIDES + (i + 1) % SIDES];
            let [c, d] = [a + SIDES, b + SIDES];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    for (first, bottom) in [(0, true), (LAYERS * SIDES, false)] {
        let z = points[first as usize].z;
        let inner = points.len() as u32;
        for i in 0..SIDES / 2 {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * (f64::from(i) + 0.25) / f64::from(SIDES / 2));
            points.push(Point3::new(0.5 * cos, 0.5 * sin, z));
        }
        let middle = points.len() as u32;
        points.push(Point3::new(0.0, 0.0, z));
        for i in 0..SIDES / 2 {
            let [p, q] = [inner + i, inner + (i + 1) % (SIDES / 2)];
            let [a, b, c] = [2 * i, 2 * i + 1, (2 * i + 2) % SIDES].map(|k| first + k);
            for t in [[p, a, b], [p, b, q], [q, b, c], [middle, p, q]] {
                triangles.push(if bottom { [t[0], t[2], t[1]] } else { t });
            }
        }
    }
    for p in &mut points {
        if p.z.abs() < 1e-9 {
            p.z = 0.3 * libm::sin(7.0 * p.x) * libm::cos(5.0 * p.y + 1.0);
        }
    }
    TriMesh { points, triangles }
}

/// Two blocks in one mesh.
#[derive(Debug, PartialEq)]
struct JoinedBlocks {
    mesh: TetMesh,
    tet_block: Vec<i32>,
}

fn two_blocks() -> (JoinedBlocks, Vec<Joint>, Vec<bool>) {
    let length = f64::from(LAYERS) * STEP;
    let [lower, upper] =
        [-length, 0.0].map(|z0| Tetrahedralizer::new().effort(Effort::Fast).run(&tube(z0)).expect("a tube").mesh);
    let key = |p: &Point3| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()];
    let surface = tube(0.0).points.len();
    let below: HashMap<_, u32> = lower.points.iter().zip(0..).take(surface).map(|(p, v)| (key(p), v)).collect();
    let mut merged = JoinedBlocks { tet_block: vec![0; lower.tets.len()], mesh: lower };
    let mut joint = Joint::default();
    let mut number = Vec::with_capacity(upper.points.len());
    for (local, p) in upper.points.iter().enumerate() {
        let common = below.get(&key(p)).filter(|_| local < surface);
        joint.vertices.extend(common);
        number.push(common.copied().unwrap_or(merged.mesh.points.len() as u32));
        if common.is_none() {
            merged.mesh.points.push(*p);
        }
    }
    assert_eq!(joint.vertices.len() as u32, SIDES + SIDES / 2 + 1);
    merged.mesh.tets.extend(upper.tets.iter().map(|t| t.map(|v| number[v as usize])));
    merged.tet_block.resize(merged.mesh.tets.len(), 1);
    let frozen = merged.mesh.points.iter().map(|p| p.z.abs() > length - 1e-9).collect();
    (merged, vec![joint], frozen)
}

fn smooth(merged: &mut JoinedBlocks, joints: &[Joint], frozen: &[bool]) -> JointReport {
    let improve = |mesh: &mut TetMesh, fixed: usize| {
        let options = OptimizeOptions { fixed_points: fixed, keep_points: true, ..OptimizeOptions::default() };
        optimize(mesh, &options).is_ok()
    };
    smooth_joints(&mut merged.mesh, &mut merged.tet_block, joints, frozen, &JointOptions::default(), &improve)
}

fn face_set(mesh: &TetMesh) -> HashSet<[u32; 3]> {
    let sorted = |mut f: [u32; 3]| {
        f.sort_unstable();
        f
    };
    boundary_faces(mesh).into_iter().map(sorted).collect()
}

#[test]
fn a_ragged_joint_becomes_good_and_stays_valid() {
    let (mut merged, joints, frozen) = two_blocks();
    let (before, faces, points) = (TetQuality::of(&merged.mesh), face_set(&merged.mesh), merged.mesh.points.clone());
    let report = smooth(&mut merged, &joints, &frozen);
    let after = TetQuality::of(&merged.mesh);
    assert_eq!(report.refused, 0);
    assert!(report.tets > 0 && report.worst_after >= report.worst_before, "{report:?}");
    assert!(after.min >= before.min && after.mean > before.mean + 0.005, "{before:?} {after:?}");
    assert!(after.min > 0.2 && after.dihedral_min > 8.0, "{after:?}");
    Complex::from_mesh(merged.mesh.points.clone(), &merged.mesh.tets).unwrap().sanity_check().unwrap();
    assert_eq!(face_set(&merged.mesh), faces);
    assert!(frozen.iter().enumerate().all(|(v, &f)| !f || points[v] == merged.mesh.points[v]));
    assert_eq!(merged.tet_block.len(), merged.mesh.tets.len());
    // Blocks keep their side of the joint.
    for (t, &block) in merged.mesh.tets.iter().zip(&merged.tet_block) {
        let z = t.iter().map(|&v| merged.mesh.points[v as usize].z).sum::<f64>() / 4.0;
        assert!(if block == 0 { z < 0.5 } else { z > -0.5 });
    }
}

#[test]
fn threads_do_not_change_the_bytes() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (mut merged, joints, frozen) = two_blocks();
        pool.install(|| smooth(&mut merged, &joints, &frozen));
        merged
    };
    assert_eq!(run(1), run(3));
}
