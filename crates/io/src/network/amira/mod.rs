//! Amira's and Avizo's spatial graphs, as text: vertices, edges, and the points along each edge with their thickness.

mod error;
mod read;
mod sections;

pub use error::AmiraError;
pub(super) use read::read;
