//! Parts whose joints can be changed as they are read. They count the reads.

use super::*;
use std::sync::atomic::{AtomicUsize, Ordering};

pub(super) struct Served<'a> {
    pub parts: &'a MemoryParts,
    /// Change of every joint as it is read.
    pub change: fn(&mut FacesApart),
    /// Walls read so far.
    pub walls: AtomicUsize,
    /// Lists of ids read so far.
    pub vertices: AtomicUsize,
}

impl<'a> Served<'a> {
    pub(super) fn of(parts: &'a MemoryParts) -> Self {
        Self { parts, change: |_| (), walls: AtomicUsize::new(0), vertices: AtomicUsize::new(0) }
    }
}

impl Parts for Served<'_> {
    fn count(&self) -> usize {
        self.parts.count()
    }

    fn certificate(&self, part: u32) -> io::Result<Certificate> {
        self.parts.certificate(part)
    }

    fn wall(&self, part: u32) -> io::Result<FacesApart> {
        self.walls.fetch_add(1, Ordering::Relaxed);
        self.parts.wall(part)
    }

    fn joined(&self) -> &[[(u32, u32); 2]] {
        self.parts.joined()
    }

    fn joint(&self, part: u32, joint: u32) -> io::Result<FacesApart> {
        let mut faces = self.parts.joint(part, joint)?;
        (self.change)(&mut faces);
        Ok(faces)
    }

    fn vertex(&self, part: u32, local: u32) -> u32 {
        self.parts.vertex(part, local)
    }

    fn tet(&self, part: u32, local: u32) -> u64 {
        self.parts.tet(part, local)
    }

    fn vertices(&self, part: u32, points: u32) -> io::Result<Vec<u32>> {
        self.vertices.fetch_add(1, Ordering::Relaxed);
        self.parts.vertices(part, points)
    }
}
