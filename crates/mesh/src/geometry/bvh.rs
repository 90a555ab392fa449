//! Bounding volume hierarchy over axis-aligned boxes.
//!
//! The boxes are sorted along the Hilbert curve of their centres (Kamel, Faloutsos, 'Hilbert R-tree', 1994), and the
//! list is halved recursively. One sort builds the tree, and its depth is logarithmic for any boxes. All traversals are
//! iterative. The tree and the order of results are deterministic.

use super::hilbert::hilbert_keys;
use super::{Aabb, Point3};

/// Maximum boxes in a leaf.
const LEAF: usize = 4;

/// Stack depth of a traversal, sufficient for 2^32 boxes.
const STACK: usize = 128;

#[derive(Clone, Copy, Debug)]
struct BvhNode {
    aabb: Aabb,
    /// Start of a leaf's range in `items`. An inner node has `count` 0 and its right child here; the left one is next.
    first: u32,
    count: u32,
}

/// Search tree over boxes, named by their index in the input slice.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<BvhNode>,
    items: Vec<u32>,
    /// The boxes in the order of `items`.
    boxes: Vec<Aabb>,
}

impl Bvh {
    /// Builds the tree. Boxes must not contain NaN; `Aabb::EMPTY` is valid and never found.
    pub fn new(boxes: &[Aabb]) -> Self {
        Self::of(boxes.to_vec())
    }

    /// Builds the tree and takes over the boxes, to avoid a copy of millions.
    pub fn of(mut boxes: Vec<Aabb>) -> Self {
        let items = along_hilbert_curve(&boxes);
        arrange(&mut boxes, &items);
        let mut nodes = Vec::with_capacity(boxes.len() / 2 + 1);
        // Stack of ranges to build, left ones on top so that a left child follows its parent. Right children have
        // `parent` set and store their index in it.
        let mut pending: Vec<(usize, usize, Option<usize>)> = Vec::new();
        if !boxes.is_empty() {
            pending.push((0, boxes.len(), None));
        }
        while let Some((start, end, parent)) = pending.pop() {
            let index = nodes.len();
            if let Some(parent) = parent {
                let node: &mut BvhNode = &mut nodes[parent];
                node.first = index as u32;
            }
            let range = &boxes[start..end];
            let leaf = range.len() <= LEAF;
            let of = if leaf { range } else { &[] };
            let aabb = of.iter().fold(Aabb::EMPTY, |sum, aabb| sum.union(aabb));
            nodes.push(BvhNode { aabb, first: start as u32, count: of.len() as u32 });
            if !leaf {
                let middle = start.midpoint(end);
                pending.push((middle, end, Some(index)));
                pending.push((start, middle, None));
            }
        }
        // Children come after their parent.
        for i in (0..nodes.len()).rev() {
            if nodes[i].count == 0 && i + 1 < nodes.len() {
                nodes[i].aabb = nodes[i + 1].aabb.union(&nodes[nodes[i].first as usize].aabb);
            }
        }
        Self { nodes, items, boxes }
    }

    /// Returns the boxes in input order.
    pub fn into_boxes(self) -> Vec<Aabb> {
        let Self { items, mut boxes, nodes } = self;
        drop(nodes);
        let mut places = vec![0; items.len()];
        for (place, &item) in (0..).zip(&items) {
            places[item as usize] = place;
        }
        arrange(&mut boxes, &places);
        boxes
    }

    /// Box indices in tree order, in which neighbours are close in space.
    pub fn order(&self) -> &[u32] {
        &self.items
    }

    /// Box at a position of that order.
    pub fn box_at(&self, place: usize) -> &Aabb {
        &self.boxes[place]
    }

    /// Calls `found` for every box that overlaps `aabb`.
    pub fn query(&self, aabb: &Aabb, mut found: impl FnMut(u32)) {
        self.any(aabb, |i| {
            found(i);
            false
        });
    }

    /// True if `is` holds for a box that overlaps `aabb`. No further box is tried then.
    pub fn any(&self, aabb: &Aabb, mut is: impl FnMut(u32) -> bool) -> bool {
        let mut stack = [0_u32; STACK];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let index = stack[depth];
            let node = &self.nodes[index as usize];
            if !node.aabb.overlaps(aabb) {
                continue;
            }
            if node.count == 0 {
                stack[depth] = node.first;
                stack[depth + 1] = index + 1;
                depth += 2;
                continue;
            }
            if node.range().any(|i| self.boxes[i].overlaps(aabb) && is(self.items[i])) {
                return true;
            }
        }
        false
    }

    /// Calls `found(a, b)`, a < b, once for every pair of overlapping boxes of this tree.
    pub fn self_pairs(&self, mut found: impl FnMut(u32, u32)) {
        let mut pending: Vec<(u32, u32)> = Vec::new();
        if !self.nodes.is_empty() {
            pending.push((0, 0));
        }
        while let Some((i, j)) = pending.pop() {
            let (a, b) = (&self.nodes[i as usize], &self.nodes[j as usize]);
            if i != j {
                if a.aabb.overlaps(&b.aabb) && !self.descend(i, a, j, b, &mut pending) {
                    for m in a.range().filter(|&m| self.boxes[m].overlaps(&b.aabb)) {
                        for n in b.range() {
                            self.pair(m, n, &mut found);
                        }
                    }
                }
            } else if a.count == 0 {
                pending.extend([(i + 1, a.first), (a.first, a.first), (i + 1, i + 1)]);
            } else {
                for m in a.range() {
                    for n in m + 1..a.range().end {
                        self.pair(m, n, &mut found);
                    }
                }
            }
        }
    }

    /// Calls `found(a, b)` once for every box `a` of this tree that overlaps a box `b` of the other.
    pub fn pairs(&self, other: &Self, mut found: impl FnMut(u32, u32)) {
        let mut pending: Vec<(u32, u32)> = Vec::new();
        if !self.nodes.is_empty() && !other.nodes.is_empty() {
            pending.push((0, 0));
        }
        while let Some((i, j)) = pending.pop() {
            let (a, b) = (&self.nodes[i as usize], &other.nodes[j as usize]);
            if !a.aabb.overlaps(&b.aabb) || self.descend(i, a, j, b, &mut pending) {
                continue;
            }
            for m in a.range() {
                for n in b.range() {
                    if self.boxes[m].overlaps(&other.boxes[n]) {
                        found(self.items[m], other.items[n]);
                    }
                }
            }
        }
    }

    /// Replaces a pair of nodes by pairs with the children of the larger one. Returns false if both are leaves.
    #[inline]
    #[allow(clippy::unused_self)]
    fn descend(&self, i: u32, a: &BvhNode, j: u32, b: &BvhNode, pending: &mut Vec<(u32, u32)>) -> bool {
        if a.count > 0 && b.count > 0 {
            return false;
        }
        if b.count > 0 || (a.count == 0 && a.aabb.diagonal() >= b.aabb.diagonal()) {
            pending.extend([(a.first, j), (i + 1, j)]);
        } else {
            pending.extend([(i, b.first), (i, j + 1)]);
        }
        true
    }

    #[inline]
    fn pair(&self, m: usize, n: usize, found: &mut impl FnMut(u32, u32)) {
        if self.boxes[m].overlaps(&self.boxes[n]) {
            let (a, b) = (self.items[m], self.items[n]);
            found(a.min(b), a.max(b));
        }
    }
}

impl BvhNode {
    fn range(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// Permutes boxes in place, cycle by cycle: position `i` receives the box from position `from[i]`.
fn arrange(boxes: &mut [Aabb], from: &[u32]) {
    let mut is_done = vec![false; boxes.len()];
    for start in 0..boxes.len() {
        let mut place = start;
        while !std::mem::replace(&mut is_done[place], true) {
            let next = from[place] as usize;
            if is_done[next] {
                break;
            }
            boxes.swap(place, next);
            place = next;
        }
    }
}

/// Box indices sorted by the Hilbert keys of their centres; empty boxes, without a centre, come first.
fn along_hilbert_curve(boxes: &[Aabb]) -> Vec<u32> {
    let is_full = |b: &Aabb| b.min.x <= b.max.x;
    // The index breaks ties.
    let packed = |key: u64, i: u32| u128::from(key) << 32 | u128::from(i);
    let mut order: Vec<u128> = Vec::with_capacity(boxes.len());
    order.extend((0..).zip(boxes).filter(|(_, b)| !is_full(b)).map(|(i, _)| packed(0, i)));
    let full = (0..).zip(boxes).filter(|(_, b)| is_full(b));
    let centres = full.clone().map(|(_, b)| Point3::from(b.doubled_centre()));
    order.extend(hilbert_keys(centres).zip(full).map(|(key, (i, _))| packed(key, i)));
    order.sort_unstable();
    order.into_iter().map(|entry| entry as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;
    use proptest::prelude::*;

    fn any_box() -> impl Strategy<Value = Aabb> {
        // Small integers give many touching and equal boxes.
        (prop::array::uniform3(-9_i8..9), prop::array::uniform3(0_i8..4)).prop_map(|(p, d)| {
            let at = |i: usize| f64::from(p[i]);
            let to = |i: usize| f64::from(p[i] + d[i]);
            Aabb { min: Point3::new(at(0), at(1), at(2)), max: Point3::new(to(0), to(1), to(2)) }
        })
    }

    proptest! {
        #[test]
        fn finds_what_a_full_search_finds(
            a in prop::collection::vec(any_box(), 0..80),
            b in prop::collection::vec(any_box(), 0..80),
        ) {
            let (ta, tb) = (Bvh::new(&a), Bvh::new(&b));
            let mut own = Vec::new();
            ta.self_pairs(|i, j| own.push((i, j)));
            own.sort_unstable();
            let mut cross = Vec::new();
            ta.pairs(&tb, |i, j| cross.push((i, j)));
            cross.sort_unstable();
            let mut queried = Vec::new();
            for (j, aabb) in b.iter().enumerate() {
                ta.query(aabb, |i| queried.push((i, j as u32)));
            }
            queried.sort_unstable();
            let mut expect_own = Vec::new();
            let mut expect_cross = Vec::new();
            for i in 0..a.len() {
                expect_own.extend((i + 1..a.len()).filter(|&j| a[i].overlaps(&a[j])).map(|j| (i as u32, j as u32)));
                expect_cross.extend((0..b.len()).filter(|&j| a[i].overlaps(&b[j])).map(|j| (i as u32, j as u32)));
            }
            prop_assert_eq!(own, expect_own);
            prop_assert_eq!(&cross, &expect_cross);
            prop_assert_eq!(queried, expect_cross);
            prop_assert!(ta.order().iter().enumerate().all(|(place, &i)| *ta.box_at(place) == a[i as usize]));
            prop_assert_eq!(ta.into_boxes(), a);
        }
    }

    #[test]
    fn many_equal_boxes_stay_balanced() {
        let boxes = vec![Aabb { min: Point3::origin(), max: Point3::origin() }; 5000];
        let tree = Bvh::new(&boxes);
        let mut count = 0;
        tree.query(&boxes[0], |_| count += 1);
        assert_eq!(count, 5000);
        assert!(tree.nodes.len() < 5000);
    }

    #[test]
    fn empty_boxes_are_never_found() {
        let unit = Aabb { min: Point3::origin(), max: Point3::new(1.0, 1.0, 1.0) };
        let tree = Bvh::new(&[Aabb::EMPTY, unit, Aabb::EMPTY, unit, unit, Aabb::EMPTY]);
        let mut found = Vec::new();
        tree.query(&unit, |i| found.push(i));
        found.sort_unstable();
        assert_eq!(found, [1, 3, 4]);
        assert_eq!(tree.items.len(), 6);
    }
}
