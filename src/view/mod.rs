//! Floor 5: a mesh or a network as a page that turns it before one's eyes, in one file that needs nothing else.
//!
//! What is shown is packed small: places in steps of a 65,536th of their chunk, numbers as differences, all of it compressed.
//! A wall of very many faces is made coarser block by block, each vessel to as many sides as its size calls for, and where a
//! vessel is thinner than a pixel the page draws a line. The page itself is `page.html` and the scripts beside it, by hand,
//! without a library.

mod chunk;
mod collapse;
mod faults;
mod network;
mod pack;
mod page;
mod quadric;
mod rings;
mod tets;
mod tube;
mod wall;

pub use faults::Fault;
pub use network::add_network;
pub use page::ViewerPage;
pub use tets::add_tets;
pub use wall::{Wall, WallOptions};
