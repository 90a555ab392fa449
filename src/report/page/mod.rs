//! HTML report: text, tables, plots and pictures in one self-contained file.

mod blocks;
mod escape;
mod figures;
mod html;
mod legend;
mod network;
mod patches;
mod pictures;
mod places;
mod shape;
mod validity;

pub use blocks::{block_sizes, failed_blocks, run};
pub use figures::LengthUnit;
pub use html::{Mark, Page, Section};
pub use network::{of_refinement, refinement};
pub use patches::{named_patches, terminals};
pub use pictures::{mesh_pictures, network_picture};
pub use shape::{fidelity, quality};
pub use validity::{advice, headline, summary, validity};
