//! Surface around tissue with embedded vessels.

use crate::error::DomainError;
use crate::inside::{Closed, tidy};
use crate::organ::{Vessels, box_around, organ, usual_margin};
use crate::plan::{TissuePlan, TissueShape};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Aabb, Point3};
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
        let first = near.filter(|&t| crosses([p, q], closed.corners(t))).min()?;
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

/// True if a segment passes from one side of a triangle to the other through its interior.
fn crosses([p, q]: [&Point3; 2], [a, b, c]: [&Point3; 3]) -> bool {
    let (from, to) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    let turns = || [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    let one_turn = |turns: [f64; 3]| turns.iter().all(|&t| t > 0.0) || turns.iter().all(|&t| t < 0.0);
    (from < 0.0 && to > 0.0 || from > 0.0 && to < 0.0) && one_turn(turns())
}
