//! A source that is taken at its word: a pass that gives more or less than was announced fails.

use crate::mesh::source::{EachFaces, EachLabels, EachPoints, EachTets, MeshSource, SourceCounts};
use crate::mesh::{Patch, VolumeMesh};
use std::io;

/// The source as the writers see it, which write counts before they see the things that are counted.
pub(super) struct Counted<'a>(pub &'a dyn MeshSource);

/// How many things a pass has to give, and has given.
struct Tally {
    expected: usize,
    seen: usize,
}

impl Tally {
    fn of(expected: usize) -> Self {
        Self { expected, seen: 0 }
    }

    fn add(&mut self, count: usize) -> io::Result<()> {
        self.seen += count;
        if self.seen > self.expected { Err(miscounted()) } else { Ok(()) }
    }

    fn finish(&self) -> io::Result<()> {
        if self.seen == self.expected { Ok(()) } else { Err(miscounted()) }
    }
}

/// A source gave something else than it had announced.
pub(super) fn miscounted() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the mesh does not hold as much as it says")
}

impl MeshSource for Counted<'_> {
    fn counts(&self) -> SourceCounts {
        self.0.counts()
    }

    fn patches(&self) -> &[Patch] {
        self.0.patches()
    }

    fn points(&self, each: EachPoints) -> io::Result<()> {
        let mut tally = Tally::of(self.counts().points);
        self.0.points(&mut |points| {
            tally.add(points.len())?;
            each(points)
        })?;
        tally.finish()
    }

    fn tets(&self, each: EachTets) -> io::Result<()> {
        let mut tally = Tally::of(self.counts().tets);
        self.0.tets(&mut |piece| {
            tally.add(piece.tets.len())?;
            each(piece)
        })?;
        tally.finish()
    }

    fn boundary(&self, each: EachFaces) -> io::Result<()> {
        let mut tally = Tally::of(self.counts().boundary);
        self.0.boundary(&mut |piece| {
            tally.add(piece.faces.len())?;
            each(piece)
        })?;
        tally.finish()
    }

    fn tet_labels(&self, each: EachLabels) -> io::Result<()> {
        let mut tally = Tally::of(self.counts().tets);
        self.0.tet_labels(&mut |piece| {
            tally.add(piece.count)?;
            each(piece)
        })?;
        tally.finish()
    }

    fn face_labels(&self, each: EachLabels) -> io::Result<()> {
        let mut tally = Tally::of(self.counts().boundary);
        self.0.face_labels(&mut |piece| {
            tally.add(piece.count)?;
            each(piece)
        })?;
        tally.finish()
    }

    fn whole(&self) -> Option<&VolumeMesh> {
        self.0.whole()
    }
}
