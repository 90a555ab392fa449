//! Reduction of displacements that are larger than the overlaps require.
//!
//! The iterations push vessels apart with a margin, and overshoot. Here each group of vessels that moved together goes back
//! towards its place, as far as its vessels keep a smaller clearance.

use super::overlapping::overlapping;
use anastomesh_mesh::geometry::{DisjointSets, Point3};
use anastomesh_skeleton::{Adjacency, Overlap, Overlaps, Skeleton};

/// Clearance that vessels keep, as a fraction of that of the iterations.
const KEPT: f64 = 0.4;
/// Bisections of the displacement. The result is within 1/64 of it.
const BISECTIONS: usize = 6;

/// Clearance that vessels keep for a target `clearance` of the iterations, both in sums of radii.
pub(super) fn kept(clearance: f64) -> f64 {
    1.0 + KEPT * (clearance - 1.0)
}

/// Moves displaced nodes back towards `origin` as far as possible. `clearance`: target distance of the iterations, in sums of
/// radii.
pub(super) fn tighten(skeleton: &mut Skeleton, origin: &[Point3], clearance: f64) {
    let Some(groups) = Groups::of(skeleton, origin, clearance) else { return };
    let moved: Vec<Point3> = skeleton.nodes.iter().map(|n| n.position).collect();
    let adjacency = skeleton.adjacency();
    let kept = kept(clearance);
    // Fractions of the displacement that are too small, and that suffice.
    let mut too_small = vec![0.0; groups.count];
    let mut enough = vec![1.0; groups.count];
    let mut place = |fractions: &[f64], clearances: &[f64]| {
        for (i, node) in skeleton.nodes.iter_mut().enumerate() {
            if let Some(group) = groups.of_node[i] {
                node.position = origin[i] + (moved[i] - origin[i]) * fractions[group];
            }
        }
        let pairs = clearances.iter().flat_map(|&clearance| close(skeleton, &adjacency, clearance).pairs);
        groups.touching(pairs)
    };
    // Groups that are closer than that stay.
    let stays = place(&enough, &[kept]);
    for _ in 0..BISECTIONS {
        let middle = |i: usize| if stays[i] { 1.0 } else { 0.5 * (too_small[i] + enough[i]) };
        let fractions: Vec<f64> = (0..groups.count).map(middle).collect();
        let touch = place(&fractions, &[kept]);
        for i in (0..groups.count).filter(|&i| !stays[i]) {
            *(if touch[i] { &mut too_small[i] } else { &mut enough[i] }) = fractions[i];
        }
    }
    // Two groups that yielded to each other may touch: they keep their displacement. The rule for crotches depends on radii, so
    // pairs that it leaves out with the clearance may overlap without.
    for _ in 0..BISECTIONS {
        let touch = place(&enough, &[kept, 1.0]);
        let again: Vec<usize> = (0..groups.count).filter(|&i| touch[i] && !stays[i] && enough[i] < 1.0).collect();
        if again.is_empty() {
            return;
        }
        for i in again {
            enough[i] = 1.0;
        }
    }
    place(&vec![1.0; groups.count], &[]);
}

/// Pairs of vessels closer than `clearance` times the sum of their radii.
pub(super) fn close(skeleton: &Skeleton, adjacency: &Adjacency, clearance: f64) -> Overlaps {
    overlapping(skeleton, adjacency, false, clearance)
}

/// Displaced nodes that are joined by vessels or by an overlap.
pub(super) struct Groups {
    pub count: usize,
    /// Group of each node; `None` if it has not moved.
    pub of_node: Vec<Option<usize>>,
}

impl Groups {
    pub fn of(skeleton: &Skeleton, origin: &[Point3], clearance: f64) -> Option<Self> {
        let has_moved: Vec<bool> = skeleton.nodes.iter().zip(origin).map(|(n, o)| n.position != *o).collect();
        if !has_moved.contains(&true) {
            return None;
        }
        let mut sets = DisjointSets::new(skeleton.nodes.len());
        for edge in &skeleton.edges {
            let [a, b] = edge.nodes;
            if has_moved[a.index()] && has_moved[b.index()] {
                sets.join(a.0, b.0);
            }
        }
        let mut before = skeleton.clone();
        before.nodes.iter_mut().zip(origin).for_each(|(node, origin)| node.position = *origin);
        for overlap in close(&before, &skeleton.adjacency(), clearance).pairs {
            let mut nodes = overlap.nodes.into_iter().flatten().filter(|n| has_moved[n.index()]);
            if let Some(first) = nodes.next() {
                nodes.for_each(|n| sets.join(first.0, n.0));
            }
        }
        let mut number = vec![None; skeleton.nodes.len()];
        let mut count = 0;
        let of_node = (0..skeleton.nodes.len()).map(|i| {
            let root = sets.find(i as u32) as usize;
            has_moved[i].then(|| {
                *number[root].get_or_insert_with(|| {
                    count += 1;
                    count - 1
                })
            })
        });
        let of_node = of_node.collect();
        Some(Self { count, of_node })
    }

    /// True for each group with a node of one of the pairs.
    pub fn touching(&self, pairs: impl IntoIterator<Item = Overlap>) -> Vec<bool> {
        let mut touching = vec![false; self.count];
        for node in pairs.into_iter().flat_map(|o| o.nodes).flatten() {
            if let Some(group) = self.of_node[node.index()] {
                touching[group] = true;
            }
        }
        touching
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::network;

    /// A vessel along x, and one along y at this height whose middle node came from a height of 1.2.
    fn crossing(height: f64) -> (Skeleton, Vec<Point3>) {
        let points = [[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, -9.0, 1.2], [0.0, 0.0, height], [0.0, 9.0, 1.2]];
        let skeleton = network(&points, 1.0, &[(0, 1), (2, 3), (3, 4)]);
        let mut origin: Vec<Point3> = skeleton.nodes.iter().map(|n| n.position).collect();
        origin[3].z = 1.2;
        (skeleton, origin)
    }

    #[test]
    fn a_vessel_goes_back_to_the_kept_clearance() {
        let (mut skeleton, origin) = crossing(4.0);
        tighten(&mut skeleton, &origin, 1.2);
        let z = skeleton.nodes[3].position.z;
        assert!((2.16..2.4).contains(&z), "{z}");
        assert!(close(&skeleton, &skeleton.adjacency(), 1.08).pairs.is_empty());
    }

    #[test]
    fn a_vessel_that_is_closer_stays() {
        let (mut skeleton, origin) = crossing(2.12);
        let before = skeleton.clone();
        tighten(&mut skeleton, &origin, 1.2);
        assert_eq!(skeleton, before);
    }
}
