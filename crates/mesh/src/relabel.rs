//! A mesh with merged patches.

use super::source::{FacePiece, LabelPiece, MeshSource, SourceCounts, TetPiece};
use super::{Patch, VolumeMesh};
use crate::geometry::Point3;
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
    fn counts(&self) -> SourceCounts {
        self.mesh.counts()
    }

    fn patches(&self) -> &[Patch] {
        &self.patches
    }

    fn parts(&self) -> u32 {
        self.mesh.parts()
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        self.mesh.points(part)
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        self.mesh.tets(part)
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let FacePiece { faces, patches, blocks } = self.mesh.boundary(part)?;
        Ok(FacePiece { faces, patches: self.relabel(patches), blocks })
    }

    fn tet_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        self.mesh.tet_labels(part)
    }

    fn face_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        let LabelPiece { count, patches, blocks } = self.mesh.face_labels(part)?;
        Ok(LabelPiece { count, patches: self.relabel(patches), blocks })
    }

    fn points_of(&self, ids: &[u32]) -> io::Result<Vec<Point3>> {
        self.mesh.points_of(ids)
    }

    fn whole(&self) -> Option<&VolumeMesh> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
