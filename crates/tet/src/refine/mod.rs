//! Mesh size control: a size field on an octree, interior points on a graded body-centred lattice, and Delaunay
//! refinement inside a frozen boundary.

mod estimate;
mod gaps;
mod goals;
mod grading;
mod insert;
mod points;
mod sizes;
mod spaced;
mod tree;
mod wall;

pub use estimate::{PER_LENGTH, estimate_spaced, estimate_tets, estimate_uniform};
pub use gaps::limit_by_gaps;
pub use goals::{Fault, Goals, RegionGoals};
pub(crate) use goals::{circumcenter, smallest_sphere};
pub use insert::{RefineReport, refine_complex};
pub use points::{graded_points, surrounding_points};
pub use sizes::{SizeLimit, vertex_sizes};
pub use spaced::{spaced_after, spaced_points};
pub use tree::{SizeTree, TreeOptions};
pub use wall::Wall;

#[cfg(test)]
mod tests;
