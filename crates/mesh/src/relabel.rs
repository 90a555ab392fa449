//! A mesh with merged patches.

use super::Patch;
use super::source::{FacePiece, LabelPiece, MeshSource};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;

/// A mesh with other labels on its boundary.
pub struct Relabelled<'a> {
    mesh: &'a dyn MeshSource,
    patches: Vec<Patch>,
    /// New patch of each replaced patch.
    ids: BTreeMap<i32, i32>,
}

impl<'a> Relabelled<'a> {
    /// Replaces patches by `ids`; `patches` are all remaining ones, in ascending order of id.
    pub fn new(mesh: &'a dyn MeshSource, patches: Vec<Patch>, ids: BTreeMap<i32, i32>) -> Self {
        Self { mesh, patches, ids }
    }

    fn relabel<'b>(&self, mut patches: Cow<'b, [i32]>) -> Cow<'b, [i32]> {
        for at in 0..patches.len() {
            if let Some(&id) = self.ids.get(&patches[at]) {
                patches.to_mut()[at] = id;
            }
        }
        patches
    }
}

impl MeshSource for Relabelled<'_> {
    crate::of_mesh!(counts, parts, points, tets, tet_labels, points_of);

    fn patches(&self) -> &[Patch] {
        &self.patches
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let FacePiece { faces, patches, blocks } = self.mesh.boundary(part)?;
        Ok(FacePiece { faces, patches: self.relabel(patches), blocks })
    }

    fn face_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        let LabelPiece { count, patches, blocks } = self.mesh.face_labels(part)?;
        Ok(LabelPiece { count, patches: self.relabel(patches), blocks })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VolumeMesh;
    use crate::source::gather;

    #[test]
    fn labels_change_and_nothing_else() {
        let boundary = vec![[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]];
        let mesh = VolumeMesh { boundary, boundary_patch: vec![1, 4, 3, 2], ..VolumeMesh::default() };
        let outlets = Patch { id: 3, name: "outlets".into(), cap: None };
        let relabelled = Relabelled::new(&mesh, vec![outlets.clone()], [(4, 3)].into());
        let expected = VolumeMesh {
            boundary_patch: vec![1, 3, 3, 2],
            boundary_block: vec![0; 4],
            patches: vec![outlets],
            ..mesh.clone()
        };
        assert_eq!(gather(&relabelled).unwrap(), expected);
        assert_eq!(*relabelled.face_labels(0).unwrap().patches, [1, 3, 3, 2]);
    }
}
