//! Spatial graphs of Amira and Avizo in ASCII: vertices, edges, and edge points with their thickness.

mod error;
mod read;
mod sections;

pub use error::AmiraError;
pub(super) use read::read;
