//! Refinement of the skeleton before meshing (section 3.1 of the paper).

mod bend;
mod buried;
mod contact;
mod crowd;
mod cut_length;
mod figures;
mod forces;
mod frame;
mod history;
mod leash;
mod overlapping;
mod params;
mod push;
mod residual;
mod settle;
mod shape;
mod solve;
mod split;
#[cfg(test)]
mod tests;
mod text;
mod tighten;

pub use buried::BuriedTip;
pub use crowd::CrowdedPair;
pub use figures::{Figures, Metric};
pub use history::{Displacement, HistorySample};
pub use leash::FarNode;
pub use params::{Crowded, Freedom, RefineError, RefineParams, Residual};
pub use residual::{ResidualPair, ResidualReport, Treatment};

pub use split::{SplitNode, SplitReport, split, split_in_place, split_shared};

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::Progress;
use anastomesh_skeleton::Skeleton;
use leash::Leashes;
use serde::{Deserialize, Serialize};

/// Refined skeleton.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Refined {
    /// Skeleton; nodes keep their `original`.
    pub skeleton: Skeleton,
    /// Position of each node after splitting and before moving. For a bend, the point on the straight vessel.
    pub origin: Vec<Point3>,
    /// Report of the refinement.
    #[serde(with = "as_text")]
    pub report: RefineReport,
}

/// Serializes a report as JSON bytes in any format. Formats without field names cannot read its flattened parts.
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

/// Report of a refinement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RefineReport {
    /// Nodes and edges before.
    pub size_before: [usize; 2],
    /// Nodes and edges after.
    pub size_after: [usize; 2],
    /// Split nodes, which had more than three vessels.
    pub nodes_split: usize,
    /// Bends added to stuck vessels.
    pub bends: usize,
    /// Iteration with the best state, which is the result. `None` if every state was worse than the input in a
    /// protected metric; the result is then the input.
    pub chosen: Option<usize>,
    /// True if the iterations ended early, because too many vessels are close to each other.
    #[serde(default)]
    pub gave_up: bool,
    /// The paper's unit of length, in the unit of the skeleton: the median radius is 0.448 of it.
    pub unit: f64,
    /// Figures of the input.
    pub given: Figures,
    /// Figures after splitting.
    pub split: Figures,
    /// Figures at the end of the iterations, before the residual treatment.
    pub moved: Figures,
    /// Figures of the result.
    pub result: Figures,
    /// Displacement of the nodes.
    pub displacement: Displacement,
    /// Displacement of the nodes, in their radii.
    pub displacement_radii: Displacement,
    /// Nodes of a measured network displaced by more than their radius to resolve an overlap.
    pub demanded: Vec<FarNode>,
    /// Terminals that are too close for two caps.
    pub crowded: Vec<CrowdedPair>,
    /// Terminals of a measured network inside another vessel of their bifurcation.
    #[serde(default)]
    pub buried: Vec<BuriedTip>,
    /// Remaining overlaps and their treatment.
    pub residual: ResidualReport,
    /// Metrics in which the result is worse than the input.
    pub worse: Vec<Metric>,
    /// Metrics over the iterations.
    pub history: Vec<HistorySample>,
}

/// Refines a skeleton (section 3.1 of the paper). Nodes of more than three vessels are split, then the paper's three
/// forces act. Projection then pushes vessels apart, lengthens and opens them until none overlap and all can be cut.
/// Overlaps that remain after the last iteration are treated according to `params.residual`.
///
/// The result depends only on the arguments, and not on the unit of length. Memory is linear in the number of edges.
///
/// ```
/// use anastomesh_network::{GenerateParams, Organ, RefineParams, generate, refine};
///
/// let network = generate(&GenerateParams::new(Organ::Ellipsoid, 20))?;
/// let refined = refine(&network, &RefineParams::default(), &())?;
/// assert_eq!(refined.report.result.overlaps, 0);
/// assert_eq!(refined.origin.len(), refined.skeleton.nodes.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A parameter is out of range, or the skeleton does not satisfy `Skeleton::check`.
pub fn refine(given: &Skeleton, params: &RefineParams, progress: &dyn Progress) -> Result<Refined, RefineError> {
    params.check()?;
    given.check()?;
    let leashes = Leashes::of(params.freedom, given);
    let params = &if leashes.is_some() { unlike_grown(params) } else { params.clone() };
    let measured = leashes.is_some();
    let given_figures = Figures::of(given, measured);
    let (mut start, splits) = if leashes.is_some() { split_in_place(given) } else { split(given) };
    let mut origin: Vec<Point3> = start.nodes.iter().map(|n| n.position).collect();
    let crowded = crowd::treat(&mut start, &mut origin, params, leashes.is_none());
    // Other networks have wider bifurcations in the end.
    let buried = if leashes.is_some() { buried::treat(&mut start, params) } else { Vec::new() };
    let split_figures = Figures::of(&start, measured);
    let moved = solve::solve(start, &given_figures, params, leashes, progress)?;
    let chosen = moved.best.as_ref().map(|best| best.iteration);
    let bends = moved.best.as_ref().map_or(0, |best| best.bends);
    let (mut skeleton, mut origin) = match moved.best {
        // Nodes added by bends follow the others.
        Some(best) => (best.skeleton, [&origin[..], &best.origin[origin.len()..]].concat()),
        None => (given.clone(), given.nodes.iter().map(|n| n.position).collect()),
    };
    let at_rest = Figures::of(&skeleton, measured);
    let displacement = Displacement::of(&skeleton, &origin);
    let displacement_radii = Displacement::in_radii(&skeleton, &origin);
    let demanded = leashes.map_or_else(Vec::new, |leashes| leashes.demanded(&skeleton, &origin));
    let (residual, result) = treat_residual(&mut skeleton, &mut origin, [&at_rest, &given_figures], measured, params);
    let report = RefineReport {
        size_before: [given.nodes.len(), given.edges.len()],
        size_after: [skeleton.nodes.len(), skeleton.edges.len()],
        nodes_split: splits.nodes.len(),
        bends,
        chosen,
        gave_up: moved.gave_up,
        unit: moved.unit,
        given: given_figures,
        split: split_figures,
        moved: at_rest,
        result,
        displacement,
        displacement_radii,
        demanded,
        crowded,
        buried,
        residual,
        worse: result.worse_than(&given_figures, &Metric::ALL),
        history: moved.history,
    };
    Ok(Refined { skeleton, origin, report })
}

impl RefineParams {
    /// True if the refinement lengthens vessels of this network so that they can be cut. Otherwise only overlapping vessels
    /// move.
    ///
    /// ```
    /// use anastomesh_network::{Freedom, GenerateParams, Organ, RefineParams, generate};
    ///
    /// let network = generate(&GenerateParams::new(Organ::Ellipsoid, 20))?;
    /// assert!(!RefineParams::default().freedom(Freedom::Measured).lengthens(&network));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn lengthens(&self, network: &Skeleton) -> bool {
        Leashes::of(self.freedom, network).is_none()
    }
}

/// Removes `FarPairs` from the protected metrics: consecutive polyline pieces count as far pairs.
fn unlike_grown(params: &RefineParams) -> RefineParams {
    let mut params = params.clone();
    params.hold.retain(|&metric| metric != Metric::FarPairs);
    params
}

/// Treats remaining overlaps of a state with the first figures. Reverts if shrinking made a protected metric worse than in the input.
fn treat_residual(
    skeleton: &mut Skeleton,
    origin: &mut Vec<Point3>,
    [at_rest, given]: [&Figures; 2],
    measured: bool,
    params: &RefineParams,
) -> (ResidualReport, Figures) {
    let before = (skeleton.clone(), origin.clone());
    let report = residual::treat(skeleton, origin, measured, params);
    if report.shrunk_edges == 0 {
        return (report, *at_rest);
    }
    let after = Figures::of(skeleton, measured);
    if after.worse_than(given, &params.hold).is_empty() {
        return (report, after);
    }
    (*skeleton, *origin) = before;
    let listed = RefineParams { residual: Residual::Report, ..params.clone() };
    (residual::treat(skeleton, origin, measured, &listed), *at_rest)
}
