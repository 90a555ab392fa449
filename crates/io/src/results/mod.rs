//! Results of flow solvers: velocity and pressure in the cells of a mesh, and flow rates through its faces. Edge lengths
//! that were estimated from them.
//!
//! ```
//! use anastomesh_io::results::{ResultError, read_result};
//!
//! let missing = read_result("no_such_case.foam".as_ref());
//! assert!(matches!(missing, Err(ResultError::File(_))));
//! ```

mod content;
mod error;
mod openfoam;
mod read;
mod sizes;
#[cfg(test)]
mod tests;
mod vtu;

pub use content::{FlowResult, InnerFlux, Near, OuterFlux};
pub use error::{ResultError, ResultFault};
pub use read::read_result;
pub use sizes::read_lengths;
