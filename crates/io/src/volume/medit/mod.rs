//! Medit text format `.mesh`: lists of vertices, triangles and tetrahedra, each with references.

mod error;
mod names;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::MeditFault;
pub(super) use read::read;
pub(super) use write::write;
