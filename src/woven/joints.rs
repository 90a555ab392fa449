//! Smoothing of joints (section 3.2.4 of the paper).
//!
//! The first step is Taubin smoothing of the wall around an end surface's rim. The second step optimizes the cells inside
//! with the wall fixed.
//!
//! Each joint owns the tetrahedra within a few rings of its end surface; rings of close joints meet half-way. The sets
//! are disjoint and shared vertices do not move. Joints are thus processed in parallel, independent of the number of
//! threads.

mod region;
mod wall;

use rayon::prelude::*;

use anastomesh_mesh::TetMesh;
use anastomesh_mesh::smooth::Taubin;
pub use region::Improve;
use region::JointRegion;

/// End surface at which two blocks meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joint {
    /// Vertices of rim and interior, as indices into the whole mesh.
    pub vertices: Vec<u32>,
}

/// Options of joint smoothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointOptions {
    /// Rings of tetrahedra around an end surface that belong to its joint. Vertices one ring further in may move.
    pub rings: u8,
    /// Parameters of Taubin smoothing of the wall.
    pub taubin: Taubin,
    /// Limit to which Taubin smoothing may lower the worst radius ratio around a vertex (or the joint's worst, if
    /// higher). The inside is optimized afterwards.
    pub good: f64,
    /// Radius ratio of an adjacent tetrahedron below which wall vertices are moved along the wall.
    pub lift_below: f64,
    /// Radius ratio of a tetrahedron below which the inside is optimized.
    pub improve_below: f64,
    /// Rounds over wall and inside: Taubin smoothing in the first, lifting in the others.
    pub rounds: usize,
}

impl Default for JointOptions {
    fn default() -> Self {
        Self {
            rings: 1,
            taubin: Taubin { iterations: 6, ..Taubin::default() },
            good: 0.3,
            lift_below: 0.2,
            improve_below: 0.45,
            rounds: 3,
        }
    }
}

/// Report of joint smoothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct JointReport {
    /// Number of joints.
    pub joints: usize,
    /// Number of tetrahedra that belong to a joint.
    pub tets: usize,
    /// Number of moves of wall vertices.
    pub wall_moves: usize,
    /// Joints whose inside could not be optimized, because a tetrahedron was not positive or not conforming.
    pub refused: usize,
    /// Smallest radius ratio in the joints before; infinite without joints.
    pub worst_before: f64,
    /// Smallest radius ratio in the joints after.
    pub worst_after: f64,
}

/// Smooths the joints of a merged mesh.
///
/// `tet_block` holds the block of each tetrahedron and is updated. Unchanged tetrahedra keep their block. New ones get
/// the block of most former tetrahedra around their vertices, or the smaller index if equal. Vertices with `frozen` set
/// (those of caps) and boundary faces do not change. Points keep their index; new ones are appended.
///
/// No tetrahedron is inverted, by the exact predicate. A wall move must not lower the worst radius ratio around it
/// below the joint's worst and `options.good`.
pub fn smooth_joints(
    mesh: &mut TetMesh,
    tet_block: &mut Vec<i32>,
    joints: &[Joint],
    frozen: &[bool],
    options: &JointOptions,
    improve: &Improve,
) -> JointReport {
    let owned = owned_tets(mesh, joints, options.rings);
    let degree = degrees(mesh);
    let whole = &*mesh;
    let blocks = &*tet_block;
    let results: Vec<(JointRegion, JointReport)> = owned
        .par_iter()
        .filter(|tets| !tets.is_empty())
        .map(|tets| {
            let mut region = JointRegion::new(whole, blocks, tets, &degree, frozen);
            let report = smooth_region(&mut region, options, improve);
            (region, report)
        })
        .collect();
    let mut report = JointReport {
        joints: joints.len(),
        worst_before: f64::INFINITY,
        worst_after: f64::INFINITY,
        ..JointReport::default()
    };
    let mut gaps = Vec::new();
    for (region, one) in results {
        report.tets += one.tets;
        report.wall_moves += one.wall_moves;
        report.refused += one.refused;
        report.worst_before = report.worst_before.min(one.worst_before);
        report.worst_after = report.worst_after.min(one.worst_after);
        region.write_back(mesh, tet_block, &mut gaps);
    }
    close_gaps(mesh, tet_block, &mut gaps);
    report
}

fn smooth_region(region: &mut JointRegion, options: &JointOptions, improve: &Improve) -> JointReport {
    let mut report =
        JointReport { tets: region.mesh.tets.len(), worst_before: region.worst(), ..JointReport::default() };
    for round in 0..options.rounds.max(1) {
        if round > 0 && region.worst() >= options.lift_below {
            break;
        }
        let mut walls = wall::Walls::new(region);
        // The wall is moved for a bad tetrahedron only if the inside alone could not improve it.
        let moves = if round == 0 {
            walls.taubin(region, &options.taubin, options.good)
        } else {
            walls.lift(region, options.lift_below)
        };
        report.wall_moves += moves;
        if round > 0 && moves == 0 {
            break;
        }
        if region.worst() < options.improve_below && !region.improve(improve) {
            report.refused = 1;
            break;
        }
    }
    report.worst_after = region.worst();
    report
}

/// Tetrahedra owned by each joint: those with all vertices within `rings` edges of some joint, and the nearest vertex
/// nearest to this one.
fn owned_tets(mesh: &TetMesh, joints: &[Joint], rings: u8) -> Vec<Vec<u32>> {
    const FAR: (u8, u32) = (u8::MAX, u32::MAX);
    // Distance in edges, and the smallest index among the nearest joints.
    let mut nearest = vec![FAR; mesh.points.len()];
    for (j, joint) in joints.iter().enumerate() {
        for &v in &joint.vertices {
            let slot = &mut nearest[v as usize];
            *slot = (*slot).min((0, j as u32));
        }
    }
    for ring in 0..rings.min(u8::MAX - 1) {
        for t in &mesh.tets {
            let Some(owner) = t.iter().map(|&v| nearest[v as usize]).filter(|n| n.0 == ring).min() else { continue };
            for &v in t {
                let slot = &mut nearest[v as usize];
                *slot = (*slot).min((ring + 1, owner.1));
            }
        }
    }
    let mut owned = vec![Vec::new(); joints.len()];
    for (t, corners) in mesh.tets.iter().enumerate() {
        let near = corners.map(|v| nearest[v as usize]);
        if near.iter().all(|n| n.0 <= rings) {
            let owner = near.into_iter().min().unwrap_or(FAR).1;
            owned[owner as usize].push(t as u32);
        }
    }
    owned
}

/// Number of tetrahedra around each vertex.
fn degrees(mesh: &TetMesh) -> Vec<u32> {
    let mut degree = vec![0; mesh.points.len()];
    for &v in mesh.tets.iter().flatten() {
        degree[v as usize] += 1;
    }
    degree
}

/// Removes the tetrahedra listed in `gaps` and keeps the order of the others.
fn close_gaps(mesh: &mut TetMesh, tet_block: &mut Vec<i32>, gaps: &mut [u32]) {
    gaps.sort_unstable();
    let mut next_gap = gaps.iter().copied().peekable();
    let mut kept = 0;
    for t in 0..mesh.tets.len() {
        if next_gap.next_if_eq(&(t as u32)).is_some() {
            continue;
        }
        mesh.tets[kept] = mesh.tets[t];
        tet_block[kept] = tet_block[t];
        kept += 1;
    }
    mesh.tets.truncate(kept);
    tet_block.truncate(kept);
}

#[cfg(test)]
mod tests;
