//! Surface around tissue with embedded vessels.

use crate::error::DomainError;
use crate::inside::{Closed, passes, tidy};
use crate::organ::{Vessels, box_around, organ, usual_margin};
use crate::plan::{TissuePlan, TissueShape};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Aabb;
use anastomesh_skeleton::{Edge, NodeId, Skeleton};
use anastomesh_tet::parts::Watch;
use rayon::prelude::*;

/// Surface around the tissue.
pub fn surface(network: &Skeleton, tissue: &TissuePlan, watch: &Watch) -> Result<TriMesh, DomainError> {
    let points = network.nodes.iter().map(|node| node.position).collect();
    let nodes = TriMesh { points, triangles: Vec::new() };
    let outer = network.edges.iter().flat_map(|edge| edge.radii).fold(0.0, f64::max);
    match &tissue.shape {
        TissueShape::Box { margin } => {
            let margin = margin.unwrap_or_else(|| usual_margin(&nodes, outer));
            Ok(box_around(&nodes, margin, tissue.size))
        }
        TissueShape::Hull { .. } => {
            let thickness = vec![0.0; nodes.points.len()];
            organ(tissue, &Vessels { surface: &nodes, thickness: &thickness, outer }, watch)
        }
        TissueShape::Organ(surface) => Ok(tidy(surface)),
    }
}

/// Checks that no edge of a network properly crosses an organ's surface. Edges that only touch it pass.
pub fn check_edges(organ: &TriMesh, network: &Skeleton, name: &dyn Fn(u32) -> String) -> Result<(), DomainError> {
    let closed = Closed::new(organ);
    let crossed = |edge: &Edge| {
        let [p, q] = edge.nodes.map(|node| &network.nodes[node.index()].position);
        let near = closed.near(&Aabb::of_points([p, q])).into_iter();
        let first = near.filter(|&t| passes([p, q], closed.corners(t), false)).min()?;
        Some((edge.nodes, closed.corners(first)[0].coords.into()))
    };
    let leaving: Vec<([NodeId; 2], [f64; 3])> = network.edges.par_iter().filter_map(crossed).collect();
    match leaving.first() {
        Some(&(ends, at)) => {
            let ends = ends.map(|node| name(network.nodes[node.index()].original));
            Err(DomainError::EdgesOutside { count: leaving.len(), ends, at })
        }
        None => Ok(()),
    }
}
