//! Mesh size control: a size field on an octree, interior points on a graded body-centred lattice, and Delaunay
//! refinement inside a frozen boundary.

mod goals;
mod insert;
mod points;
mod sizes;
mod tree;

pub use goals::Goals;
pub use insert::{RefineReport, refine_complex};
pub use points::graded_points;
pub use sizes::{SizeLimit, vertex_sizes};
pub use tree::{SizeTree, TreeOptions};

#[cfg(test)]
mod tests;
