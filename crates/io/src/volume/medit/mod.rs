//! Medit's text format `.mesh`: keyworded lists of vertices, triangles and tetrahedra, each item with a reference.

mod error;
mod names;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::MeditFault;
pub(super) use read::read;
pub(super) use write::write;
