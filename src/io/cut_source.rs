//! A mesh in memory that pretends not to be: it is given in pieces of any sizes.

use crate::geometry::Point3;
use crate::mesh::source::{EachFaces, EachPoints, EachTets, FacePiece, MeshSource, SourceCounts, TetPiece};
use crate::mesh::{Patch, VolumeMesh};
use std::io;
use std::ops::Range;

/// The mesh, and the sizes of its pieces, over and over again.
pub(super) struct Cut<'a> {
    pub volume: &'a VolumeMesh,
    pub sizes: &'a [usize],
}

impl Cut<'_> {
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
}

/// What of a list is there: it may be empty.
fn known(values: &[i32], range: Range<usize>) -> &[i32] {
    values.get(range).unwrap_or_default()
}

impl MeshSource for Cut<'_> {
    fn counts(&self) -> SourceCounts {
        self.volume.counts()
    }

    fn patches(&self) -> &[Patch] {
        &self.volume.patches
    }

    fn points(&self, each: EachPoints) -> io::Result<()> {
        let points: &[Point3] = &self.volume.mesh.points;
        self.ranges(points.len()).into_iter().try_for_each(|range| each(&points[range]))
    }

    fn tets(&self, each: EachTets) -> io::Result<()> {
        let volume = self.volume;
        self.ranges(volume.mesh.tets.len()).into_iter().try_for_each(|range| {
            each(TetPiece { tets: &volume.mesh.tets[range.clone()], blocks: known(&volume.tet_block, range) })
        })
    }

    fn boundary(&self, each: EachFaces) -> io::Result<()> {
        let volume = self.volume;
        self.ranges(volume.boundary.len()).into_iter().try_for_each(|range| {
            each(FacePiece {
                faces: &volume.boundary[range.clone()],
                patches: known(&volume.boundary_patch, range.clone()),
                blocks: known(&volume.boundary_block, range),
            })
        })
    }
}
