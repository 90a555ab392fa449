//! Vascular networks before meshing: growth, repair of measured networks, overlap removal, one-dimensional flow.
//!
//! ```
//! use anastomesh_network::{GenerateParams, Organ, RefineParams, generate, refine};
//!
//! let tree = generate(&GenerateParams::new(Organ::Ellipsoid, 20))?;
//! let refined = refine(&tree, &RefineParams::default(), &())?;
//! assert_eq!(refined.report.result.overlaps, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | grow a tree, a second tree beside it, capillaries between both | [`generate`], [`dual`], [`looped`] |
//! | repair a measured network | [`prepare`] |
//! | move overlapping vessels apart (section 3.1 of the paper) | [`refine`] |
//! | compute flow and Strahler orders | [`flow`] |
//!
//! The crate has no features.

pub mod flow;
mod grow;
mod names;
mod prepare;
mod refine;

pub use anastomesh_skeleton::{Skeleton, clean};

pub use grow::{
    BedParams, Dual, GenerateError, GenerateParams, Looped, Morphometry, OrderFigures, Organ, Published, RAT_KIDNEY,
    dual, generate, looped,
};
pub use names::NameOf;
pub use prepare::{
    ClosedLoop, FilledRadius, Island, JoinedNodes, JoinedReport, MergeReport, Merged, Parting, PrepareParams,
    PrepareReport, Prepared, RadiusDefect, ResampleReport, ShortTip, Size, Spur, SpurReason, TouchedBy, Touching,
    TouchingTip, directed, prepare, take_back, touching_text,
};
pub use refine::{
    BuriedTip, Crowded, CrowdedPair, Displacement, FarNode, Figures, Freedom, HistorySample, Metric, RefineError,
    RefineParams, RefineReport, Refined, Residual, ResidualPair, ResidualReport, SplitNode, SplitReport, Treatment,
    refine, split, split_in_place, split_shared,
};

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
