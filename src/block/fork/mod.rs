//! Forks by template: a bifurcation of three straight vessels, up to cuts or terminals, is the image of a canonical fork.
//!
//! Shapes are divided into cells of angles, radii and lengths. A canonical fork ([`canonical`]) is contoured and filled once
//! per cell. The map to a fork of the cell ([`image`]) moves its points with the three vessels and their crotches
//! ([`crotch`]). Those of the wall then move onto the level set of the fork's own field. Discs at cuts are taken over bit for
//! bit. A canonical fork depends on its cell alone, so the result does not depend on the order of forks. If an image has poor
//! tetrahedra that improvement does not mend, the fork is contoured.
//!
//! Only cells that several forks of the network are in have a canonical fork ([`shared_cells`]). Other forks are images of
//! those of the nearest cells. Shapes have twelve coordinates, so a cell has thousands of neighbours, and alike forks are
//! often in several of them.

mod cache;
mod canonical;
mod crotch;
mod image;
mod shape;
#[cfg(test)]
mod tests;

use super::buried::buried;
use super::params::{BlockParams, EndStyle};
use crate::partition::{Cluster, ForkCells};
use image::FilledFork;
use rayon::prelude::*;
use rustc_hash::{FxBuildHasher, FxHashMap};
use shape::{Cell, Fork};
use std::hash::BuildHasher;

/// Maximum ρ. Larger canonical forks would take much memory, and more than a second that cannot be cancelled.
const FINEST: f64 = 6.0;
/// Minimum number of forks in a cell with a canonical fork, which takes about as long as a contoured one.
const MANY: u32 = 4;
/// Largest rank of a cell.
const RANKS: u8 = 100;

/// Cells of the clusters of a network. Cells that many forks are in are chosen, and each fork has the nearest chosen one:
/// a fine one, else a coarse one.
pub fn shared_cells(count: u32, cluster: impl Fn(u32) -> Cluster + Sync) -> Vec<ForkCells> {
    let mut cells = vec![ForkCells::None; count as usize];
    for level in [ForkCells::Fine, ForkCells::Coarse] {
        let open: Vec<u32> = (0..count).filter(|&i| cells[i as usize] == ForkCells::None).collect();
        let own = |&i: &u32| hash_of(Fork::of(&cluster(i)).and_then(|fork| fork.cell(level(0))));
        let own: Vec<u32> = open.par_iter().map(own).collect();
        let mut chosen: FxHashMap<u32, u32> = FxHashMap::default();
        for hash in own.iter().filter(|hash| **hash != 0) {
            *chosen.entry(*hash).or_default() += 1;
        }
        chosen.retain(|_, count| *count >= MANY);
        let nearest = |(&i, own): (&u32, &u32)| {
            if chosen.contains_key(own) {
                return level(0);
            }
            let fork = if *own == 0 || chosen.is_empty() { None } else { Fork::of(&cluster(i)) };
            let is_chosen = |fork: &Fork, cells: ForkCells| chosen.contains_key(&hash_of(fork.cell(cells)));
            fork.and_then(|fork| (1..=RANKS).map(level).find(|&cells| is_chosen(&fork, cells))).unwrap_or_default()
        };
        let nearest: Vec<ForkCells> = open.par_iter().zip(&own).map(nearest).collect();
        for (i, cell) in open.into_iter().zip(nearest) {
            cells[i as usize] = cell;
        }
    }
    cells
}

fn hash_of(cell: Option<Cell>) -> u32 {
    cell.map_or(0, |cell| FxBuildHasher.hash_one(cell) as u32 | 1)
}

/// Number of the template of a fork; 0 for other clusters.
pub fn template_of(cluster: &Cluster) -> u32 {
    if cluster.cells == ForkCells::None {
        return 0;
    }
    hash_of(Fork::of(cluster).and_then(|fork| fork.cell(cluster.cells)))
}

/// Meshes a fork by template. Returns `None` for other clusters, and if no template fits.
pub(super) fn fork(cluster: &Cluster, params: &BlockParams) -> Option<FilledFork> {
    let usual =
        params.ends == EndStyle::Shared && params.by_template() && params.layers.is_none() && params.rho <= FINEST;
    if !usual || cluster.cells == ForkCells::None || !cluster.fine.is_empty() {
        return None;
    }
    let fork = Fork::of(cluster)?;
    // A tip inside another vessel has no cap.
    if buried(cluster).next().is_some() {
        return None;
    }
    let canonical = cache::canonical(fork.cell(cluster.cells)?, params)?;
    image::image(&canonical, &fork, cluster, params)
}
