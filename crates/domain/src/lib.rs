//! Regions around a lumen: shells (vessel wall, perivascular space) and tissue, as one conforming mesh. Vessels can also be embedded in tissue
//! as lines.
//!
//! The lumen's wall is the inner side of the first shell, with the same vertices and triangles. The outermost shell is the
//! inner boundary of the tissue.
//!
//! ```
//! use anastomesh_domain::{DomainPlan, ShellPlan, Thickness, TissuePlan, TissueShape};
//!
//! let wall = ShellPlan::new("wall", Thickness::Law { length: 0.0, radii: 0.2 });
//! let tissue = TissuePlan::new(TissueShape::Box { margin: None });
//! let plan = DomainPlan::default().shells(vec![wall]).tissue(tissue);
//! assert_eq!(plan.names(), ["lumen", "wall", "tissue"]);
//! ```
//!
//! | to | use |
//! |---|---|
//! | plan shells and tissue | [`DomainPlan`], [`ShellPlan`], [`TissuePlan`], [`TissueRegion`] |
//! | cut vessels that leave the organ | [`CutNetwork`] |
//! | carry out the plan | [`Domain::around`], [`DomainInParts::around`] |
//! | embed vessels as lines in tissue | [`EmbedPlan`], [`Embedding`], [`Pieces`] |
//!
//! The crate has no features.

mod assemble;
mod before;
mod bisect;
mod build;
mod cut;
mod embed;
mod error;
mod gate;
mod hull;
mod inside;
mod labels;
mod layout;
mod nested;
mod organ;
mod parts;
mod plan;
mod shelf;
mod surface;
mod unfold;
mod without;

pub use build::{Domain, ShellsReport};
pub use cut::{CutNetwork, CutReport, VesselEnds};
pub use embed::{EmbedPlan, Embedding, Piece, PieceFault, Pieces, PiecesError};
pub use error::{DomainError, GateFault};
pub use parts::{DomainInParts, RegionParts};
pub use plan::{DomainPlan, DomainPlanError, ShellPlan, Thickness, TissuePlan, TissueRegion, TissueShape};
pub use shelf::{MemoryShelf, Shelf};

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
