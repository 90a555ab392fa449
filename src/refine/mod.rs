//! Floor 3: 3.1 of the paper, improvement of the skeleton before it is meshed.

mod bend;
mod contact;
mod crowd;
mod figures;
mod forces;
mod frame;
mod history;
mod leash;
mod params;
mod push;
mod residual;
mod room;
mod shape;
mod solve;
mod split;
#[cfg(test)]
mod tests;
mod text;

pub use crowd::CrowdedPair;
pub use figures::{Figures, Metric};
pub use history::{Displacement, Sample};
pub use leash::FarNode;
pub use params::{Crowded, Freedom, RefineError, RefineParams, Residual};
pub use residual::{ResidualReport, Treatment};

pub use split::{split, split_shared};

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::Progress;
use anastomesh_skeleton::Skeleton;
use leash::Leashes;
use serde::{Deserialize, Serialize};

/// A refined skeleton.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Refined {
    /// The skeleton. Nodes keep their `original`.
    pub skeleton: Skeleton,
    /// Where each node was before it moved: after splitting; for a bend, the place on the straight vessel.
    pub origin: Vec<Point3>,
    /// What was found and done.
    #[serde(with = "as_text")]
    pub report: RefineReport,
}

/// A report as bytes of JSON, whatever the rest is kept as: parts of it are flattened, which formats without names have no way
/// to read.
mod as_text {
    use super::RefineReport;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser};

    pub fn serialize<S: Serializer>(report: &RefineReport, to: S) -> Result<S::Ok, S::Error> {
        serde_json::to_vec(report).map_err(ser::Error::custom)?.serialize(to)
    }

    pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<RefineReport, D::Error> {
        serde_json::from_slice(&Vec::<u8>::deserialize(from)?).map_err(de::Error::custom)
    }
}

/// What a refinement found and did.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    /// The iteration after which the result was best: that state is the one that is kept. None when every state was
    /// worse than the input in a metric that was to be held: then the result is the input.
    pub chosen: Option<usize>,
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
    /// How far the nodes moved, in radii of theirs.
    pub displacement_radii: Displacement,
    /// Nodes of a measured network that moved further than their radius, as an overlap was not parted by less.
    pub demanded: Vec<FarNode>,
    /// Terminals that are too close to each other for two caps.
    pub crowded: Vec<CrowdedPair>,
    /// What was left, and what was done about it.
    pub residual: ResidualReport,
    /// Metrics that are worse in the end than they were given.
    pub worse: Vec<Metric>,
    /// The metrics over the iterations.
    pub history: Vec<Sample>,
}

/// Refines a skeleton (3.1 of the paper): nodes of more than three vessels are split; the paper's three forces act; then
/// vessels are pushed apart, lengthened and opened by projection until none overlap and all can be cut, or the
/// iterations are over; what is left is treated as `params.residual` says.
///
/// The result depends on nothing but the arguments, and not on the unit of length. Memory grows with the number of
/// edges.
///
/// ```
/// use anastomesh::io::{NetworkOptions, read_network};
/// use anastomesh::network::{RefineParams, clean, refine};
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let (network, _) = clean(&file.skeleton)?;
/// let refined = refine(&network, &RefineParams::default(), &())?;
/// assert_eq!(refined.report.result.overlaps, 0);
/// assert_eq!(refined.origin.len(), refined.skeleton.nodes.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a parameter is out of its range, or the skeleton does not satisfy `Skeleton::check`.
pub fn refine(given: &Skeleton, params: &RefineParams, progress: &dyn Progress) -> Result<Refined, RefineError> {
    params.check()?;
    given.check()?;
    let leashes = Leashes::of(params.freedom, given);
    let params = &if leashes.is_some() { unlike_grown(params) } else { params.clone() };
    let given_figures = Figures::of(given);
    let (mut start, splits) = split(given);
    let mut origin: Vec<Point3> = start.nodes.iter().map(|n| n.position).collect();
    let crowded = crowd::treat(&mut start, &mut origin, params, leashes.is_none());
    let split_figures = Figures::of(&start);
    let moved = solve::solve(start, &given_figures, params, leashes, progress)?;
    let chosen = moved.best.as_ref().map(|best| best.iteration);
    let bends = moved.best.as_ref().map_or(0, |best| best.bends);
    let (mut skeleton, mut origin) = match moved.best {
        // Nodes that came with bends follow the others.
        Some(best) => (best.skeleton, [&origin[..], &best.origin[origin.len()..]].concat()),
        None => (given.clone(), given.nodes.iter().map(|n| n.position).collect()),
    };
    let at_rest = Figures::of(&skeleton);
    let displacement = Displacement::of(&skeleton, &origin);
    let displacement_radii = Displacement::in_radii(&skeleton, &origin);
    let demanded = leashes.map_or_else(Vec::new, |leashes| leashes.demanded(&skeleton, &origin));
    let (residual, result) = treat_residual(&mut skeleton, &mut origin, &at_rest, &given_figures, params);
    let report = RefineReport {
        size_before: [given.nodes.len(), given.edges.len()],
        size_after: [skeleton.nodes.len(), skeleton.edges.len()],
        nodes_split: splits.nodes.len(),
        bends,
        chosen,
        unit: moved.unit,
        given: given_figures,
        split: split_figures,
        moved: at_rest,
        result,
        displacement,
        displacement_radii,
        demanded,
        crowded,
        residual,
        worse: result.worse_than(&given_figures, &Metric::ALL),
        history: moved.history,
    };
    Ok(Refined { skeleton, origin, report })
}

/// In polylines pieces that follow each other count as far pairs: nothing that is to be held.
fn unlike_grown(params: &RefineParams) -> RefineParams {
    let mut params = params.clone();
    params.hold.retain(|&metric| metric != Metric::FarPairs);
    params
}

/// Treats what is left; undone when shrinking made it worse than the input in what is to be held.
fn treat_residual(
    skeleton: &mut Skeleton,
    origin: &mut Vec<Point3>,
    at_rest: &Figures,
    given: &Figures,
    params: &RefineParams,
) -> (ResidualReport, Figures) {
    let before = (skeleton.clone(), origin.clone());
    let report = residual::treat(skeleton, origin, params);
    if report.shrunk_edges == 0 {
        return (report, *at_rest);
    }
    let after = Figures::of(skeleton);
    if after.worse_than(given, &params.hold).is_empty() {
        return (report, after);
    }
    (*skeleton, *origin) = before;
    let listed = RefineParams { residual: Residual::Report, ..params.clone() };
    (residual::treat(skeleton, origin, &listed), *at_rest)
}
