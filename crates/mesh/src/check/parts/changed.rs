//! Tests the walls of changed parts against those near them.
//!
//! This gives no verdict and compares nothing with certificates. It finds the intersections of walls that the check of
//! all parts would find, fast enough to be repeated while a few parts are remeshed.

use super::Parts;
use super::walls::{self, Wall, Walls};
use crate::geometry::{Aabb, Bvh};
use rayon::prelude::*;
use std::io;

/// Pairs with walls in memory at a time.
const TESTED: usize = 256;

/// A set of changed parts among all parts.
#[derive(Clone, Copy, Debug)]
pub struct Changed<'a> {
    /// Boxes of all parts.
    pub boxes: &'a [Aabb],
    /// Changed parts, ascending.
    pub parts: &'a [u32],
}

/// Finds the pairs of parts with intersecting walls, ascending, at least one of them changed.
///
/// # Errors
/// Errors of reading the parts.
pub fn meetings_of(parts: &dyn Parts, changed: Changed) -> io::Result<Vec<[u32; 2]>> {
    let mut walls = Walls::default();
    let mut found = Vec::new();
    for some in changed.pairs().chunks(TESTED) {
        walls::load(|part| Ok(Wall::of(parts.wall(part)?)), some, &mut walls)?;
        found.append(&mut walls::test(some, &walls).parts);
    }
    found.sort_unstable();
    Ok(found)
}

impl Changed<'_> {
    /// Pairs with overlapping boxes, each once, ascending.
    fn pairs(&self) -> Vec<[u32; 2]> {
        let boxes: Vec<Aabb> = self.parts.iter().map(|&part| self.boxes[part as usize]).collect();
        let tree = Bvh::new(&boxes);
        let near = |(part, aabb): (usize, &Aabb)| {
            let mut pairs = Vec::new();
            tree.query(aabb, |i| {
                let (part, other) = (part as u32, self.parts[i as usize]);
                if part != other {
                    pairs.push([part.min(other), part.max(other)]);
                }
            });
            pairs
        };
        let mut pairs: Vec<[u32; 2]> = self.boxes.par_iter().enumerate().flat_map_iter(near).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    #[test]
    fn changed_parts_are_paired_with_all_parts_near_them() {
        let at = |x: f64| Aabb { min: Point3::new(x, 0.0, 0.0), max: Point3::new(x + 1.0, 1.0, 1.0) };
        let boxes = [2.4, 0.0, 0.8, 9.0, 1.6].map(at);
        let pairs = |parts: &[u32]| Changed { boxes: &boxes, parts }.pairs();
        assert_eq!(pairs(&[2]), [[1, 2], [2, 4]]);
        // Pairs of two changed parts are found from both, and named once.
        assert_eq!(pairs(&[0, 2, 4]), [[0, 4], [1, 2], [2, 4]]);
        assert_eq!(pairs(&[3]), [[0; 2]; 0]);
        assert_eq!(pairs(&[]), [[0; 2]; 0]);
    }
}
