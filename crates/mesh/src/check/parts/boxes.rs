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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    #[test]
    fn each_pair_is_found_from_the_part_that_is_earlier_on_the_curve() {
        let at = |x: f64| Aabb { min: Point3::new(x, 0.0, 0.0), max: Point3::new(x + 1.0, 1.0, 1.0) };
        // Out of order: 0 meets 2, 2 meets 4, 4 meets 1; 3 is apart.
        let boxes = Boxes::new([0.0, 2.4, 0.8, 9.0, 1.6].map(at).to_vec());
        let place = |part: u32| boxes.along_curve().iter().position(|&other| other == part);
        let mut found: Vec<[u32; 2]> = Vec::new();
        for part in 0..5 {
            for pair in boxes.partners(part) {
                assert!(pair[0] == part && place(part) < place(pair[1]), "{pair:?}");
                found.push([pair[0].min(pair[1]), pair[0].max(pair[1])]);
            }
        }
        found.sort_unstable();
        assert_eq!(found, [[0, 2], [1, 4], [2, 4]]);
    }
}
