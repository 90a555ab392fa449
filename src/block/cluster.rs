//! Meshing of a cluster: by template if it is a tube or a fork of straight vessels, else by contouring.

use super::contoured::{ClusterMesh, ClusterWall, caps, check_shared, contoured, disc_ends, filled, smallest_radius};
use super::error::BlockError;
use super::faithful::Astray;
use super::fork::fork;
use super::lone_tube::lone_tube;
use super::params::BlockParams;
use super::topology::Topology;
use crate::partition::{Cluster, ClusterId, EndKind};
use crate::surface::CappedSurface;
use anastomesh_mesh::quality::tet_ratio;
use anastomesh_mesh::{TetMesh, TriMesh};
use anastomesh_tet::parts::Watch;
use std::sync::Arc;

/// Minimum radius ratio of tetrahedra with layers in the wall of a template, relative to the median. Such forks are
/// contoured otherwise.
const FAIR: f64 = 0.25;

/// Meshes one cluster.
///
/// # Errors
/// Any stage may fail; the error contains the cluster id. The caller may retry with other [`BlockParams`].
pub fn mesh_cluster(id: ClusterId, cluster: &Cluster, params: &BlockParams) -> Result<ClusterMesh, BlockError> {
    mesh_cluster_watched(id, cluster, params, &Watch::NOBODY)
}

/// Meshes one cluster like [`mesh_cluster`], with cancellation and a budget.
///
/// # Errors
/// See [`mesh_cluster`].
pub(crate) fn mesh_cluster_watched(
    id: ClusterId,
    cluster: &Cluster,
    params: &BlockParams,
    watch: &Watch,
) -> Result<ClusterMesh, BlockError> {
    params.check()?;
    if params.layers.is_some()
        && let Some(wall) = wall_of_fork(cluster, params)
        && let Some(made) = filled(id, cluster, wall, params, watch).ok().filter(has_fair_layers)
    {
        return Ok(made);
    }
    let image = if let Some(tube) = lone_tube(cluster, params) {
        let triangles = tube.ends[0].len() + tube.ends[1].len() + tube.wall.len();
        let (discs, topology) = (tube.ends.to_vec(), Arc::clone(&tube.topology));
        let (mesh, hull) = tube.kept(params.hollow);
        Image { mesh, hull, discs, triangles, topology }
    } else if let Some(fork) = fork(cluster, params) {
        let triangles = fork.discs.iter().map(Vec::len).sum::<usize>() + fork.wall.len();
        let topology = Arc::clone(&fork.topology);
        let (mesh, hull, discs) = fork.kept(params.hollow);
        Image { mesh, hull, discs, triangles, topology }
    } else {
        return contoured(id, cluster, params, watch);
    };
    image.finished(id, cluster, params)
}

/// True if no tetrahedron is far flatter than most, as where the sides of layers nearly meet.
fn has_fair_layers(made: &ClusterMesh) -> bool {
    let TetMesh { points, tets } = &made.mesh;
    let mut ratios: Vec<f64> = tets.iter().map(|t| tet_ratio(&t.map(|v| points[v as usize]))).collect();
    let middle = ratios.len() / 2;
    let least = ratios.iter().copied().fold(1.0, f64::min);
    !ratios.is_empty() && least >= FAIR * *ratios.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Wall of a fork by template, within which layers are made. It is the same as without layers.
fn wall_of_fork(cluster: &Cluster, params: &BlockParams) -> Option<ClusterWall> {
    let (mesh, triangles, discs) = fork(cluster, &BlockParams { layers: None, ..*params })?.kept(true);
    let caps = (0..).zip(&discs).flat_map(|(end, disc)| vec![Some(end); disc.len()]);
    let cap: Vec<Option<u32>> = caps.chain(std::iter::repeat(None)).take(triangles.len()).collect();
    let surface = CappedSurface { mesh: TriMesh { points: mesh.points, triangles }, cap };
    Some(ClusterWall { surface, voxel: voxel(cluster, params), astray: Astray::default(), closed_gaps: Vec::new() })
}

/// Cell size of a contouring grid.
fn voxel(cluster: &Cluster, params: &BlockParams) -> f64 {
    2.0 * smallest_radius(cluster) / params.rho
}

/// Image of a template.
struct Image {
    mesh: TetMesh,
    /// Closed surface if hollow, else empty.
    hull: Vec<[u32; 3]>,
    /// Triangles of each end.
    discs: Vec<Vec<[u32; 3]>>,
    /// Number of triangles of the boundary.
    triangles: usize,
    /// Topology of the tetrahedra, with a disc for each end.
    topology: Arc<Topology>,
}

impl Image {
    fn finished(self, id: ClusterId, cluster: &Cluster, params: &BlockParams) -> Result<ClusterMesh, BlockError> {
        let Self { mesh, hull, discs, triangles, topology } = self;
        let voxel = voxel(cluster, params);
        let caps = caps(cluster, &discs);
        let mut out = ClusterMesh { mesh, hull, caps, voxel, surface_triangles: triangles, ..ClusterMesh::default() };
        out.ends = disc_ends(id, cluster, |end| discs[end as usize].clone(), &out.mesh)?;
        check_shared(id, cluster, &out, params)?;
        // Discs of cuts come first.
        let is_cap = |end: &usize| matches!(cluster.ends[*end].kind, EndKind::Terminal(_));
        let (caps, cuts): (Vec<usize>, Vec<usize>) = (0..cluster.ends.len()).partition(is_cap);
        out.topology = (!params.hollow).then(|| topology.ordered(&[cuts, caps].concat()));
        Ok(out)
    }
}
