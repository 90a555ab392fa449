//! Networks in files: a folder for each format, and which of them a path asks for.

mod content;
mod error;
mod format;
mod read;
mod swc;
#[cfg(test)]
mod tests;
mod vtp;
mod write;

pub use content::{NetworkArray, NetworkFile, NetworkNote, NetworkOptions, refinement_arrays};
pub use error::NetworkFileError;
pub use format::NetworkFormat;
pub use read::{read_network, read_network_from};
#[cfg(feature = "cli")]
pub use write::{ensure_network_writable, ensure_tree_writable};
pub use write::{write_network, write_tree};
