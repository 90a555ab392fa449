//! VTK's legacy files: poly data or an unstructured grid whose lines are vessels, as text or binary, of versions 2 to 5.1.

mod array;
mod cursor;
mod error;
mod read;
mod sections;
#[cfg(test)]
mod tests;

pub use error::VtkLegacyError;
pub(super) use read::read;
