//! Forks by template: a bifurcation of three straight vessels, up to cuts or terminals, is the image of a canonical fork.
//!
//! Shapes are divided into cells of angles, radii and lengths. A canonical fork ([`canonical`]) is contoured and filled once
//! per cell. The map to a fork of the cell ([`image`]) moves its points with the three vessels and their crotches
//! ([`crotch`]). Those of the wall then move onto the level set of the fork's own field. Discs at cuts are taken over bit for
//! bit. A canonical fork depends on its cell alone, so the result does not depend on the order of forks. If an image has poor
//! tetrahedra that improvement does not mend, the fork is contoured.
//!
//! Only cells that several forks of the network are in or near have a canonical fork ([`shared_cells`]). Each fork is an image of
//! that of the nearest of these cells. If that fails, of the second nearest.

mod cache;
mod canonical;
mod cells;
mod crotch;
mod image;
mod shape;
#[cfg(test)]
mod tests;

use super::buried::buried;
use super::params::{BlockParams, EndStyle};
use crate::partition::Cluster;
use image::FilledFork;
use rustc_hash::FxBuildHasher;
use shape::Fork;
use std::hash::BuildHasher;

pub use cells::shared_cells;

/// Maximum ρ. Larger canonical forks would take much memory, and more than a second that cannot be cancelled.
const FINEST: f64 = 6.0;
/// Number of the template of a fork; 0 for other clusters.
pub fn template_of(cluster: &Cluster) -> u32 {
    cluster.cells.first().map_or(0, |cell| FxBuildHasher.hash_one(cell) as u32 | 1)
}

/// Meshes a fork by template. Returns `None` for other clusters, and if no template fits.
pub(super) fn fork(cluster: &Cluster, params: &BlockParams) -> Option<FilledFork> {
    let usual =
        params.ends == EndStyle::Shared && params.by_template() && params.layers.is_none() && params.rho <= FINEST;
    if !usual || cluster.cells.is_empty() || !cluster.fine.is_empty() {
        return None;
    }
    let fork = Fork::of(cluster)?;
    // A tip inside another vessel has no cap.
    if buried(cluster).next().is_some() {
        return None;
    }
    cluster.cells.iter().find_map(|cell| image::image(&*cache::canonical(*cell, params)?, &fork, cluster, params))
}
