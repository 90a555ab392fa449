//! Assignment of tetrahedra and boundary faces to pieces.

use anastomesh_mesh::source::MeshSource;
use rustc_hash::FxHashMap;
use std::io;

/// Pieces as consecutive ranges of tetrahedra.
#[derive(Debug)]
pub(super) struct Plan {
    /// End of each piece; there is at least one piece.
    pub ends: Vec<usize>,
    /// Pieces of each block's tetrahedra.
    spans: FxHashMap<i32, Span>,
    /// All pieces, for faces of blocks without tetrahedra.
    everywhere: Span,
}

/// Range of pieces with parts of a block.
#[derive(Clone, Copy, Debug)]
struct Span {
    first: usize,
    last: usize,
    /// Number of the block's boundary faces.
    faces: usize,
}

impl Plan {
    /// Cuts between blocks so that pieces have at most `limit` tetrahedra, and within larger blocks. Reads the
    /// tetrahedra and the boundary once. Memory grows with the number of blocks only.
    ///
    /// # Errors
    /// The mesh source fails.
    pub(super) fn of(mesh: &dyn MeshSource, limit: usize) -> io::Result<Self> {
        let mut cutter = Cutter { limit: limit.max(1), ..Cutter::default() };
        mesh.each_tets(|piece| {
            for i in 0..piece.tets.len() {
                cutter.add(piece.blocks.get(i).copied().unwrap_or(0));
            }
            Ok(())
        })?;
        let mut plan = cutter.finish();
        mesh.each_faces(|piece| {
            for i in 0..piece.faces.len() {
                plan.span_mut(piece.blocks.get(i).copied().unwrap_or(0)).faces += 1;
            }
            Ok(())
        })?;
        Ok(plan)
    }

    /// Cuts cells with these blocks like [`Plan::of`], and counts the faces.
    pub(super) fn of_blocks(cells: impl Iterator<Item = i32>, faces: impl Iterator<Item = i32>, limit: usize) -> Self {
        let mut cutter = Cutter { limit: limit.max(1), ..Cutter::default() };
        cells.for_each(|block| cutter.add(block));
        let mut plan = cutter.finish();
        faces.for_each(|block| plan.span_mut(block).faces += 1);
        plan
    }

    fn span_mut(&mut self, block: i32) -> &mut Span {
        self.spans.get_mut(&block).unwrap_or(&mut self.everywhere)
    }

    /// Starts a pass over the boundary faces.
    pub(super) fn faces(&self) -> FacePlan<'_> {
        FacePlan { plan: self, seen: FxHashMap::default() }
    }
}

/// Assigns consecutive boundary faces to pieces.
pub(super) struct FacePlan<'a> {
    plan: &'a Plan,
    /// Number of faces seen per block in several pieces, or in none (`None`).
    seen: FxHashMap<Option<i32>, usize>,
}

impl FacePlan<'_> {
    /// Piece of the next face, among those of its block. Faces of a block in several pieces are distributed in order.
    pub(super) fn next(&mut self, block: i32) -> usize {
        let (key, span) = match self.plan.spans.get(&block) {
            Some(span) => (Some(block), span),
            None => (None, &self.plan.everywhere),
        };
        if span.first == span.last {
            return span.first;
        }
        let seen = self.seen.entry(key).or_default();
        let piece = span.first + *seen * (span.last + 1 - span.first) / span.faces.max(1);
        *seen += 1;
        piece.min(span.last)
    }
}

/// Computes the cuts.
#[derive(Default)]
struct Cutter {
    limit: usize,
    at: usize,
    start: usize,
    /// Start of the current block.
    change: usize,
    block: Option<i32>,
    /// Blocks that end in the current piece.
    pending: Vec<i32>,
    ends: Vec<usize>,
    spans: FxHashMap<i32, Span>,
}

impl Cutter {
    fn add(&mut self, block: i32) {
        if self.block != Some(block) {
            self.pending.extend(self.block);
            self.block = Some(block);
            self.change = self.at;
        }
        if self.at - self.start == self.limit {
            if self.change > self.start {
                self.cut(self.change);
            } else {
                self.pending.push(block);
                self.cut(self.at);
            }
        }
        self.at += 1;
    }

    fn cut(&mut self, end: usize) {
        let piece = self.ends.len();
        for block in self.pending.drain(..) {
            self.spans.entry(block).or_insert(Span { first: piece, last: piece, faces: 0 }).last = piece;
        }
        self.ends.push(end);
        self.start = end;
    }

    fn finish(mut self) -> Plan {
        self.pending.extend(self.block);
        if self.at > self.start || self.ends.is_empty() {
            self.cut(self.at);
        }
        let everywhere = Span { first: 0, last: self.ends.len() - 1, faces: 0 };
        Plan { ends: self.ends, spans: self.spans, everywhere }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(blocks: &[i32], limit: usize) -> Plan {
        let mut cutter = Cutter { limit, ..Cutter::default() };
        for &block in blocks {
            cutter.add(block);
        }
        cutter.finish()
    }

    #[test]
    fn cuts_lie_between_blocks() {
        assert_eq!(cut(&[0, 0, 1, 1, 1, 2, 2, 2], 5).ends, [5, 8]);
        assert_eq!(cut(&[0, 0, 1, 1, 1, 2, 2, 2], 4).ends, [2, 5, 8]);
        assert_eq!(cut(&[0, 0, 0, 0], 4).ends, [4]);
        assert_eq!(cut(&[], 4).ends, [0]);
    }

    #[test]
    fn a_large_block_is_cut() {
        let mut plan = cut(&[7, 8, 8, 8, 8, 8, 9], 2);
        assert_eq!(plan.ends, [1, 3, 5, 7]);
        let pieces = |plan: &Plan, blocks: &[i32]| {
            let mut faces = plan.faces();
            blocks.iter().map(|&block| faces.next(block)).collect::<Vec<_>>()
        };
        plan.span_mut(8).faces = 6;
        assert_eq!(pieces(&plan, &[8, 7, 8, 8, 9, 8, 8, 8]), [1, 0, 1, 2, 3, 2, 3, 3]);
        // A block without tetrahedra.
        plan.span_mut(5).faces += 4;
        assert_eq!(pieces(&plan, &[5, 5, 5, 5]), [0, 1, 2, 3]);
    }
}
