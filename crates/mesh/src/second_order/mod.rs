//! Second-order meshes: a midpoint on each edge, on a smooth surface where the boundary is curved.
//!
//! A second-order mesh consists of a [`VolumeMesh`](crate::VolumeMesh) and a [`SecondOrder`]. Its elements have ten nodes, its
//! boundary faces six: the corners, then the midpoints in the order of [`TET_EDGES`] and [`FACE_EDGES`], which is VTK's order.
//!
//! [`SecondOrder::balanced_points`] moves vertices whose flat faces enclose the right volume to the surface.
//! [`SecondOrder::curved`] places the midpoints of labelled faces on a smooth surface. Edges near the surface follow it, and
//! all others are straight. Each element is then proved to have a positive Jacobian determinant ([`jacobian_above`]), which makes its map invertible.
//! [`check_jacobians`] proves the same for any second-order mesh. Intersections of curved faces that share no vertex are not
//! excluded.

mod arc;
mod balance;
mod check;
mod curve;
mod edges;
mod extend;
mod jacobian;
mod midpoints;
mod read;
mod surface;
#[cfg(test)]
mod tests;

pub use check::{Jacobians, check_jacobians};
pub use curve::Curving;
pub use edges::{FACE_EDGES, TET_EDGES};
pub(crate) use jacobian::volume_of;
pub use jacobian::{Sign, jacobian_above};
pub use midpoints::SecondOrder;
pub use read::{QuadraticMesh, QuadraticParts};
