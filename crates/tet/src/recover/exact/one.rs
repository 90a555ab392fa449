//! Exact recovery of one part, up to the removal of its implicit vertices.

use super::facets::cover;
use super::helpers::add_helpers;
use super::parts::Part;
use super::push::Push;
use super::ways::operations;
use crate::delaunay::hash;
use crate::error::{Obstacle, Stuck, TetError};
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;

/// Counts of the exact recovery.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ExactSummary {
    /// Vertices inserted on edges.
    pub on_segments: usize,
    /// Vertices inserted inside triangles.
    pub on_facets: usize,
    /// Steiner points that remain, off the surface.
    pub steiner_points: usize,
}

/// Attributes errors of helpers to the edge that they help.
pub(super) fn about_input(error: TetError, surface: &TriMesh, part: &Part) -> TetError {
    let known = |v: &u32| (*v as usize) < surface.points.len();
    let of_input = |part: &Obstacle| match part {
        Obstacle::Triangle(v) => v.iter().all(known),
        Obstacle::Edge(v) => v.iter().all(known),
        Obstacle::Point(v) => known(v),
    };
    let error = match error {
        TetError::EdgeMeets { edge, obstacle } => {
            TetError::EdgeMeets { edge, obstacle: obstacle.as_given(&surface.triangles) }
        }
        other => other,
    };
    let told = match &error {
        TetError::EdgeMeets { edge, obstacle } => edge.iter().all(known) && of_input(obstacle),
        TetError::Stuck { part, .. } => of_input(part),
        _ => true,
    };
    let dangling = part.edges.first().filter(|_| !told);
    dangling.map_or(error, |&edge| TetError::Stuck { part: Obstacle::Edge(edge), reason: Stuck::Dangling })
}

/// Recovers one part: its edges, then its triangles, then pushes the inserted vertices off them.
///
/// # Errors
/// Errors of the exact recovery; `push` must be discarded then.
pub(super) fn recover_part(
    push: &mut Push,
    part: &Part,
    salt: u64,
    summary: &mut ExactSummary,
    budget: usize,
    watch: &Watch,
) -> Result<(), TetError> {
    let spend = |push: &Push, on: Obstacle| {
        let vertices = push.s.implicit_vertices();
        watch.spend(operations(&push.s))?;
        let over = vertices > budget;
        if over { Err(TetError::Stuck { part: on, reason: Stuck::Budget }) } else { Ok(()) }
    };
    let helpers = add_helpers(push, part, salt);
    // Random order halves fans of long thin triangles recursively. In sequence, each chain would have to fit between
    // the one before and the tetrahedra beyond.
    let mut edges = part.edges.clone();
    edges.sort_by_key(|&[a, b]| (hash(salt ^ (u64::from(a) << 32 | u64::from(b))), a, b));
    for &ends in &edges {
        spend(push, Obstacle::Edge(ends))?;
        let id = push.segments.cut(&mut push.s, ends, watch)?;
        summary.on_segments += push.add_segment(id);
    }
    let beside = push.segments.list.len() as u32;
    for &ends in &helpers.edges {
        spend(push, Obstacle::Edge(ends))?;
        push.segments.cut(&mut push.s, ends, watch)?;
    }
    #[cfg(test)]
    push.s.check();
    for &t in &part.triangles {
        spend(push, Obstacle::Triangle(push.triangles[t as usize]))?;
        let cover = cover(&mut push.s, &push.segments, push.triangles[t as usize], watch)?;
        summary.on_facets += push.add_facet(t, cover);
    }
    let mut inner = Vec::new();
    for &t in &helpers.triangles {
        let cover = cover(&mut push.s, &push.segments, push.triangles[t as usize], watch)?;
        inner.extend(push.add_helper(t, cover));
    }
    #[cfg(test)]
    push.s.check();
    push.settle(watch)?;
    if !helpers.triangles.is_empty() {
        push.drop_helpers(&helpers.triangles, beside..push.segments.list.len() as u32, inner);
        push.settle(watch)?;
    }
    summary.steiner_points += push.finish();
    let lost = part.triangles.iter().map(|&t| push.triangles[t as usize]).find(|&t| push.s.find_face(t).is_none());
    lost.map_or(Ok(()), |t| Err(TetError::Stuck { part: Obstacle::Triangle(t), reason: Stuck::Precision }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Point3;

    #[test]
    fn errors_of_helpers_name_the_edge_that_they_help() {
        let surface = TriMesh { points: vec![Point3::origin(); 5], triangles: vec![[2, 0, 1]] };
        let part = Part { edges: vec![[3, 4], [0, 4]], triangles: Vec::new() };
        let about = |error: &TetError, part: &Part| about_input(error.clone(), &surface, part);
        let stuck = |part, reason| TetError::Stuck { part, reason };
        let dangling = stuck(Obstacle::Edge([3, 4]), Stuck::Dangling);
        let meets = |edge, obstacle| TetError::EdgeMeets { edge, obstacle };
        let of_input = [
            stuck(Obstacle::Edge([0, 4]), Stuck::Precision),
            stuck(Obstacle::Triangle([0, 1, 4]), Stuck::Precision),
            stuck(Obstacle::Point(4), Stuck::Budget),
            meets([0, 1], Obstacle::Point(2)),
            TetError::Cancelled,
        ];
        for error in of_input {
            assert_eq!(about(&error, &part), error);
        }
        let of_helpers = [
            stuck(Obstacle::Edge([0, 5]), Stuck::Precision),
            stuck(Obstacle::Triangle([0, 1, 5]), Stuck::Precision),
            stuck(Obstacle::Point(5), Stuck::Budget),
            meets([0, 5], Obstacle::Point(2)),
            meets([0, 1], Obstacle::Edge([2, 5])),
        ];
        for error in of_helpers {
            assert_eq!(about(&error, &part), dangling);
            assert_eq!(about(&error, &Part::default()), error);
        }
        // Triangles are named as in the input.
        let met = about(&meets([3, 4], Obstacle::Triangle([0, 1, 2])), &part);
        assert_eq!(met, meets([3, 4], Obstacle::Triangle([2, 0, 1])));
    }
}
