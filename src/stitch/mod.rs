//! Floor 3: block meshes → one mesh. Merging by identity of vertices, smoothing of the joints, labels on the boundary.

pub mod joints;
pub mod label;
pub mod merge;
