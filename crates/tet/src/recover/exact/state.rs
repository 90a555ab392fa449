//! State of an exact recovery between strategies.

use super::level::level_out;
use super::one::ExactSummary;
use super::parts::{Missing, Part};
use super::push::Push;
use crate::error::TetError;
use crate::input::SurfaceEdges;
use crate::progress::Watch;

/// A complex and the edges and triangles of the surface that it lacks.
#[derive(Clone)]
pub(super) struct State<'a> {
    pub push: Push<'a>,
    pub edges: Vec<[u32; 2]>,
    pub triangles: Vec<u32>,
    /// Steiner points made by exact recovery.
    pub made: usize,
}

impl<'a> State<'a> {
    /// State that lacks the given parts.
    pub(super) fn of<'p>(push: Push<'a>, missing: impl Iterator<Item = &'p Part>, summary: ExactSummary) -> Self {
        let (mut edges, mut triangles) = (Vec::new(), Vec::new());
        for part in missing {
            edges.extend(&part.edges);
            triangles.extend(&part.triangles);
        }
        Self { push, edges, triangles, made: summary.steiner_points }
    }

    /// Recovers edges in facet planes. Returns `None` if more than `share` of the edges would remain missing.
    pub(super) fn leveled(&self, edges: &SurfaceEdges, share: f64, watch: &Watch) -> Result<Option<Self>, TetError> {
        let mut push = self.push.clone();
        let missing = Missing { edges: &self.edges, triangles: &self.triangles };
        let left = level_out(&mut push, edges, missing, share, watch)?;
        Ok(left.map(|(edges, triangles)| Self { push, edges, triangles, made: self.made }))
    }
}
