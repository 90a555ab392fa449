//! A mesh in pieces, for tests.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use anastomesh_mesh::{Patch, VolumeMesh};
use std::borrow::Cow;
use std::io;
use std::ops::Range;

/// A mesh in memory that pretends not to be: it is given in pieces of these sizes, over and over again.
pub(super) struct InPieces<'a> {
    pub volume: &'a VolumeMesh,
    pub sizes: &'a [usize],
}

impl InPieces<'_> {
    fn ranges(&self, count: usize) -> Vec<Range<usize>> {
        let mut ranges = Vec::new();
        let (mut at, mut sizes) = (0, self.sizes.iter().cycle());
        while at < count {
            let end = count.min(at + sizes.next().unwrap());
            ranges.push(at..end);
            at = end;
        }
        ranges
    }

    /// Range of the items of a part, of `count` in total. The last parts may be empty.
    fn range(&self, count: usize, part: u32) -> Range<usize> {
        self.ranges(count).get(part as usize).cloned().unwrap_or(count..count)
    }
}

/// Range of a list that may be empty.
fn known(values: &[i32], range: Range<usize>) -> Cow<'_, [i32]> {
    values.get(range).unwrap_or_default().into()
}

impl MeshSource for InPieces<'_> {
    fn counts(&self) -> SourceCounts {
        self.volume.counts()
    }

    fn patches(&self) -> &[Patch] {
        &self.volume.patches
    }

    fn parts(&self) -> u32 {
        let SourceCounts { points, tets, boundary } = self.counts();
        self.ranges(points.max(tets).max(boundary)).len() as u32
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        let points = &self.volume.mesh.points;
        Ok(points[self.range(points.len(), part)].into())
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        let VolumeMesh { mesh, tet_block, .. } = self.volume;
        let range = self.range(mesh.tets.len(), part);
        Ok(TetPiece { tets: mesh.tets[range.clone()].into(), blocks: known(tet_block, range) })
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let VolumeMesh { boundary, boundary_patch, boundary_block, .. } = self.volume;
        let range = self.range(boundary.len(), part);
        Ok(FacePiece {
            faces: boundary[range.clone()].into(),
            patches: known(boundary_patch, range.clone()),
            blocks: known(boundary_block, range),
        })
    }
}
