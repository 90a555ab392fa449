//! Blood flow in vascular networks: boundary conditions for their meshes, zero- and one-dimensional models, and results
//! of solvers along vessels.
//!
//! ```
//! use anastomesh_flow::{FlowPlan, Inflow, InletSite, VesselFlow};
//! use anastomesh_network::{GenerateParams, Organ, generate};
//! use anastomesh_skeleton::NodeId;
//!
//! let tree = generate(&GenerateParams::new(Organ::Ellipsoid, 20))?;
//! let inlet = InletSite::new(NodeId(0), tree.node(NodeId(0)).radius);
//! let plan = FlowPlan::default().inflow(Inflow::Rate(1e-9));
//! let solved = plan.solve(&tree, &[inlet], &|node| node.to_string())?;
//! let vessels = VesselFlow::of(&tree, &solved.flow, plan.viscosity);
//! assert_eq!(vessels.shear.len(), tree.edges.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | choose inlets | [`Inlets`], [`TerminalPatches`] |
//! | describe and solve a flow | [`FlowPlan`], [`OutletPlan`] |
//! | list inlets and outlets of a mesh, and group outlets | [`Caps`] |
//! | make a zero- or one-dimensional model | [`reduced_model`] |
//! | map results of a solver onto vessels | [`Along`] |
//! | store data of vessels in the cells of a mesh | [`VesselData`] |
//!
//! The crate has no features.

mod along;
mod caps;
mod data;
mod error;
mod inlets;
mod model;
mod outlets;
mod plan;
mod terminals;
mod vessels;

pub use along::{Along, BranchFlow, Misfit, ResultFluid};
pub use caps::{CapRow, Caps, CapsError, Outlets};
pub use data::{Datum, VesselData};
pub use error::FlowError;
pub use inlets::{Inlet, InletReason, Inlets, NoTerminal};
pub use model::{Closed, ModelOptions, Supply, reduced_model};
pub use outlets::{OutletKind, OutletPlan, OutletSplit, Reference};
pub use plan::{FlowPlan, FlowSolution, Inflow, InletSite};
pub use terminals::{NotATerminal, TerminalPatches};
pub use vessels::{VesselFlow, VesselRow};

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
