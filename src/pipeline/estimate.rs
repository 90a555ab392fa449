//! Estimates before meshing: tetrahedra, memory, disk space.

use serde::{Deserialize, Serialize};

use super::plan::{JointStyle, MeshPlan};
use super::schedule::Cost;
use crate::block::{BlockDump, BlockError, BlockInput, BlockParams, template_of};
use crate::partition::{Cluster, ClusterId, Cut, CutId, Layout};
use crate::surface::{MAX_CELLS, SurfaceError, estimated_cells, lengths_outside};
use anastomesh_mesh::geometry::Tube;
use anastomesh_skeleton::{SizeAt, Skeleton};
use rayon::prelude::*;

/// Blocks whose costs are in memory at a time.
const AT_A_TIME: u32 = 1 << 12;

/// Tetrahedra per unit of length over radius at ρ = 1, and the exponent of ρ. Fitted to meshes of the kidney's subtrees at
/// ρ = 3, 4 and 5.
const TETS: f64 = 3.9;
const POWER: f64 = 2.85;

/// Values for tubes by template, fitted to straight tubes at ρ = 3 to 12.
const TETS_OF_TUBE: f64 = 4.4;
const POWER_OF_TUBE: f64 = 2.94;

/// Exponents of the core ratio, at forks and in tubes. Fitted to chains of forks and straight tubes with edges of 1 to 3 at
/// ρ = 3 and 5.
const POWER_OF_CORE: f64 = -0.7;
const POWER_OF_CORE_OF_TUBE: f64 = -0.9;

/// Additional tetrahedra for shorter edges at a fork, as a length of vessel in radii, and the exponent of the edge length.
/// An edge factor f adds `FINE_RADII` · (f^−`POWER_OF_FORK` − 1). Fitted to factors of 1/2 and 1/4 at ρ = 3 and 5.
const FINE_RADII: f64 = 5.0;
const POWER_OF_FORK: f64 = 1.75;

/// Triangles of the wall, likewise; they grow with the square of ρ.
const WALL: f64 = 4.1;

/// Bytes that a block takes per tetrahedron while it is made, and whatever its size.
const BYTES_PER_TET: f64 = 420.0;
const BYTES_PER_BLOCK: f64 = 4e6;

/// Bytes per grid cell that the wall crosses, with the triangles made from it.
const BYTES_PER_CELL: f64 = 300.0;

/// Operations per tetrahedron, and per grid cell that the wall crosses.
const PER_TET: f64 = 60.0;
const PER_CELL: f64 = 80.0;

/// Operations per tetrahedron of regions around the lumen, as measured with kidneys.
const PER_TET_OF_REGIONS: f64 = 236.0;

/// Bytes of a tetrahedron in the store and in a VTU, including its share of points and boundary faces. Connectors are images of
/// templates, which share their connectivity. The last is for a compressed VTU with vertex numbers of 64 bits.
const STORED_PER_TET: f64 = 17.0;
const STORED_PER_TET_OF_TUBE: f64 = 9.0;
const WRITTEN_PER_TET: f64 = 35.0;
const WRITTEN_WIDE_PER_TET: f64 = 23.0;

/// Vertex numbers of a tetrahedron. Those of boundary faces come on top: what is written is rather less than estimated.
const NUMBERS_PER_TET: f64 = 4.0;

/// Expected cost of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Tetrahedra of the whole.
    pub tets: f64,
    /// Tetrahedra of the largest block.
    pub largest_block_tets: f64,
    /// Bytes of memory for the largest block while it is made.
    pub largest_block_bytes: u64,
    /// Bytes of the finished blocks.
    pub stored_bytes: u64,
    /// Bytes of the mesh as a VTU.
    pub written_bytes: u64,
    /// Operations of all blocks, as counted by budgets: about 0.05 µs each.
    pub operations: f64,
    /// Triangles of the lumen's wall.
    #[serde(default)]
    pub wall: f64,
    /// Bytes of memory for regions around the lumen; 0 without any.
    #[serde(default)]
    pub regions_bytes: u64,
}

impl Estimate {
    /// Of all blocks of a network.
    pub(crate) fn of(partition: &Layout, plan: &MeshPlan) -> Self {
        let blocks = (partition.clusters_len() + partition.cuts_len()) as u32;
        let cost = |block| block_cost(partition, block, plan, possible_cost);
        // In order, so that the sum does not depend on threads.
        let some = |first: u32| (first..blocks.min(first + AT_A_TIME)).into_par_iter().map(cost).collect::<Vec<_>>();
        let costs = (0..blocks).step_by(AT_A_TIME as usize).flat_map(some);
        let is_tube = |block: u32| block >= partition.clusters_len() as u32 && plan.joint == JointStyle::Disc;
        let stored = |block| if is_tube(block) { STORED_PER_TET_OF_TUBE } else { STORED_PER_TET };
        Self::sum(costs.zip((0..blocks).map(stored)))
    }

    /// Of a network that is not cut yet; each edge counts as a block.
    pub(crate) fn rough(skeleton: &Skeleton, plan: &MeshPlan) -> Self {
        Self::sum(skeleton.edges.iter().map(|edge| {
            let [a, b] = edge.nodes.map(|n| skeleton.node(n).position);
            let radius = 0.5 * (edge.radii[0] + edge.radii[1]);
            (cost(std::iter::once(((b - a).norm(), radius, radius)), plan), STORED_PER_TET)
        }))
    }

    /// Of one block.
    pub fn of_dump(dump: &BlockDump) -> Self {
        let BlockParams { rho, voxel_factor, follow, .. } = dump.params;
        let plan = MeshPlan { rho: rho / voxel_factor, follow, ..MeshPlan::default() };
        let cost = match &dump.input {
            BlockInput::Cluster { cluster, .. } => cluster_cost(cluster, &plan),
            BlockInput::Connector { cut, .. } | BlockInput::FreeConnector { cut, .. } => connector_cost(cut, &plan),
        };
        Self::sum(std::iter::once((cost, STORED_PER_TET)))
    }

    /// Sum of costs, each with the bytes that a tetrahedron takes in the store.
    fn sum(costs: impl Iterator<Item = (Cost, f64)>) -> Self {
        let (mut all, mut bytes) = (Self::default(), 0.0);
        for (cost, stored) in costs {
            bytes += stored * cost.tets;
            all.tets += cost.tets;
            all.operations += cost.operations;
            all.wall += cost.wall;
            all.largest_block_tets = all.largest_block_tets.max(cost.tets);
            all.largest_block_bytes = all.largest_block_bytes.max(cost.bytes);
        }
        all.stored_bytes = bytes as u64;
        all.written_bytes = written(all.tets);
        all
    }

    /// With further tetrahedra in regions around the lumen, some of which are stored, and `memory` bytes to make them.
    #[must_use]
    pub fn with_regions(self, tets: f64, stored: f64, memory: u64) -> Self {
        Self {
            tets: self.tets + tets,
            stored_bytes: self.stored_bytes + (stored * STORED_PER_TET) as u64,
            written_bytes: written(self.tets + tets),
            operations: self.operations + PER_TET_OF_REGIONS * tets,
            regions_bytes: memory,
            ..self
        }
    }
}

/// Bytes of a VTU.
fn written(tets: f64) -> u64 {
    let is_wide = tets * NUMBERS_PER_TET > f64::from(i32::MAX);
    (tets * if is_wide { WRITTEN_WIDE_PER_TET } else { WRITTEN_PER_TET }) as u64
}

/// A machine that is too small for a run.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TooLarge {
    /// The largest block does not fit into the memory that is allowed.
    #[error(
        "the largest block needs {1} of memory, more than the limit of {2} (about {0:.3e} tetrahedra, the whole mesh \
         about {3:.3e}); raise the memory limit, or give a smaller rho",
        estimate.largest_block_tets, gibibytes(estimate.largest_block_bytes), gibibytes(*memory), estimate.tets
    )]
    Block {
        /// Expected cost of the run.
        estimate: Estimate,
        /// Bytes of memory that are allowed.
        memory: u64,
    },
    /// The whole mesh, which has to be held, does not fit.
    #[error(
        "{why} need the whole mesh in memory: {1}, more than the limit of {2} (about {0:.3e} tetrahedra); give {instead}, or \
         raise the memory limit",
        estimate.tets, gibibytes(*bytes), gibibytes(*memory)
    )]
    Whole {
        /// Expected cost of the run.
        estimate: Estimate,
        /// Format that needs the whole mesh in memory.
        why: &'static str,
        /// Formats that do not.
        instead: &'static str,
        /// Bytes that the whole mesh needs.
        bytes: u64,
        /// Bytes of memory that are allowed.
        memory: u64,
    },
    /// The regions around the lumen do not fit into the memory that is allowed.
    #[error(
        "the regions around the lumen need about {1} of memory, more than the limit of {2} (about {0:.3e} triangles of the \
         wall); raise the memory limit, or give a smaller rho",
        estimate.wall, gibibytes(estimate.regions_bytes), gibibytes(*memory)
    )]
    Regions {
        /// Expected cost of the run.
        estimate: Estimate,
        /// Bytes of memory that are allowed.
        memory: u64,
    },
    /// The disk is too small.
    #[error(
        "blocks and mesh need {1} on {place}, which has {2} free (about {0:.3e} tetrahedra); free some space, name another \
         folder, or give a smaller rho",
        estimate.tets, gibibytes(*bytes), gibibytes(*free)
    )]
    Disk {
        /// Expected cost of the run.
        estimate: Estimate,
        /// Bytes that are needed there.
        bytes: u64,
        /// Bytes that are free there.
        free: u64,
        /// Name of the disk.
        place: &'static str,
    },
}

/// Bytes for people.
fn gibibytes(bytes: u64) -> String {
    match bytes as f64 / f64::from(1 << 30) {
        small if small < 0.1 => format!("{:.1} MiB", small * 1024.0),
        large if large > 2048.0 => format!("{:.1} TiB", large / 1024.0),
        usual => format!("{usual:.1} GiB"),
    }
}

/// Cost of a cluster. One whose grid does not fit into memory fails before it is made, and costs only what it is without.
fn possible_cost(cluster: &Cluster, plan: &MeshPlan) -> Cost {
    let cost = cluster_cost(cluster, plan);
    let without_grid = Cost { wall: cost.wall, template: cost.template, ..of_tets(cost.tets) };
    if cost.bytes > plan.memory && without_grid.bytes <= plan.memory { without_grid } else { cost }
}

/// Expected tetrahedra and operations of blocks that are contoured, other than images of templates: pieces of tubes, and bifurcations
/// with a cell.
pub fn contoured(partition: &Layout, plan: &MeshPlan) -> [f64; 2] {
    let of = |i: u32| {
        let cluster = partition.cluster(ClusterId(i));
        let is_image = plan.joint == JointStyle::Disc && (!cluster.cells.is_empty() || is_piece(&cluster, plan));
        let Cost { tets, operations, .. } = if is_image { Cost::default() } else { cluster_cost(&cluster, plan) };
        [tets, operations]
    };
    (0..partition.clusters_len() as u32).map(of).fold([0.0; 2], |sum, cost| [sum[0] + cost[0], sum[1] + cost[1]])
}

/// Expected costs of some blocks: clusters by their ids, then connectors.
pub fn costs_of(partition: &Layout, blocks: &[u32], plan: &MeshPlan) -> Vec<Cost> {
    blocks.par_iter().map(|&block| block_cost(partition, block, plan, cluster_cost)).collect()
}

/// Cost of a block. `of_cluster`: that of a cluster.
fn block_cost(
    partition: &Layout,
    block: u32,
    plan: &MeshPlan,
    of_cluster: impl Fn(&Cluster, &MeshPlan) -> Cost,
) -> Cost {
    match block.checked_sub(partition.clusters_len() as u32) {
        None => of_cluster(&partition.cluster(ClusterId(block)), plan),
        Some(cut) => connector_cost(&partition.cut(CutId(cut)), plan),
    }
}

pub fn cluster_cost(cluster: &Cluster, plan: &MeshPlan) -> Cost {
    let plan = &*plan.of_tube(cluster.size);
    if is_piece(cluster, plan) {
        let tubes = cluster.tubes.iter().filter(|t| t.length() > 0.0);
        return tube_cost(tubes.map(|t| (t.length(), 0.5 * (t.ra + t.rb))), plan);
    }
    let thin = thinnest(cluster);
    let lengths = cluster.tubes.iter().zip(lengths_outside(&cluster.tubes));
    let plain = cost(lengths.map(|(t, length)| (length, 0.5 * (t.ra + t.rb), thin)), plan);
    let finer: f64 = cluster.fine.iter().map(|place| libm::pow(place.factor, -POWER_OF_FORK) - 1.0).sum();
    // Adjacent places along a vessel are a radius apart.
    let radii = if matches!(plan.size_at, Some(SizeAt::Field(_))) { 1.0 } else { FINE_RADII };
    let tets = plain.tets + TETS * libm::pow(plan.rho, POWER) * radii * finer;
    let cost = Cost { wall: plain.wall, template: template_of(cluster), ..of_tets(tets) };
    let cells = cells(cluster, thin, plan);
    // An attempt with more cells fails before it makes a grid.
    if cells > MAX_CELLS as f64 {
        return cost;
    }
    let bytes = cost.bytes.max((BYTES_PER_BLOCK + BYTES_PER_CELL * cells) as u64);
    Cost { operations: cost.operations + PER_CELL * cells, bytes, ..cost }
}

/// Failure of a cluster whose wall crosses more grid cells than allowed; `None` if it does not, or needs no grid.
pub fn too_fine(id: ClusterId, cluster: &Cluster, plan: &MeshPlan) -> Option<BlockError> {
    let plan = &*plan.of_tube(cluster.size);
    if is_piece(cluster, plan) {
        return None;
    }
    let cells = cells(cluster, thinnest(cluster), plan);
    let source = SurfaceError::TooLarge { cells, limit: MAX_CELLS };
    (cells > MAX_CELLS as f64).then_some(BlockError::Surface { cluster: id, source })
}

/// True for the end of a vessel, or a piece between two cuts.
fn is_piece(cluster: &Cluster, plan: &MeshPlan) -> bool {
    cluster.ends.len() == 2 && plan.joint == JointStyle::Disc && cluster.fine.is_empty()
}

fn thinnest(cluster: &Cluster) -> f64 {
    cluster.tubes.iter().map(Tube::min_radius).fold(f64::INFINITY, f64::min)
}

/// Number of grid cells that the wall of a cluster with this thinnest radius crosses.
fn cells(cluster: &Cluster, thin: f64, plan: &MeshPlan) -> f64 {
    estimated_cells(&cluster.tubes, 2.0 * thin / plan.rho, plan.follow)
}

/// Cost of an attempt at a cluster with other parameters than the plan's.
pub fn attempt_cost(cluster: &Cluster, plan: &MeshPlan, params: &BlockParams) -> Cost {
    let BlockParams { rho, voxel_factor, follow, stretch, core, layers, .. } = *params;
    let joint = plan.joint;
    cluster_cost(
        cluster,
        &MeshPlan { rho: rho / voxel_factor, follow, stretch, core, layers, joint, ..MeshPlan::default() },
    )
}

pub fn connector_cost(cut: &Cut, plan: &MeshPlan) -> Cost {
    let plan = &*plan.of_tube(cut.size);
    let pieces = cut.path.windows(2).map(|pair| {
        let radius = 0.5 * (pair[0].radius + pair[1].radius);
        ((pair[1].origin - pair[0].origin).norm(), radius)
    });
    if plan.joint == JointStyle::Disc {
        return tube_cost(pieces, plan);
    }
    cost(pieces.map(|(length, radius)| (length, radius, radius)), plan)
}

/// Of pieces of tubes by template: length, radius.
fn tube_cost(pieces: impl Iterator<Item = (f64, f64)>, plan: &MeshPlan) -> Cost {
    let radii: f64 = pieces.map(|(length, radius)| length / radius).sum();
    let layers = of_layers(radii, plan) / plan.stretch;
    let per_radius = TETS_OF_TUBE * libm::pow(plan.rho, POWER_OF_TUBE) * libm::pow(plan.core, POWER_OF_CORE_OF_TUBE);
    Cost { wall: wall(radii, plan) / plan.stretch, ..of_tets(per_radius * radii / plan.stretch + layers) }
}

/// Of pieces of vessel: length, radius, thinnest radius of their block.
fn cost(pieces: impl Iterator<Item = (f64, f64, f64)>, plan: &MeshPlan) -> Cost {
    // Without following the radius, a wide vessel has the short edges of the thinnest one.
    let finer = 3.0 * (1.0 - plan.follow);
    let one = |(length, radius, thin): (f64, f64, f64)| length / radius * libm::pow(radius / thin, finer);
    let radii = pieces.map(one).sum::<f64>();
    let per_radius = TETS * libm::pow(plan.rho, POWER) * libm::pow(plan.core, POWER_OF_CORE);
    Cost { wall: wall(radii, plan), ..of_tets(per_radius * radii + of_layers(radii, plan)) }
}

/// Number of layer tetrahedra along a length in radii.
fn of_layers(radii: f64, plan: &MeshPlan) -> f64 {
    let layers = plan.layers.map_or(0, |layers| layers.count);
    3.0 * f64::from(layers) * wall(radii, plan)
}

/// Number of triangles of the wall along a length in radii.
fn wall(radii: f64, plan: &MeshPlan) -> f64 {
    WALL * plan.rho * plan.rho * radii
}

fn of_tets(tets: f64) -> Cost {
    // Casts of what is too large, or no number, end at the largest integer.
    let bytes = (BYTES_PER_BLOCK + BYTES_PER_TET * tets) as u64;
    Cost { tets, bytes, operations: PER_TET * tets, ..Cost::default() }
}
