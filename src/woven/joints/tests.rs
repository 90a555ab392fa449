use super::*;
use anastomesh_mesh::adjacency::{Incidence, boundary_faces, vertices_of};
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::{TetQuality, radius_ratio};
use anastomesh_mesh::shapes::{perturb, tube_lattice};
use proptest::prelude::*;

const LAYERS: u32 = 18;
const STEP: f64 = 0.3;

/// Tube of three blocks with joints at layers 6 and 6 + `gap`, with random displacements near the joints.
struct Shaken {
    mesh: TetMesh,
    blocks: Vec<i32>,
    joints: Vec<Joint>,
    caps: Vec<bool>,
}

fn shaken(gap: u32, size: f64, seed: u64) -> Shaken {
    let mut mesh = tube_lattice(3, LAYERS, STEP);
    let per_layer = mesh.points.len() as u32 / (LAYERS + 1);
    let layer_of = |v: u32| v / per_layer;
    let joints: Vec<Joint> =
        [6, 6 + gap].map(|layer| Joint { vertices: (layer * per_layer..(layer + 1) * per_layer).collect() }).to_vec();
    let block = |t: &[u32; 4]| match t.iter().map(|&v| layer_of(v)).min() {
        Some(layer) if layer < 6 => 0,
        Some(layer) if layer >= 6 + gap => 1,
        _ => 2,
    };
    let blocks = mesh.tets.iter().map(block).collect();
    let near: Vec<bool> = (0..mesh.points.len() as u32)
        .map(|v| layer_of(v).abs_diff(6).min(layer_of(v).abs_diff(6 + gap)) <= 1)
        .collect();
    let caps = (0..mesh.points.len() as u32).map(|v| [0, LAYERS].contains(&layer_of(v))).collect();
    perturb(&mut mesh.points, &near, size, seed);
    Shaken { mesh, blocks, joints, caps }
}

fn all_positive(mesh: &TetMesh) -> bool {
    mesh.tets.iter().all(|t| {
        let [a, b, c, d] = t.map(|v| &mesh.points[v as usize]);
        orient3d(a, b, c, d) > 0.0
    })
}

/// Moves free vertices towards the mean of their neighbours, fully, by half or by a quarter. No tetrahedron may invert,
/// and the worst must not degrade.
fn laplacian(mesh: &mut TetMesh, fixed: usize) -> bool {
    let around = Incidence::of_cells(&mesh.tets, mesh.points.len());
    let neighbors = Incidence::of_vertices(&mesh.tets, mesh.points.len());
    let worst = |mesh: &TetMesh, v: u32| {
        let corners = around.get(v).iter().map(|&t| mesh.tets[t as usize].map(|v| &mesh.points[v as usize]));
        let ratio = |[a, b, c, d]: [&Point3; 4]| {
            if orient3d(a, b, c, d) > 0.0 { radius_ratio(a, b, c, d) } else { f64::NEG_INFINITY }
        };
        corners.map(ratio).fold(f64::INFINITY, f64::min)
    };
    let count = mesh.points.len() as u32;
    for v in (0..4).flat_map(|_| fixed as u32..count) {
        let near = neighbors.get(v);
        let sum: Vec3 = near.iter().map(|&w| mesh.points[w as usize].coords).sum();
        let (start, before) = (mesh.points[v as usize], worst(mesh, v));
        let step = sum / near.len() as f64 - start.coords;
        let taken = [1.0, 0.5, 0.25].into_iter().any(|share| {
            mesh.points[v as usize] = start + step * share;
            worst(mesh, v) >= before
        });
        if !taken {
            mesh.points[v as usize] = start;
        }
    }
    true
}

fn smooth(tube: &mut Shaken, improve: &Improve) -> JointReport {
    smooth_joints(&mut tube.mesh, &mut tube.blocks, &tube.joints, &tube.caps, &JointOptions::default(), improve)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn nothing_inverts_and_the_worst_does_not_get_worse(gap in 1..8_u32, size in 0.0..0.07_f64, seed in any::<u64>()) {
        let mut tube = shaken(gap, size, seed);
        prop_assume!(all_positive(&tube.mesh));
        let (before, faces, points) = (TetQuality::of(&tube.mesh), boundary_faces(&tube.mesh), tube.mesh.points.clone());
        let report = smooth(&mut tube, &laplacian);
        prop_assert!(all_positive(&tube.mesh));
        prop_assert!(TetQuality::of(&tube.mesh).min >= before.min, "{before:?} {report:?}");
        prop_assert!(report.worst_after >= report.worst_before);
        prop_assert_eq!(boundary_faces(&tube.mesh), faces);
        prop_assert!((0..points.len()).all(|v| !tube.caps[v] || points[v] == tube.mesh.points[v]));
    }
}

#[test]
fn a_shaken_wall_becomes_round_again() {
    let tube = shaken(5, 0.06, 4);
    assert!(all_positive(&tube.mesh));
    let on = vertices_of(&boundary_faces(&tube.mesh), tube.mesh.points.len());
    let roughness = |mesh: &TetMesh| {
        let wall = (0..mesh.points.len()).filter(|&v| on[v] && !tube.caps[v]);
        wall.map(|v| (mesh.points[v].xy().coords.norm() - 1.0).powi(2)).sum::<f64>()
    };
    let before = (roughness(&tube.mesh), TetQuality::of(&tube.mesh));
    let mut after = shaken(5, 0.06, 4);
    let options = JointOptions { rings: 2, ..JointOptions::default() };
    let report = smooth_joints(&mut after.mesh, &mut after.blocks, &after.joints, &after.caps, &options, &laplacian);
    assert!(report.wall_moves > 50 && report.refused == 0, "{report:?}");
    assert!(roughness(&after.mesh) < 0.5 * before.0);
    assert!(TetQuality::of(&after.mesh).min > before.1.min);
}

#[test]
fn far_from_the_joints_nothing_moves() {
    let mut tube = shaken(3, 0.05, 9);
    let points = tube.mesh.points.clone();
    let per_layer = points.len() / (LAYERS as usize + 1);
    smooth(&mut tube, &laplacian);
    for (v, p) in points.iter().enumerate() {
        let layer = v / per_layer;
        assert!((2..=13).contains(&layer) || *p == tube.mesh.points[v]);
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut tube = shaken(2, 0.05, 21);
        pool.install(|| smooth(&mut tube, &laplacian));
        (tube.mesh, tube.blocks)
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(7));
}

#[test]
fn owners_are_disjoint_and_meet_half_way() {
    let tube = shaken(4, 0.0, 0);
    let owned = owned_tets(&tube.mesh, &tube.joints, 4);
    let mut all: Vec<u32> = owned.concat();
    all.sort_unstable();
    assert!(all.windows(2).all(|w| w[0] < w[1]));
    let half = owned[0].iter().filter(|&&t| tube.blocks[t as usize] == 2).count();
    let other = owned[1].iter().filter(|&&t| tube.blocks[t as usize] == 2).count();
    assert_eq!(half + other, tube.blocks.iter().filter(|&&b| b == 2).count());
    assert!(half.abs_diff(other) < half.max(other) / 2);
}

#[test]
fn new_tetrahedra_take_the_block_of_their_surroundings() {
    // Splits every tetrahedron in four: each quarter must get the block of the whole.
    let split = |mesh: &mut TetMesh, _: usize| {
        for [a, b, c, d] in std::mem::take(&mut mesh.tets) {
            let sum =
                [a, b, c, d].iter().map(|&v| mesh.points[v as usize].coords).sum::<anastomesh_mesh::geometry::Vec3>();
            let m = mesh.points.len() as u32;
            mesh.points.push((sum / 4.0).into());
            mesh.tets.extend([[m, b, c, d], [a, m, c, d], [a, b, m, d], [a, b, c, m]]);
        }
        true
    };
    let mut tube = shaken(6, 0.0, 0);
    let (tets, volume) = (tube.mesh.tets.len(), volumes(&tube));
    let report = smooth_joints(
        &mut tube.mesh,
        &mut tube.blocks,
        &tube.joints,
        &tube.caps,
        &JointOptions { rounds: 1, improve_below: f64::INFINITY, ..JointOptions::default() },
        &split,
    );
    assert_eq!(tube.mesh.tets.len(), tets + 3 * report.tets);
    assert_eq!(tube.blocks.len(), tube.mesh.tets.len());
    assert!(all_positive(&tube.mesh));
    for (a, b) in volumes(&tube).iter().zip(volume) {
        assert!((a / b - 1.0).abs() < 0.1, "{a} {b}");
    }
}

fn volumes(tube: &Shaken) -> [f64; 3] {
    let mut volume = [0.0; 3];
    for (t, &block) in tube.mesh.tets.iter().zip(&tube.blocks) {
        let [a, b, c, d] = t.map(|v| &tube.mesh.points[v as usize]);
        volume[block as usize] += orient3d(a, b, c, d);
    }
    volume
}

#[test]
fn fewer_tetrahedra_leave_no_gap() {
    let mut mesh = TetMesh { points: Vec::new(), tets: (0..6).map(|i| [i; 4]).collect() };
    let mut blocks = vec![0, 1, 2, 3, 4, 5];
    close_gaps(&mut mesh, &mut blocks, &mut [4, 0, 5]);
    assert_eq!(blocks, [1, 2, 3]);
    assert_eq!(mesh.tets, [[1; 4], [2; 4], [3; 4]]);
}

#[test]
fn without_joints_nothing_happens() {
    let mut tube = shaken(4, 0.05, 2);
    tube.joints.clear();
    let points = tube.mesh.points.clone();
    let report = smooth(&mut tube, &laplacian);
    assert_eq!((report.joints, report.tets), (0, 0));
    assert_eq!(points, tube.mesh.points);
}
