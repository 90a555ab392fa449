//! Floor 3: a measured network made one graph of one line per vessel.
//!
//! What users hold is not what a mesh needs: the same vessel drawn several times (one line from the inlet to each
//! outlet), radii of zero, points a hundredth of a radius apart, tips that segmentation left, branch points beside each
//! other in one lumen. Each has a cure here, with a switch of its own and a list of all that it changed. None moves an
//! axis that stays by more than its bound.

mod directed;
mod islands;
mod lumen;
mod merge;
mod radii;
mod report;
mod resample;
mod short_tips;
mod smooth;
mod spurs;
mod text;
mod touching;

pub use directed::directed;
pub use islands::Island;
pub use lumen::JoinedReport;
pub use merge::MergeReport;
pub use radii::{Fault, FilledRadius};
pub use report::{PrepareReport, Size};
pub use resample::ResampleReport;
pub use short_tips::ShortTip;
pub use spurs::{Spur, SpurReason};
pub use text::touching_text;
pub use touching::{TouchedBy, Touching, TouchingTip, take_back};

use anastomesh_skeleton::{LineGroup, Skeleton, SkeletonError, clean};

/// Which cures are applied, and their bounds. Lengths are in radii of the vessel concerned.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct PrepareParams {
    /// Apply no cure but that of the radii to a network that was grown: of which the vessels have no points of their own
    /// between branch points.
    pub only_measured: bool,
    /// Fill radii that are zero, missing or absurd from their neighbours.
    pub radii: bool,
    /// Merge lines that run together.
    pub merge: bool,
    /// Take spurs off.
    pub spurs: bool,
    /// Join branch points within one lumen and close loops within their own.
    pub join: bool,
    /// Put tips out whose cap would lie in another vessel of their branch point.
    pub short_tips: bool,
    /// What is done about tips that end in or on another vessel.
    pub touching: Touching,
    /// Drop components of fewer nodes than this (0: none).
    pub drop_islands: usize,
    /// Resample polylines.
    pub resample: bool,
    /// Even out the noise of polylines that are resampled, by half of the two bounds that follow. Not by default: a lumen
    /// around an axis that steps from voxel to voxel loses 2 % of its volume with the steps.
    pub smooth: bool,
    /// How far a resampled axis may be from the given one, in radii.
    pub axis_tolerance: f64,
    /// How much a resampled radius may differ from the given one, as a share of it.
    pub radius_tolerance: f64,
}

impl Default for PrepareParams {
    fn default() -> Self {
        let touching = Touching::Retract;
        Self {
            radii: true,
            merge: true,
            spurs: true,
            join: true,
            short_tips: true,
            touching,
            resample: true,
            ..Self::as_is()
        }
    }
}

impl PrepareParams {
    /// No cure at all: the network is only cleaned, as every verb does.
    pub fn as_is() -> Self {
        Self {
            only_measured: false,
            radii: false,
            merge: false,
            spurs: false,
            join: false,
            short_tips: false,
            touching: Touching::Keep,
            drop_islands: 0,
            resample: false,
            smooth: false,
            axis_tolerance: 0.05,
            radius_tolerance: 0.02,
        }
    }
}

/// A prepared network and what was done to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// The network; satisfies `Skeleton::check`. `Node::original` are nodes of the input.
    pub skeleton: Skeleton,
    /// The network as it was read, cleaned and with usable radii: what a mesh is held against.
    pub given: Skeleton,
    /// The same with as many points as its shape needs, to find its lumen by.
    pub outline: Skeleton,
    /// What was done.
    pub report: PrepareReport,
}

/// Makes a network as it was read fit for refinement and meshing.
///
/// `groups` says for each node which vessel its line is drawn for, as [`NetworkFile::groups`](crate::io::NetworkFile::groups)
/// does; empty if the file does not say. Lines of one vessel are merged only where they run together.
///
/// The order is that in which one cure needs another: radii first, for they say what lies in what; then lines become
/// one graph, of which spurs, branch points and islands are judged; at last the lines are resampled, so that all before
/// saw the axis as it was given.
///
/// # Errors
/// When a number cannot be used (with `radii`, only positions and networks without any usable radius), an edge names a
/// node that does not exist, or no vessel remains.
pub fn prepare(
    raw: &Skeleton,
    groups: &[Option<LineGroup>],
    params: &PrepareParams,
) -> Result<Prepared, SkeletonError> {
    let mut report = PrepareReport { given: Size::of(raw), ..PrepareReport::default() };
    // Large networks ask for the room of what is done with.
    let (mut skeleton, cleaned) = if params.radii {
        let (filled, radii) = radii::fill(raw)?;
        report.radii = radii;
        clean(&filled)?
    } else {
        clean(raw)?
    };
    report.cleaned = cleaned;
    report.read = Size::of(&skeleton);
    report.measured = skeleton.is_measured();
    let given = skeleton.clone();
    let defaults = PrepareParams::default();
    let outline = if report.measured {
        resample::resample(&given, defaults.axis_tolerance, defaults.radius_tolerance, false)?.0
    } else {
        given.clone()
    };
    let grown = params.only_measured && !report.measured;
    let params = &if grown {
        PrepareParams { drop_islands: params.drop_islands, ..PrepareParams::as_is() }
    } else {
        params.clone()
    };
    if params.merge {
        (skeleton, report.merge) = merge::merge(&skeleton, groups)?;
    }
    if params.spurs {
        (skeleton, report.spurs) = spurs::take_off(&skeleton)?;
    }
    if params.join {
        (skeleton, report.joined) = lumen::join(&skeleton)?;
    }
    if params.short_tips {
        (skeleton, report.short_tips) = short_tips::treat(&skeleton)?;
    }
    (skeleton, report.touching) = touching::treat(&skeleton, params.touching)?;
    if params.drop_islands > 0 {
        (skeleton, report.islands) = islands::drop(&skeleton, params.drop_islands)?;
    }
    if params.resample {
        (skeleton, report.resample) =
            resample::resample(&skeleton, params.axis_tolerance, params.radius_tolerance, params.smooth)?;
    }
    report.result = Size::of(&skeleton);
    Ok(Prepared { skeleton, given, outline, report })
}
