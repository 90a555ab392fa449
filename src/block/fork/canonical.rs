//! Canonical fork of a cell: contoured and filled as other clusters are, then optimized.

use super::shape::{Cell, Fork};
use crate::block::contoured::contoured;
use crate::block::params::{BlockParams, EndStyle};
use crate::block::topology::Topology;
use crate::partition::{ClusterId, PartitionParams};
use crate::surface::Field;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::adjacency::{face_vertices, tet_adjacency};
use anastomesh_mesh::geometry::Point3;
use anastomesh_tet::parts::{OptimizeOptions, Watch, optimize};
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// Filled fork in the middle of a cell.
pub struct Canonical {
    pub fork: Fork,
    /// Points, in radii of the node.
    pub points: Vec<Point3>,
    pub tets: Vec<[u16; 4]>,
    /// Triangles of the disc of each limb, facing outwards.
    pub discs: [Vec<[u32; 3]>; 3],
    /// Triangles of the wall, facing outwards.
    pub wall: Vec<[u32; 3]>,
    /// Vertices of the wall off the discs, with their level in the field.
    pub levels: Vec<(u32, f64)>,
    /// Topology of the tetrahedra, with the discs.
    pub topology: Arc<Topology>,
}

impl Canonical {
    /// Makes the canonical fork of a cell; `None` if that fails.
    pub fn of(cell: &Cell, params: &BlockParams) -> Option<Self> {
        let partition = PartitionParams::default();
        let overrun = partition.overrun.max(2.0 * partition.overrun_voxels / params.rho);
        let cluster = cell.cluster(overrun);
        let fork = Fork::of(&cluster).filter(|fork| (0..).zip(&fork.limbs).all(|(i, limb)| limb.end == i))?;
        let params = BlockParams { ends: EndStyle::Shared, core: params.core, ..BlockParams::with_rho(params.rho) };
        let made = contoured(ClusterId(0), &cluster, &params, &Watch::NOBODY).ok()?;
        let [a, b, c] = <[_; 3]>::try_from(made.ends).ok()?.map(|end| end.triangles);
        let discs = [a, b, c];
        let mut mesh = made.mesh;
        // Points of the boundary come first, and keep their order.
        let fixed_points = boundary_points(&mesh)?;
        optimize(&mut mesh, &OptimizeOptions { fixed_points, ..OptimizeOptions::full() }).ok()?;
        if mesh.points.len() > usize::from(u16::MAX) {
            return None;
        }
        let topology = Topology::of(&mesh, discs.iter().map(Vec::as_slice)).ok()?;
        let wall: Vec<[u32; 3]> = topology.wall.iter().map(|&face| face_vertices(&mesh.tets, face)).collect();
        let fixed: FxHashSet<u32> = topology.discs.iter().flat_map(|disc| disc.vertices.iter().copied()).collect();
        let mut free: Vec<u32> = wall.as_flattened().iter().copied().filter(|v| !fixed.contains(v)).collect();
        free.sort_unstable();
        free.dedup();
        let mut field = Field::new(&cluster.tubes, params.kappa).ok()?;
        let levels = free.into_iter().map(|v| (v, field.value(&mesh.points[v as usize]))).collect();
        let tets = mesh.tets.iter().map(|t| t.map(|v| v as u16)).collect();
        Some(Self { fork, points: mesh.points, tets, discs, wall, levels, topology: Arc::new(topology) })
    }
}

/// Number of leading points up to the last one on the boundary.
fn boundary_points(mesh: &TetMesh) -> Option<usize> {
    let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
    adjacency.boundary().flat_map(|face| face_vertices(&mesh.tets, face)).max().map(|v| v as usize + 1)
}
