//! A report as one page that opens from a mail: text, tables, plots and pictures in a single file, nothing from a network.

mod blocks;
mod html;
mod network;
mod patches;
mod pictures;
mod places;
mod shape;
mod validity;

pub use blocks::{block_sizes, failed_blocks, run};
pub use html::{Mark, Page, Section};
pub use network::{overlaps_left, refinement};
pub use patches::{named_patches, terminals};
pub use pictures::{mesh_pictures, network_picture};
pub use shape::{fidelity, quality};
pub use validity::{headline, summary, validity};
