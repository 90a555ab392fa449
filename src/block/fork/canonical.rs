//! Canonical fork of a cell: contoured and filled as other clusters are, then optimized.

use super::crotch::{Crotches, crotches};
use super::shape::{Fork, Limb, TIP, middle};
use crate::block::contoured::{ClusterMesh, contoured};
use crate::block::hull::Triangles;
use crate::block::params::{BlockParams, EndStyle};
use crate::block::topology::Topology;
use crate::partition::{ClusterId, ForkCell, PartitionParams};
use crate::surface::Field;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::adjacency::{face_vertices, tet_adjacency};
use anastomesh_mesh::geometry::Point3;
use anastomesh_tet::parts::{OptimizeOptions, Watch, optimize};
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Factors of the lengths of a canonical fork, tried in turn. In the middle of some cells, a cut is in the wall of another vessel.
const STRETCHES: [f64; 5] = [1.0, 1.1, 1.2, 1.35, 1.5];

/// Filled fork in the middle of a cell.
pub struct Canonical {
    pub fork: Fork,
    /// Points, in radii of the node.
    pub points: Vec<Point3>,
    pub tets: Vec<[u16; 4]>,
    /// Number of leading points up to the last one on the boundary.
    pub boundary_points: usize,
    /// Triangles of the disc of each limb, facing outwards.
    pub discs: Vec<Triangles>,
    /// Triangles of the wall, facing outwards.
    pub wall: Triangles,
    /// Vertices of the wall, but for those on discs at cuts.
    pub levels: Vec<Level>,
    pub crotches: Crotches,
    /// Topology of the tetrahedra, with the discs.
    pub topology: Arc<Topology>,
}

/// Vertex of the wall and its level in the field.
pub struct Level {
    pub vertex: u32,
    pub value: f64,
    /// Limb of the cap whose rim contains the vertex.
    pub rim: Option<usize>,
}

impl Canonical {
    /// Makes the canonical fork of a cell; `None` if that fails.
    pub fn of(cell: &ForkCell, params: &BlockParams) -> Option<Self> {
        STRETCHES.iter().find_map(|&stretch| Self::stretched(cell, stretch, params))
    }

    fn stretched(cell: &ForkCell, stretch: f64, params: &BlockParams) -> Option<Self> {
        let partition = PartitionParams::default();
        let overrun = partition.overrun.max(2.0 * partition.overrun_voxels / params.rho);
        let cluster = middle(cell, overrun, stretch);
        let fork = Fork::of(&cluster).filter(|fork| (0..).zip(&fork.limbs).all(|(i, limb)| limb.end == i))?;
        let params = BlockParams { ends: EndStyle::Shared, core: params.core, ..BlockParams::with_rho(params.rho) };
        let made = contoured(ClusterId(0), &cluster, &params, &Watch::NOBODY).ok()?;
        let discs = discs(&fork, &made)?;
        let mut mesh = made.mesh;
        // Points of the boundary come first, and keep their order.
        let boundary_points = boundary_points(&mesh)?;
        optimize(&mut mesh, &OptimizeOptions { fixed_points: boundary_points, ..OptimizeOptions::full() }).ok()?;
        if mesh.points.len() > usize::from(u16::MAX) {
            return None;
        }
        let topology = Topology::of(&mesh, discs.iter().map(Vec::as_slice)).ok()?;
        let wall: Triangles = topology.wall.iter().map(|&face| face_vertices(&mesh.tets, face)).collect();
        let limb_of: FxHashMap<u32, usize> =
            (0..).zip(&topology.discs).flat_map(|(i, disc)| disc.vertices.iter().map(move |&v| (v, i))).collect();
        let mut free: Vec<u32> = wall.as_flattened().to_vec();
        free.sort_unstable();
        free.dedup();
        let mut field = Field::new(&cluster.tubes, params.kappa).ok()?;
        let crotches = crotches(&fork, &mut field);
        let mut level =
            |v: u32| Level { vertex: v, value: field.value(&mesh.points[v as usize]), rim: limb_of.get(&v).copied() };
        let levels =
            free.into_iter().map(&mut level).filter(|level| level.rim.is_none_or(|i| fork.limbs[i].side == TIP));
        let levels = levels.collect();
        let tets = mesh.tets.iter().map(|t| t.map(|v| v as u16)).collect();
        Some(Self {
            fork,
            points: mesh.points,
            tets,
            boundary_points,
            discs,
            wall,
            levels,
            crotches,
            topology: Arc::new(topology),
        })
    }
}

/// Triangles of the ends of the limbs; `None` if a cap is missing.
fn discs(fork: &Fork, made: &ClusterMesh) -> Option<Vec<Triangles>> {
    let (mut cuts, mut caps) = (made.ends.iter(), made.caps.iter());
    let mut disc =
        |limb: &Limb| Some(if limb.side == TIP { &caps.next()?.triangles } else { &cuts.next()?.triangles }.clone());
    fork.limbs.iter().map(&mut disc).collect()
}

/// Number of leading points up to the last one on the boundary.
fn boundary_points(mesh: &TetMesh) -> Option<usize> {
    let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
    adjacency.boundary().flat_map(|face| face_vertices(&mesh.tets, face)).max().map(|v| v as usize + 1)
}
