//! Boundary layers: thin tetrahedra along a wall for steep gradients (wall shear, concentrations).
//!
//! Each vertex of the wall has an inner position, so that an inner surface of the same triangles lies inside the first
//! (`inset`). The inner surface is filled as usual. Between the two, each triangle of the wall spans a prism, which is
//! cut into layers of three tetrahedra each (`stack`). All prisms are positive by the exact predicate, and the inner
//! mesh fills an embedded surface. So the whole fills the outer surface: a map without inversions that is one to one on
//! the boundary is one to one inside.
//!
//! In a complex, each region is a closed surface of its own (`regions`, `local`), and is filled with layers or without
//! (`region`). All keep the triangles given, so that the regions fit together (`whole`). Triangles, segments and points inside
//! a region stay inside its layers (`constraints`).
//!
//! The offset depends on the thickness asked for and on the clearance (`room`). If a prism is inverted or the inner
//! surface intersects itself, positions move back towards the wall (`inset`). At offset zero there is no layer.

mod caps;
#[cfg(test)]
mod complex_tests;
mod constraints;
mod direction;
mod half_width;
mod inset;
mod local;
mod region;
mod regions;
mod slide;
mod stack;
#[cfg(test)]
mod tests;
mod whole;

pub use direction::{Directions, is_open, openness};
pub use half_width::clear_widths;
pub use inset::{Inset, Places, Ways, inset, lower};
pub use stack::{Numbers, rims, toward};
pub use whole::LayerSummary;
pub(super) use whole::{LayerSides, Layered, layered};
