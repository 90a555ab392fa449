//! Walls of parts that are not as they were, against those that are near them.
//!
//! No verdict: nothing is held against its certificate here. It says where the check of all parts would find that walls
//! meet, so that this can be asked again and again while a few parts are made anew.

use super::Parts;
use super::walls::{self, Wall, Walls};
use crate::geometry::{Aabb, Bvh};
use rayon::prelude::*;
use std::io;

/// Pairs whose walls are in memory at a time.
const TESTED: usize = 256;

/// Parts of which some have changed.
#[derive(Clone, Copy, Debug)]
pub struct Changed<'a> {
    /// Boxes of all parts.
    pub boxes: &'a [Aabb],
    /// Those that have changed, ascending.
    pub parts: &'a [u32],
}

/// Pairs of parts whose walls meet, ascending, of which at least one has changed.
///
/// # Errors
/// What reading the parts fails with.
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
    /// Pairs whose boxes overlap, each once, ascending.
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
