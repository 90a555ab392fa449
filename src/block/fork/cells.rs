//! Choice of the cells that have a canonical fork, and of those near each fork of a network.

use super::image;
use super::shape::{Fork, Shape};
use crate::partition::{Cluster, ForkCell, ForkCells};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Minimum number of forks in a cell with a canonical fork, which takes about as long as a contoured one.
const MANY: u32 = 8;
/// Minimum number of forks around a cell of the second choice.
const SOME: usize = 3;
/// Distance in steps up to which most images are good. At this distance, 90 % are.
const CLOSE: f32 = 1.3;
/// Maximum distance of a fork from the middle of its cell. There, 60 % of the images are good.
const FAR: f32 = 1.8;
/// Maximum number of cells near a fork that are candidates of the second choice. It bounds the work.
const CANDIDATES: usize = 256;

/// Cells of the clusters of a network. Cells that many forks are in are chosen, then cells that forks far from all of these are
/// close to. `stretch`: that of tubes.
pub fn shared_cells(count: u32, stretch: f64, cluster: impl Fn(u32) -> Cluster + Sync) -> ForkCells {
    let stretch = image::stretch(stretch);
    let shape = |i| {
        let shape = Fork::of(&cluster(i))?.shape(stretch)?;
        Some((i, shape, shape.cell()?))
    };
    let shapes: Vec<(u32, Shape, ForkCell)> = (0..count).into_par_iter().filter_map(shape).collect();
    let mut forks: FxHashMap<ForkCell, u32> = FxHashMap::default();
    for (_, _, cell) in &shapes {
        *forks.entry(*cell).or_default() += 1;
    }
    let many = forks.iter().filter(|(_, forks)| **forks >= MANY);
    let mut chosen: Vec<ForkCell> = many.map(|(cell, _)| *cell).collect();
    chosen.sort_unstable();
    let index = Index::of(&chosen);
    let is_open = |(_, shape, _): &&(u32, Shape, ForkCell)| index.near(shape, CLOSE).next().is_none();
    let open = shapes.par_iter().filter(is_open).map(|(_, shape, cell)| (*shape, *cell));
    let more = cover(&open.collect::<Vec<_>>());
    chosen.extend(more);
    let mut cells = ForkCells { chosen, nearest: vec![[None; 2]; count as usize] };
    let index = Index::of(&cells.chosen);
    let nearest = |(i, shape, _): &(u32, Shape, ForkCell)| (*i, index.nearest(shape));
    for (i, nearest) in shapes.par_iter().map(nearest).collect::<Vec<_>>() {
        cells.nearest[i as usize] = nearest;
    }
    cells
}

/// Cells of these shapes that several of them are close to, until no further cell has as many that are close to no other. The
/// next cell is always the one with most (greedy set cover; Chvátal 1979).
fn cover(shapes: &[(Shape, ForkCell)]) -> Vec<ForkCell> {
    let mut cells: Vec<ForkCell> = shapes.iter().map(|(_, cell)| *cell).collect();
    cells.sort_unstable();
    cells.dedup();
    let index = Index::of(&cells);
    let near = |(shape, _): &(Shape, _)| index.near(shape, CLOSE).map(|(cell, _)| cell).take(CANDIDATES).collect();
    let near: Vec<Vec<u32>> = shapes.par_iter().map(near).collect();
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); cells.len()];
    for (shape, cells) in (0..).zip(&near) {
        for &cell in cells {
            around[cell as usize].push(shape);
        }
    }
    let mut is_covered = vec![false; shapes.len()];
    let sized = |(cell, shapes): (u32, &Vec<u32>)| (shapes.len(), Reverse(cell));
    let mut heap: BinaryHeap<(usize, Reverse<u32>)> = (0..).zip(&around).map(sized).collect();
    let mut chosen = Vec::new();
    while let Some((before, Reverse(cell))) = heap.pop() {
        let shapes = &mut around[cell as usize];
        shapes.retain(|&shape| !is_covered[shape as usize]);
        if shapes.len() < SOME {
            continue;
        }
        if shapes.len() < before {
            heap.push((shapes.len(), Reverse(cell)));
            continue;
        }
        for &shape in &*shapes {
            is_covered[shape as usize] = true;
        }
        chosen.push(cells[cell as usize]);
    }
    chosen
}

/// Cells by sides and leading steps.
struct Index<'a> {
    cells: &'a [ForkCell],
    groups: FxHashMap<Group, Vec<u32>>,
}

type Group = ([u8; 3], [i8; 3]);

impl<'a> Index<'a> {
    fn of(cells: &'a [ForkCell]) -> Self {
        let mut groups: FxHashMap<Group, Vec<u32>> = FxHashMap::default();
        for (i, cell) in (0..).zip(cells) {
            groups.entry((cell.sides, cell.leading())).or_default().push(i);
        }
        Self { cells, groups }
    }

    /// Cells within a distance of a shape, with the square of their distance.
    fn near(&self, shape: &Shape, most: f32) -> impl Iterator<Item = (u32, f32)> {
        let groups = shape.leading(most).into_iter().filter_map(|leading| self.groups.get(&(shape.sides, leading)));
        groups.flatten().filter_map(move |&i| Some((i, shape.distance(&self.cells[i as usize], most)?)))
    }

    /// The nearest two cells.
    fn nearest(&self, shape: &Shape) -> [Option<u32>; 2] {
        let mut best = [(f32::INFINITY, u32::MAX); 2];
        for (i, distance) in self.near(shape, FAR) {
            let found = (distance, i);
            if found < best[0] {
                best = [found, best[0]];
            } else if found < best[1] {
                best[1] = found;
            }
        }
        best.map(|(distance, i)| distance.is_finite().then_some(i))
    }
}
