//! How the paper ends a cluster (3.2.2): tetrahedra beyond a cut plane are taken off, and what that exposes is made flat and
//! even. Only joints that are woven may ask for it; discs are made on the surface before it is filled.

mod flatten;
mod region;
mod relax;
mod trim;
#[cfg(test)]
pub(super) mod trim_tests;

pub use trim::{TrimOptions, Trimmed, trim};
