//! Forks by template: a bifurcation of three straight vessels, up to cuts or terminals, is the image of a canonical fork.
//!
//! Shapes are divided into cells of angles, radii and lengths. A canonical fork ([`canonical`]) is contoured and filled once
//! per cell. The map to a fork of the cell ([`image`]) moves its points with the three vessels. Those of the wall then move onto
//! the level set of the fork's own field. Discs at cuts are taken over bit for bit. A canonical fork depends on its cell
//! alone, so the result does not depend on the order of forks. If an image has poor tetrahedra that improvement does not mend, the
//! fork is contoured.
//!
//! A canonical fork takes the time of several contoured ones. So only cells that several forks of the network share have one
//! ([`shared_cells`]). Forks of other cells are looked for in larger cells.

mod cache;
mod canonical;
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
/// Minimum number of forks of a cell. A canonical fork takes 2 to 3 times as long as a contoured one.
const MANY: u32 = 4;

/// Cells of the clusters of a network: fine ones where they have many forks, else coarse ones.
pub fn shared_cells(clusters: impl IndexedParallelIterator<Item = Cluster>) -> Vec<ForkCells> {
    let of_forks: Vec<[u32; 2]> = clusters.map(|cluster| hashes(&cluster)).collect();
    let mut cells = vec![ForkCells::None; of_forks.len()];
    for (i, level) in [ForkCells::Fine, ForkCells::Coarse].into_iter().enumerate() {
        let open = |(hashes, cell): (&[u32; 2], &ForkCells)| (*cell == ForkCells::None).then_some(hashes[i]);
        let mut counts: FxHashMap<u32, u32> = FxHashMap::default();
        for hash in of_forks.iter().zip(&cells).filter_map(open).filter(|hash| *hash != 0) {
            *counts.entry(hash).or_default() += 1;
        }
        for (hashes, cell) in of_forks.iter().zip(&mut cells) {
            let is_shared = counts.get(&hashes[i]).is_some_and(|&count| count >= MANY);
            if *cell == ForkCells::None && is_shared {
                *cell = level;
            }
        }
    }
    cells
}

/// Hashes of the fine and the coarse cell of a fork; 0 for none.
fn hashes(cluster: &Cluster) -> [u32; 2] {
    let fork = Fork::of(cluster);
    [ForkCells::Fine, ForkCells::Coarse].map(|cells| hash_of(fork.as_ref().and_then(|fork| fork.cell(cells))))
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
