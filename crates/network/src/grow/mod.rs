//! Synthetic networks, grown as a vessel tree that reaches all terminals of an organ.
//!
//! Terminals fill the organ evenly (`organ`). The tree grows from the inlet by repeated splitting of the set of
//! terminals (`tree`). The split ratios reproduce the vessel counts per Strahler order of a rat kidney (`split`). Radii
//! follow from those of the terminals by Murray's law. Bifurcations then move to minimum volume, subject to minimum
//! vessel lengths, and nodes move out of thick vessels (`relax`). Time is O(n log n), memory O(n).
//!
//! Published and measured morphometry are in `morphometry`.

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
