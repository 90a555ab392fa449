//! Bounding boxes of all parts, with a spatial order and neighbour search.

use crate::geometry::{Aabb, Bvh};

/// Boxes of parts, each stored once.
#[derive(Debug)]
pub(super) struct Boxes {
    tree: Bvh,
    /// Position of each part along the tree's curve.
    rank: Vec<u32>,
}

impl Boxes {
    pub(super) fn new(boxes: Vec<Aabb>) -> Self {
        let mut rank = vec![0; boxes.len()];
        let tree = Bvh::of(boxes);
        for (place, &part) in (0..).zip(tree.order()) {
            rank[part as usize] = place;
        }
        Self { tree, rank }
    }

    pub(super) fn of(&self, part: u32) -> &Aabb {
        self.tree.box_at(self.rank[part as usize] as usize)
    }

    pub(super) fn tree(&self) -> &Bvh {
        &self.tree
    }

    /// All parts in spatial order.
    pub(super) fn along_curve(&self) -> &[u32] {
        self.tree.order()
    }

    /// Pairs of a part with later parts that it may intersect, in their order.
    pub(super) fn partners(&self, part: u32) -> Vec<[u32; 2]> {
        let rank = |part: u32| self.rank[part as usize];
        let mut found = Vec::new();
        self.tree.query(self.of(part), |other| {
            if rank(other) > rank(part) {
                found.push([part, other]);
            }
        });
        found.sort_unstable_by_key(|pair| rank(pair[1]));
        found
    }

    /// Boxes by part index.
    pub(super) fn into_vec(self) -> Vec<Aabb> {
        self.tree.into_boxes()
    }
}
