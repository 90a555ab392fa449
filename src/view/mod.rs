//! Interactive 3D viewer for meshes and networks, as one self-contained HTML page.
//!
//! Data is packed compactly: positions in 1/65,536 of their chunk and numbers as differences, all compressed. Large
//! walls are simplified block by block; the number of a vessel's sides depends on its size. Vessels thinner than a
//! pixel are drawn as lines. The page consists of `page.html` and the scripts beside it, without libraries.

mod chunk;
mod collapse;
mod faults;
mod network;
mod pack;
mod page;
mod quadric;
mod rings;
mod scale;
mod tets;
mod tube;
mod wall;

pub use faults::FaultGroup;
pub use network::{add_network, add_values};
pub use page::ViewerPage;
pub use scale::Scale;
pub use tets::add_tets;
pub use wall::{Wall, WallOptions};
