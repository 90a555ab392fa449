//! Input of `svZeroDSolver`: vessels, junctions and boundary conditions in JSON.
//!
//! Files of this program also contain positions and radii, which the solver ignores, so that they can be read as networks.

mod read;
mod write;

pub use read::SvZeroDError;
pub(super) use read::{is_model, read};
pub(super) use write::{check, write};
