//! Legacy VTK files, versions 2 to 5.1, text or binary: poly data or unstructured grids with vessels as lines.

mod array;
mod cursor;
mod error;
mod read;
mod sections;
#[cfg(test)]
mod tests;

pub use error::VtkLegacyError;
pub(super) use read::read;
