//! Conversion of a finished block to a volume mesh.

use super::finished::{Finished, triangle_of};
use anastomesh_mesh::{Patch, VolumeMesh, WALL};

impl Finished {
    /// Converts the block to a mesh with patches: `wall`, `joint_0`, …, and `terminal_N` for terminal N.
    pub fn into_volume(self) -> VolumeMesh {
        let wall = (self.wall, Patch { id: WALL, name: "wall".into(), cap: None });
        let mut labelled = vec![wall];
        for (i, joint) in self.joints.into_iter().enumerate() {
            labelled.push((joint.faces, Patch { id: 0, name: format!("joint_{i}"), cap: None }));
        }
        for cap in self.caps {
            let patch = Patch { id: 0, name: format!("terminal_{}", cap.node.0), cap: Some(cap.disc(cap.node.0)) };
            labelled.push((cap.faces, patch));
        }
        let mut volume = VolumeMesh { tet_block: vec![0; self.mesh.tets.len()], ..VolumeMesh::default() };
        for (id, (faces, patch)) in (WALL..).zip(labelled) {
            volume.boundary.extend(faces.iter().map(|&face| triangle_of(&self.mesh, &self.hull, face)));
            volume.boundary_patch.resize(volume.boundary.len(), id);
            volume.patches.push(Patch { id, ..patch });
        }
        volume.boundary_block = vec![0; volume.boundary.len()];
        volume.mesh = self.mesh;
        volume
    }
}
