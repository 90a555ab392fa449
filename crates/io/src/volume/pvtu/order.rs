//! Order of mesh parts for pieces: along the tree of parts that share points. Pieces are ranges of this order and thus
//! separated at few joints.

use anastomesh_mesh::source::{FacePiece, LabelPiece, MeshSource, TetPiece};
use std::collections::VecDeque;
use std::io;

/// Marks the absence of a part.
const NONE: u32 = u32::MAX;

/// Mesh with its parts in another order. Points keep their order and numbers.
pub(super) struct Reordered<'a> {
    mesh: &'a dyn MeshSource,
    order: Vec<u32>,
}

impl<'a> Reordered<'a> {
    /// Orders parts along the tree if each is a separate block, else keeps the order. Reads points and tetrahedra once.
    ///
    /// # Errors
    /// The mesh source fails.
    pub(super) fn along_the_tree(mesh: &'a dyn MeshSource) -> io::Result<Self> {
        let parts = PartGraph::of(mesh)?;
        let order = parts.map_or_else(|| (0..mesh.parts()).collect(), |parts| parts.in_preorder());
        Ok(Self { mesh, order })
    }

    fn part(&self, part: u32) -> u32 {
        self.order[part as usize]
    }
}

impl MeshSource for Reordered<'_> {
    anastomesh_mesh::of_mesh!(counts, patches, parts, points, points_of);

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        self.mesh.tets(self.part(part))
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        self.mesh.boundary(self.part(part))
    }

    fn tet_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        self.mesh.tet_labels(self.part(part))
    }

    fn face_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        self.mesh.face_labels(self.part(part))
    }
}

/// Properties of a part.
struct Joined {
    /// Block of the part, if it is unique.
    block: Option<i32>,
    tets: u64,
    /// Other parts that own some of its points.
    owners: Vec<u32>,
}

impl Joined {
    /// Computes the properties; `starts` holds the first point added by each part.
    fn of(piece: &TetPiece, part: u32, starts: &[u32]) -> Self {
        let own = starts[part as usize]..starts[part as usize + 1];
        let mut others: Vec<u32> = piece.tets.as_flattened().iter().copied().filter(|v| !own.contains(v)).collect();
        others.sort_unstable();
        others.dedup();
        // A missing point is an error that the writer detects.
        others.retain(|v| starts.last().is_some_and(|end| v < end));
        let mut owners: Vec<u32> =
            others.into_iter().map(|v| starts.partition_point(|&start| start <= v) as u32 - 1).collect();
        owners.dedup();
        let block = piece.blocks.first().copied().filter(|block| piece.blocks.iter().all(|other| other == block));
        Self { block, tets: piece.tets.len() as u64, owners }
    }
}

/// Graph of parts, connected if they share points.
struct PartGraph {
    neighbors: Vec<Vec<u32>>,
    tets: Vec<u64>,
}

impl PartGraph {
    /// Returns `None` if a part has several blocks, or a block several parts.
    fn of(mesh: &dyn MeshSource) -> io::Result<Option<Self>> {
        let mut starts = vec![0_u32];
        let mut sum = 0;
        mesh.each_part(
            |part| Ok(mesh.points(part)?.len() as u32),
            |count| {
                sum += count;
                starts.push(sum);
                Ok(())
            },
        )?;
        let mut parts = Self { neighbors: vec![Vec::new(); mesh.parts() as usize], tets: Vec::new() };
        let mut blocks = Vec::with_capacity(parts.neighbors.len());
        mesh.each_part(
            |part| Ok(Joined::of(&mesh.tets(part)?, part, &starts)),
            |Joined { block, tets, owners }| {
                let part = parts.tets.len() as u32;
                for other in owners {
                    parts.neighbors[other as usize].push(part);
                    parts.neighbors[part as usize].push(other);
                }
                parts.tets.push(tets);
                blocks.push(block);
                Ok(())
            },
        )?;
        let count = blocks.len();
        blocks.sort_unstable();
        blocks.dedup();
        Ok(Some(parts).filter(|_| blocks.len() == count && blocks.iter().all(Option::is_some)))
    }

    /// Preorder with small subtrees before large ones. Every cut of this order separates O(log n) joints, as each open
    /// subtree has at most half the size of its parent.
    fn in_preorder(&self) -> Vec<u32> {
        let (outward, parents) = self.spanning_trees();
        let mut sizes = self.tets.clone();
        for &part in outward.iter().rev() {
            let parent = parents[part as usize];
            if parent != NONE {
                sizes[parent as usize] += sizes[part as usize];
            }
        }
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); self.tets.len()];
        let mut pending = Vec::new();
        for &part in outward.iter().rev() {
            match parents[part as usize] {
                NONE => pending.push(part),
                parent => children[parent as usize].push(part),
            }
        }
        let mut order = Vec::with_capacity(self.tets.len());
        while let Some(part) = pending.pop() {
            order.push(part);
            let own = &mut children[part as usize];
            // The last item pushed comes first.
            own.sort_by_key(|&child| std::cmp::Reverse((sizes[child as usize], child)));
            pending.append(own);
        }
        order
    }

    /// Breadth-first order of the parts from the lowest of each component, with their parents.
    fn spanning_trees(&self) -> (Vec<u32>, Vec<u32>) {
        let count = self.tets.len();
        let (mut order, mut parents, mut seen) = (Vec::with_capacity(count), vec![NONE; count], vec![false; count]);
        for start in 0..count as u32 {
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
    fn graph(count: usize, joints: &[[u32; 2]]) -> PartGraph {
        let mut parts = PartGraph { neighbors: vec![Vec::new(); count], tets: vec![1; count] };
        for &[a, b] in joints {
            parts.neighbors[a as usize].push(b);
            parts.neighbors[b as usize].push(a);
        }
        parts
    }

    #[test]
    fn every_part_comes_once_and_small_branches_first() {
        assert_eq!(graph(6, &[[0, 1], [0, 2], [1, 3], [1, 4], [0, 5]]).in_preorder(), [0, 2, 5, 1, 3, 4]);
        assert_eq!(graph(4, &[[2, 3], [3, 2]]).in_preorder(), [0, 1, 2, 3]);
        // A loop.
        let mut order = graph(5, &[[0, 1], [1, 2], [2, 3], [3, 4], [4, 0]]).in_preorder();
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3, 4]);
    }

    #[test]
    fn a_cut_parts_few_joints() {
        // A full binary tree, with joints numbered after its nodes like connectors after clusters.
        let nodes = 1023_u32;
        let joints: Vec<[u32; 2]> =
            (1..nodes).flat_map(|n| [[(n - 1) / 2, nodes + n - 1], [n, nodes + n - 1]]).collect();
        let order = graph(2 * nodes as usize - 1, &joints).in_preorder();
        let mut place = vec![0; order.len()];
        (0..).zip(&order).for_each(|(i, &part)| place[part as usize] = i);
        for cut in 0..order.len() {
            let parted = joints.iter().filter(|j| (place[j[0] as usize] < cut) != (place[j[1] as usize] < cut)).count();
            assert!(parted <= 20, "{parted} at {cut}");
        }
    }
}
