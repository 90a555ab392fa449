//! Layers of thin tetrahedra along a wall, for what is steep there (wall shear, concentrations).
//!
//! Each vertex of the wall has a place further in, so that a second surface of the same triangles stands inside the first
//! (`inset`). That one is filled as any surface, and between the two each triangle of the wall is a prism, cut across into
//! layers and each of these into three tetrahedra (`stack`). All prisms are positive by the exact predicate and what is inside
//! is a mesh of an embedded surface, so the whole is one of the first surface: a map that nowhere turns over and is one to one
//! on the boundary is so inside.
//!
//! How far a place is in depends on what is asked for and on the room there is (`half_width`); where a prism turns over or the second
//! surface meets itself, places draw back towards the wall (`inset`), at last on to it: there is no layer there then.

mod direction;
mod half_width;
mod inset;
mod stack;
#[cfg(test)]
mod tests;
mod whole;

pub use direction::Directions;
pub use inset::{Inset, Places, inset};
pub use stack::{Numbers, rims, toward};
pub use whole::LayerSummary;
pub(super) use whole::layered;
