//! Choice of the cells that have a canonical fork, and of those near each fork of a network.

use super::shape::{Fork, Shape};
use crate::partition::{Cluster, ForkCell, ForkCells};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Minimum number of forks in a cell with a canonical fork, which takes about as long as a contoured one.
const MANY: u32 = 4;
/// Maximum distance of a fork from the middle of its small and large cells in each coordinate, in steps.
const NEAR: [f32; 2] = [1.25, 2.0];

/// Cells of the clusters of a network. Cells that many forks are in are chosen: small ones, then large ones for the forks
/// that are near none of these.
pub fn shared_cells(count: u32, cluster: impl Fn(u32) -> Cluster + Sync) -> ForkCells {
    let mut cells = ForkCells { chosen: Vec::new(), nearest: vec![[None; 2]; count as usize] };
    for is_coarse in [false, true] {
        let open: Vec<u32> = (0..count).filter(|&i| cells.nearest[i as usize] == [None; 2]).collect();
        let shape = |&i: &u32| Fork::of(&cluster(i)).and_then(|fork| fork.shape(is_coarse)).map(|shape| (i, shape));
        let shapes: Vec<(u32, Shape)> = open.par_iter().filter_map(shape).collect();
        let mut forks: FxHashMap<ForkCell, u32> = FxHashMap::default();
        for cell in shapes.iter().filter_map(|(_, shape)| shape.cell()) {
            *forks.entry(cell).or_default() += 1;
        }
        let many = forks.into_iter().filter(|(_, forks)| *forks >= MANY);
        let mut chosen: Vec<ForkCell> = many.map(|(cell, _)| cell).collect();
        chosen.sort_unstable();
        let first = cells.chosen.len() as u32;
        let nearest = |(i, shape): &(u32, Shape)| {
            (*i, nearest(shape, &chosen, NEAR[usize::from(is_coarse)]).map(|cell| cell.map(|cell| first + cell)))
        };
        for (i, nearest) in shapes.par_iter().map(nearest).collect::<Vec<_>>() {
            cells.nearest[i as usize] = nearest;
        }
        cells.chosen.extend(chosen);
    }
    cells
}

/// Places in a sorted list of the two nearest cells with the same sides, in this distance.
fn nearest(shape: &Shape, chosen: &[ForkCell], most: f32) -> [Option<u32>; 2] {
    // Cells are sorted by sides, then by the first coordinate.
    let [lowest, highest] = shape.first_steps(most);
    let first = chosen.partition_point(|cell| (cell.sides, cell.steps[0]) < (shape.sides, lowest));
    let is_near = |cell: &&ForkCell| cell.sides == shape.sides && cell.steps[0] <= highest;
    let mut best = [(f32::INFINITY, None); 2];
    for (cell, i) in chosen[first..].iter().take_while(is_near).zip(first as u32..) {
        let Some(distance) = shape.distance(cell, most) else { continue };
        if distance < best[0].0 {
            best = [(distance, Some(i)), best[0]];
        } else if distance < best[1].0 {
            best[1] = (distance, Some(i));
        }
    }
    best.map(|(_, cell)| cell)
}
