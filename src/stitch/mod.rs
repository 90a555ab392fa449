//! Floor 3: block meshes → one mesh. Smoothing of the joints, labels on the boundary.

pub mod joints;
pub mod label;
