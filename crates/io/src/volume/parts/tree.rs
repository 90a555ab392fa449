//! Order of blocks along the tree of blocks that share points. Ranges of this order are separated at few joints.

use std::collections::VecDeque;

/// Marks the absence of a block.
const NONE: u32 = u32::MAX;

/// Graph of blocks, connected if they share points.
pub(in crate::volume) struct BlockGraph {
    pub neighbors: Vec<Vec<u32>>,
    /// Number of cells of each block.
    pub sizes: Vec<u64>,
}

impl BlockGraph {
    /// Preorder with small subtrees before large ones. Every cut of this order separates O(log n) joints, as each open
    /// subtree has at most half the size of its parent.
    ///
    /// The trees of connected components begin at the first of their blocks in `starts`, which lists all blocks, and come in
    /// this order.
    pub(in crate::volume) fn in_preorder(&self, starts: impl IntoIterator<Item = u32>) -> Vec<u32> {
        let (outward, parents) = self.spanning_trees(starts);
        let mut sizes = self.sizes.clone();
        for &part in outward.iter().rev() {
            let parent = parents[part as usize];
            if parent != NONE {
                sizes[parent as usize] += sizes[part as usize];
            }
        }
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); self.sizes.len()];
        let mut pending = Vec::new();
        for &part in outward.iter().rev() {
            match parents[part as usize] {
                NONE => pending.push(part),
                parent => children[parent as usize].push(part),
            }
        }
        let mut order = Vec::with_capacity(self.sizes.len());
        while let Some(part) = pending.pop() {
            order.push(part);
            let own = &mut children[part as usize];
            // The last item pushed comes first.
            own.sort_by_key(|&child| std::cmp::Reverse((sizes[child as usize], child)));
            pending.append(own);
        }
        order
    }

    /// Breadth-first order of the blocks from the first of each component, with their parents.
    fn spanning_trees(&self, starts: impl IntoIterator<Item = u32>) -> (Vec<u32>, Vec<u32>) {
        let count = self.sizes.len();
        let (mut order, mut parents, mut seen) = (Vec::with_capacity(count), vec![NONE; count], vec![false; count]);
        for start in starts {
            if std::mem::replace(&mut seen[start as usize], true) {
                continue;
            }
            let mut front = VecDeque::from([start]);
            while let Some(part) = front.pop_front() {
                order.push(part);
                for &next in &self.neighbors[part as usize] {
                    if !std::mem::replace(&mut seen[next as usize], true) {
                        parents[next as usize] = part;
                        front.push_back(next);
                    }
                }
            }
        }
        (order, parents)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Graph with these joints; all parts have equal size.
    fn graph(count: usize, joints: &[[u32; 2]]) -> BlockGraph {
        let mut parts = BlockGraph { neighbors: vec![Vec::new(); count], sizes: vec![1; count] };
        for &[a, b] in joints {
            parts.neighbors[a as usize].push(b);
            parts.neighbors[b as usize].push(a);
        }
        parts
    }

    #[test]
    fn every_part_comes_once_and_small_branches_first() {
        assert_eq!(graph(6, &[[0, 1], [0, 2], [1, 3], [1, 4], [0, 5]]).in_preorder(0..6), [0, 2, 5, 1, 3, 4]);
        assert_eq!(graph(4, &[[2, 3], [3, 2]]).in_preorder(0..4), [0, 1, 2, 3]);
        // A loop.
        let mut order = graph(5, &[[0, 1], [1, 2], [2, 3], [3, 4], [4, 0]]).in_preorder(0..5);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3, 4]);
    }

    #[test]
    fn a_cut_parts_few_joints() {
        // A full binary tree, with joints numbered after its nodes like connectors after clusters.
        let nodes = 1023_u32;
        let joints: Vec<[u32; 2]> =
            (1..nodes).flat_map(|n| [[(n - 1) / 2, nodes + n - 1], [n, nodes + n - 1]]).collect();
        let order = graph(2 * nodes as usize - 1, &joints).in_preorder(0..2 * nodes - 1);
        let mut place = vec![0; order.len()];
        (0..).zip(&order).for_each(|(i, &part)| place[part as usize] = i);
        for cut in 0..order.len() {
            let parted = joints.iter().filter(|j| (place[j[0] as usize] < cut) != (place[j[1] as usize] < cut)).count();
            assert!(parted <= 20, "{parted} at {cut}");
        }
    }
}
