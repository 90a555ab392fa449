//! Cluster with trimmed ends (section 3.2.2 of the paper).

use super::trim::{TrimOptions, Trimmed, trim};
use crate::block::{BlockError, BlockParams, ClusterMesh, CutEnd, EndStyle, cut_ends, mesh_cluster_watched};
use crate::partition::{Cluster, ClusterId};
use anastomesh_mesh::adjacency::tet_adjacency;
use anastomesh_tet::parts::Watch;

/// Meshes a cluster with its vessels extended beyond the cuts, and trims it at the cuts.
///
/// # Errors
/// Meshing fails, or an end cannot be flattened.
pub fn mesh_trimmed(
    id: ClusterId,
    cluster: &Cluster,
    params: &BlockParams,
    watch: &Watch,
) -> Result<ClusterMesh, BlockError> {
    let params = BlockParams { ends: EndStyle::Open, ..*params };
    let mut out = mesh_cluster_watched(id, cluster, &params, watch)?;
    let (index, ends): (Vec<u32>, Vec<CutEnd>) = cut_ends(cluster).into_iter().unzip();
    if ends.is_empty() {
        return Ok(out);
    }
    let neighbours = tet_adjacency(&out.mesh.tets, out.mesh.points.len()).neighbors;
    let mut frozen: Vec<u32> = out.caps.iter().flat_map(|c| c.triangles.iter().flatten().copied()).collect();
    frozen.sort_unstable();
    frozen.dedup();
    let options = TrimOptions { edge: out.edge, relax: params.relax_ends, depth: params.depth };
    let Trimmed { mesh, renumbered, ends: surfaces } = trim(&out.mesh, &neighbours, &ends, &frozen, &options)
        .map_err(|(i, failure)| BlockError::at_end(id, index[i], &ends[i], failure))?;
    for cap in &mut out.caps {
        for v in cap.triangles.iter_mut().flatten() {
            *v = renumbered[*v as usize];
        }
    }
    out.mesh = mesh;
    out.ends = surfaces;
    Ok(out)
}
