//! Floor 3: networks that are made, not measured. Grown ones: an organ filled with terminals, and a tree of vessels that
//! reaches them all.
//!
//! Terminals fill the organ evenly (`organ`). The tree is grown from the inlet by splitting the set of terminals again and
//! again (`tree`); how many go to either side is such that each Strahler order has as many vessels as in a rat's kidney
//! (`split`). Radii follow from those of the terminals by Murray's law. Then every fork is moved to where its three vessels
//! have the least volume, as far as they stay long enough to be cut, and nodes move out of thick vessels (`relax`). That
//! takes about n log n steps and memory proportional to n.
//!
//! The published morphometry, and what a network has of it, is in `morphometry`.

mod bed;
mod dual;
mod ends;
mod generate;
mod looped;
mod morphometry;
mod net;
mod organ;
mod params;
mod random;
mod relax;
mod split;
#[cfg(test)]
mod tests;
mod tree;
mod tubes;

pub use bed::BedParams;
pub use dual::{Dual, dual};
pub use generate::generate;
pub use looped::{Looped, looped};
pub use morphometry::{Morphometry, OrderFigures, Published, RAT_KIDNEY};
pub use params::{GenerateError, GenerateParams, Organ};
