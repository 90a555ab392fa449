//! Assembly of woven meshes: merges blocks in memory, smooths joints (section 3.2.4) and labels the boundary.

use std::io;

use super::joints::{Joint, JointOptions, JointReport, smooth_joints};
use super::label::{LabelError, PatchFaces, label};
use anastomesh_mesh::adjacency::TetAdjacency;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_mesh::{Patch, TetMesh, VolumeMesh, WALL};
use anastomesh_tet::{
    Effort,
    parts::{OptimizeOptions, optimize},
};

/// Merged blocks, with the data for joint smoothing.
#[derive(Debug)]
pub struct Assembly {
    volume: VolumeMesh,
    joints: Vec<Joint>,
}

impl Assembly {
    /// Merges the blocks; `joints` lists the vertices of each joint.
    ///
    /// # Errors
    /// A block cannot be read.
    pub fn new(whole: &dyn MeshSource, joints: Vec<Vec<u32>>) -> io::Result<Self> {
        let joints = joints.into_iter().map(|vertices| Joint { vertices }).collect();
        Ok(Self { volume: gather(whole)?, joints })
    }

    /// Smooths the joints; skips the remaining ones after cancellation.
    pub fn smooth(&mut self, progress: &dyn Progress) -> JointReport {
        let VolumeMesh { mesh, tet_block, boundary, boundary_patch, .. } = &mut self.volume;
        let mut frozen = vec![false; mesh.points.len()];
        let caps = boundary.iter().zip(&*boundary_patch).filter(|(_, patch)| **patch != WALL);
        for &v in caps.flat_map(|(face, _)| face) {
            frozen[v as usize] = true;
        }
        let improve = |mesh: &mut TetMesh, fixed: usize| {
            if progress.is_cancelled() {
                return false;
            }
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

    /// Labels the boundary; also returns the face neighbours.
    ///
    /// # Errors
    /// A cap is not on the boundary.
    pub fn label(self) -> Result<(VolumeMesh, TetAdjacency), LabelError> {
        let VolumeMesh { mesh, tet_block, boundary, boundary_patch, patches, .. } = self.volume;
        let mut faces: Vec<(i32, [u32; 3])> = boundary_patch.into_iter().zip(boundary).collect();
        faces.sort_by_key(|(patch, _)| *patch);
        let of = |patch: Patch| {
            let first = faces.partition_point(|(id, _)| *id < patch.id);
            let own = faces[first..].iter().take_while(|(id, _)| *id == patch.id).map(|(_, face)| *face).collect();
            PatchFaces { patch, faces: own }
        };
        label(mesh, tet_block, patches.into_iter().filter(|patch| patch.id != WALL).map(of).collect())
    }
}
