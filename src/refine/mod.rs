//! Floor 3: 3.1 of the paper, improvement of the skeleton before it is meshed.

mod bend;
mod contact;
mod dual;
mod forces;
mod frame;
mod params;
mod push;
mod residual;
mod room;
mod shape;
mod solve;
mod split;
#[cfg(test)]
mod tests;

pub use dual::{Dual, dual};
pub use params::{RefineError, RefineParams, Residual};
pub use residual::{ResidualPair, ResidualReport, Treatment};
pub use solve::{Displacement, Sample};
pub use split::{SplitNode, SplitReport, split};

use crate::geometry::Point3;
use crate::skeleton::{Metrics, Share, Skeleton};
use serde::Serialize;

/// A refined skeleton.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Refined {
    /// The skeleton. Nodes keep their `original`.
    pub skeleton: Skeleton,
    /// Where each node was before it moved: after splitting; for a bend, the place on the straight vessel.
    pub origin: Vec<Point3>,
    /// What was found and done.
    pub report: RefineReport,
}

/// What a refinement found and did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RefineReport {
    /// Nodes and edges before.
    pub size_before: [usize; 2],
    /// Nodes and edges after.
    pub size_after: [usize; 2],
    /// Nodes that were split, as they had more than three vessels.
    pub nodes_split: usize,
    /// Bends that were put into vessels that were stuck.
    pub bends: usize,
    /// The iteration after which the result was best: that state is the one that is kept.
    pub chosen: usize,
    /// The paper's unit of length, in the unit of the skeleton: the median radius is 0.448 of it.
    pub unit: f64,
    /// As given.
    pub given: Figures,
    /// After splitting, before anything moved.
    pub split: Figures,
    /// When the nodes had come to rest, before what is left was treated.
    pub moved: Figures,
    /// In the end.
    pub result: Figures,
    /// How far the nodes moved.
    pub displacement: Displacement,
    /// What was left, and what was done about it.
    pub residual: ResidualReport,
    /// Metrics that are worse in the end than they were after splitting.
    pub worse: Vec<&'static str>,
    /// The metrics over the iterations.
    pub history: Vec<Sample>,
}

/// Metrics and numbers of overlaps of one state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Figures {
    /// The metrics.
    pub metrics: Metrics,
    /// Overlapping pairs of edges.
    pub overlaps: usize,
    /// Those of them that share a node.
    pub beside: usize,
    /// Pairs of edges that share no node and meet, neighbours along a vessel included.
    pub unconnected: usize,
    /// Those of them that no edge joins.
    pub far: usize,
}

impl Figures {
    /// Of a skeleton.
    pub fn of(skeleton: &Skeleton) -> Self {
        let adjacency = skeleton.adjacency();
        let overlaps = skeleton.overlaps(&adjacency);
        Self {
            metrics: skeleton.metrics(&adjacency, &skeleton.branches(&adjacency)),
            overlaps: overlaps.pairs.len(),
            beside: overlaps.pairs.iter().filter(|o| o.shares_node()).count(),
            unconnected: overlaps.unconnected.len(),
            far: overlaps.far,
        }
    }
}

impl Figures {
    /// The metrics in which this state is worse than another one: larger counts of what is bad, or shares of it that
    /// grew.
    fn worse_than(&self, before: &Self) -> Vec<&'static str> {
        let bad = |f: &Self| {
            let m = f.metrics;
            let missing = |s: Share| (s.of - s.count) as f64 / s.of.max(1) as f64;
            let share = |s: Share| s.count as f64 / s.of.max(1) as f64;
            [
                ("overlapping pairs", f.overlaps as f64),
                ("far pairs", f.far as f64),
                ("shorter than 2 r", share(m.shorter_than_2)),
                ("shorter than 2.5 r", share(m.shorter_than_2_5)),
                ("shorter than 3 r", share(m.shorter_than_3)),
                ("angles under pi/10", share(m.narrow)),
                ("folds", share(m.folds)),
                ("equation 11", missing(m.long_enough)),
                ("equation 12", missing(m.open_enough)),
                ("cuttable branches", missing(m.cuttable)),
            ]
        };
        let pairs = bad(self).into_iter().zip(bad(before));
        pairs.filter(|((_, now), (_, was))| now > was).map(|((name, _), _)| name).collect()
    }
}

/// Who is told about progress.
pub trait Progress {
    /// An iteration is done, of at most `of`; `sample` is there when the metrics were measured.
    fn step(&mut self, iteration: usize, of: usize, sample: Option<&Sample>);
}

impl Progress for () {
    fn step(&mut self, _: usize, _: usize, _: Option<&Sample>) {}
}

/// Refines a skeleton (3.1 of the paper): nodes of more than three vessels are split; the paper's three forces act; then
/// vessels are pushed apart, lengthened and opened by projection until none overlap and all can be cut, or the
/// iterations are over; what is left is treated as `params.residual` says.
///
/// The result depends on nothing but the arguments, and not on the unit of length. Memory grows with the number of
/// edges.
///
/// # Errors
/// When a parameter is out of its range, or the skeleton does not satisfy `Skeleton::check`.
pub fn refine(
    given: &Skeleton,
    params: &RefineParams,
    progress: &mut dyn Progress,
) -> Result<Refined, RefineError> {
    params.check()?;
    given.check()?;
    let (split, splits) = split(given);
    let solve::Moved { mut skeleton, mut origin, history, bends, chosen, unit } = solve::solve(&split, params, progress);
    let moved = Figures::of(&skeleton);
    let displacement = Displacement::of(&skeleton, &origin);
    let residual = residual::treat(&mut skeleton, &mut origin, params);
    let before = Figures::of(&split);
    let result = if residual.shrunk_edges > 0 { Figures::of(&skeleton) } else { moved };
    let report = RefineReport {
        size_before: [given.nodes.len(), given.edges.len()],
        size_after: [skeleton.nodes.len(), skeleton.edges.len()],
        nodes_split: splits.nodes.len(),
        bends,
        chosen,
        unit,
        given: Figures::of(given),
        split: before,
        moved,
        result,
        displacement,
        residual,
        worse: result.worse_than(&before),
        history,
    };
    Ok(Refined { skeleton, origin, report })
}
