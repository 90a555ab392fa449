//! Results of flow solvers: velocity and pressure in the cells of a mesh, and flow rates through its faces.
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
#[cfg(test)]
mod tests;
mod vtu;

pub use content::{FlowResult, InnerFlux, Near, OuterFlux};
pub use error::{ResultError, ResultFault};
pub use read::read_result;
