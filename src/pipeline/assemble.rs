//! Blocks → one labelled mesh: merged, joints smoothed, boundary labelled.

use std::sync::Arc;

use super::rounds::Blocks;
use super::terminals::TerminalPatches;
use crate::block::{CapFaces, ClusterMesh, ConnectorMesh};
use crate::mesh::adjacency::TetAdjacency;
use crate::mesh::{Cap, Patch, VolumeMesh};
use crate::partition::Cut;
use crate::skeleton::Skeleton;
use crate::stitch::joints::{Joint, JointOptions, JointReport, smooth_joints};
use crate::stitch::label::{LabelError, PatchFaces, label};
use crate::stitch::merge::{MergeError, Merged, Part, SharedVertex, merge};
use crate::tet::optimize::{Effort, OptimizeOptions, optimize};

/// Why blocks could not be put together. Any of these is a fault of the program.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssembleError {
    /// Blocks do not fit.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// Caps do not fit.
    #[error(transparent)]
    Label(#[from] LabelError),
}

/// The merged blocks, and what of them later stages need.
#[derive(Debug)]
pub struct Assembly {
    merged: Merged,
    joints: Vec<Joint>,
    patches: Vec<PatchFaces>,
}

/// Joins the blocks that were made; consumes them, so that no mesh is held twice for long.
///
/// # Errors
/// When blocks do not fit together.
pub fn join(skeleton: &Skeleton, blocks: Blocks, terminals: &TerminalPatches) -> Result<Assembly, AssembleError> {
    let Blocks { partition, clusters, connectors, .. } = blocks;
    let mut parts = Vec::with_capacity(clusters.len() + connectors.len());
    let mut caps: Vec<(usize, CapFaces)> = Vec::new();
    for (part, cluster) in clusters.into_iter().enumerate() {
        // A cluster that failed stays as an empty part, so that the number of a part is that of its block.
        let ClusterMesh { mesh, caps: own, .. } = cluster.map(Arc::unwrap_or_clone).unwrap_or_default();
        caps.extend(own.into_iter().map(|cap| (part, cap)));
        parts.push(Part { mesh, shared: Vec::new() });
    }
    let mut sides: Vec<[Vec<u32>; 2]> = Vec::with_capacity(connectors.len());
    for (cut, connector) in partition.cuts.iter().zip(connectors) {
        let part = connector.and_then(Result::ok).map(Arc::unwrap_or_clone);
        let (part, ends) = part.map_or_else(empty_part, |connector| connector_part(cut, connector));
        parts.push(part);
        sides.push(ends);
    }
    let first_connector = partition.clusters.len();
    let merged = merge(parts)?;
    let joint = |part: usize, vertices: &[u32]| Joint {
        vertices: vertices.iter().map(|&v| merged.vertex_of[part][v as usize]).collect(),
    };
    let joints = (first_connector..).zip(&sides).flat_map(|(part, ends)| ends.iter().map(move |v| (part, v)));
    let joints = joints.filter(|(_, v)| !v.is_empty()).map(|(part, v)| joint(part, v)).collect();
    let patches = caps.iter().filter_map(|(part, cap)| cap_patch(skeleton, terminals, cap, &merged.vertex_of[*part]));
    let patches = patches.collect();
    Ok(Assembly { merged, joints, patches })
}

fn empty_part() -> (Part, [Vec<u32>; 2]) {
    (Part { mesh: crate::mesh::TetMesh::default(), shared: Vec::new() }, [Vec::new(), Vec::new()])
}

/// A connector as a part, and its vertices on either end surface.
fn connector_part(cut: &Cut, connector: ConnectorMesh) -> (Part, [Vec<u32>; 2]) {
    let mut ends = [Vec::new(), Vec::new()];
    let mut shared = Vec::with_capacity(connector.shared.len());
    for (local, vertex) in (0..).zip(connector.shared) {
        let side = usize::from(vertex.side);
        ends[side].push(local);
        shared.push(SharedVertex { local, part: cut.sides[side].0.0, vertex: vertex.vertex });
    }
    (Part { mesh: connector.mesh, shared }, ends)
}

fn cap_patch(
    skeleton: &Skeleton,
    terminals: &TerminalPatches,
    cap: &CapFaces,
    vertex_of: &[u32],
) -> Option<PatchFaces> {
    let (id, name) = terminals.of.get(&cap.node)?.clone();
    let node = skeleton.node(cap.node);
    let section = cap.section;
    let disc = Cap { node: node.original, center: section.origin, normal: section.axis, radius: section.radius };
    let faces = cap.triangles.iter().map(|t| t.map(|v| vertex_of[v as usize])).collect();
    Some(PatchFaces { patch: Patch { id, name, cap: Some(disc) }, faces })
}

impl Assembly {
    /// Smooths the joints (3.2.4).
    pub fn smooth(&mut self) -> JointReport {
        let Merged { mesh, tet_block, .. } = &mut self.merged;
        let mut frozen = vec![false; mesh.points.len()];
        for &v in self.patches.iter().flat_map(|p| &p.faces).flatten() {
            frozen[v as usize] = true;
        }
        let improve = |mesh: &mut crate::mesh::TetMesh, fixed: usize| {
            let options = OptimizeOptions {
                fixed_points: fixed,
                keep_points: true,
                rounds: 2,
                ..OptimizeOptions::of(Effort::Quick)
            };
            optimize(mesh, &options).is_ok()
        };
        smooth_joints(mesh, tet_block, &self.joints, &frozen, &JointOptions::default(), &improve)
    }

    /// Labels the boundary; with the mesh come its face neighbours.
    ///
    /// # Errors
    /// When a cap is not on the boundary.
    pub fn label(self) -> Result<(VolumeMesh, TetAdjacency), AssembleError> {
        Ok(label(self.merged.mesh, self.merged.tet_block, self.patches)?)
    }
}
