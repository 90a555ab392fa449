//! Preparation of measured networks: one graph with one line per vessel.
//!
//! Input networks have typical defects: vessels drawn several times, as lines from the inlet to each outlet; zero
//! radii; points 0.01 radii apart. Others are segmentation spurs and adjacent branch points in one
//! lumen. Each defect has a cure with its own switch and a list of its changes. No cure moves a remaining axis beyond
//! its tolerance.

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
pub use lumen::{ClosedLoop, JoinedNodes, JoinedReport};
pub use merge::{MergeReport, Merged, Parting};
pub use radii::{FilledRadius, RadiusDefect};
pub use report::{PrepareReport, Size};
pub use resample::ResampleReport;
pub use short_tips::ShortTip;
pub use spurs::{Spur, SpurReason};
pub use text::touching_text;
pub use touching::{TouchedBy, Touching, TouchingTip, take_back};

use anastomesh_skeleton::{LineGroup, Skeleton, SkeletonError, clean};

/// Selection of cures and their tolerances. Lengths are in radii of the respective vessel.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct PrepareParams {
    /// Apply only the radius cure to grown networks, whose vessels have no points between branch points.
    pub only_measured: bool,
    /// Replace zero, missing or implausible radii by values from neighbours.
    pub radii: bool,
    /// Merge lines that run together.
    pub merge: bool,
    /// Remove spurs.
    pub spurs: bool,
    /// Merge branch points within one lumen and close loops within their own lumen.
    pub join: bool,
    /// Extend tips whose cap would lie in another vessel of their branch point.
    pub short_tips: bool,
    /// Treatment of tips that end in or on another vessel.
    pub touching: Touching,
    /// Leave such tips as they are where a vessel would lose more than about two radii outside other vessels. A refinement
    /// then moves the vessels apart.
    pub lossless: bool,
    /// Remove components with fewer nodes than this (0: none).
    pub drop_islands: usize,
    /// Resample polylines.
    pub resample: bool,
    /// Smooth resampled polylines, by half of the two tolerances below. Off by default: a lumen around an axis with
    /// voxel steps loses 2 % of its volume with them.
    pub smooth: bool,
    /// Maximum distance of a resampled axis from the given one, in radii.
    pub axis_tolerance: f64,
    /// Maximum relative difference of a resampled radius.
    pub radius_tolerance: f64,
}

anastomesh_mesh::setters!(PrepareParams {
    only_measured: bool,
    radii: bool,
    merge: bool,
    spurs: bool,
    join: bool,
    short_tips: bool,
    touching: Touching,
    lossless: bool,
    drop_islands: usize,
    resample: bool,
    smooth: bool,
    axis_tolerance: f64,
    radius_tolerance: f64,
});

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
    /// No cures: the network is only cleaned, as in every command.
    pub fn as_is() -> Self {
        Self {
            only_measured: false,
            radii: false,
            merge: false,
            spurs: false,
            join: false,
            short_tips: false,
            lossless: false,
            touching: Touching::Keep,
            drop_islands: 0,
            resample: false,
            smooth: false,
            axis_tolerance: 0.05,
            radius_tolerance: 0.02,
        }
    }
}

/// Prepared network and report.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// Prepared network; satisfies `Skeleton::check`. `Node::original` refers to nodes of the input.
    pub skeleton: Skeleton,
    /// Input network, cleaned and with usable radii: the reference for the mesh.
    pub given: Skeleton,
    /// Resampled reference network, used to locate the lumen.
    pub outline: Skeleton,
    /// Report of the preparation.
    pub report: PrepareReport,
}

/// Prepares an input network for refinement and meshing.
///
/// Cures run in the order of their dependencies. Radii come first, as they define containment. Merged lines form one
/// graph, on which spurs, branch points and islands are found. Resampling comes last, so that all other cures see the
/// given axis.
///
/// # Errors
/// A number is unusable (with `radii`: a position, or all radii), an edge refers to a missing node, or no vessel
/// remains.
pub fn prepare(
    raw: &Skeleton,
    groups: &[Option<LineGroup>],
    params: &PrepareParams,
) -> Result<Prepared, SkeletonError> {
    let mut report = PrepareReport { given: Size::of(raw), ..PrepareReport::default() };
    // Large networks require an early release of intermediate results.
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
    (skeleton, report.touching) = touching::treat(&skeleton, params.touching, params.lossless)?;
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
