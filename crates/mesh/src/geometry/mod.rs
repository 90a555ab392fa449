//! Geometry: points, tubes and cross-sections; predicates, intersections, distances and search trees.

mod aabb;
mod angle;
mod bvh;
mod convex;
mod disjoint_sets;
mod distance;
mod dyadic;
#[cfg(test)]
mod exact_oracle;
mod fans;
pub mod hilbert;
pub mod implicit;
mod integer;
mod normal;
mod place;
pub mod predicates;
mod ray;
mod star;
mod total;
mod tri_tri;
mod tube;

pub use aabb::Aabb;
pub use angle::turn;
pub use bvh::Bvh;
pub use convex::minimise_convex;
pub use disjoint_sets::DisjointSets;
pub use distance::{SegmentPair, TubePair, point_segment, point_triangle, point_tube, segment_segment, tube_tube};
pub(crate) use fans::Fans;
pub use normal::unit_normal;
pub use place::place_key;
pub use ray::crossing;
pub(crate) use star::is_star_shaped;
pub use total::Total;
pub(crate) use tri_tri::contacts_with;
pub use tri_tri::{
    Contact, Improper, Triangle, classify, classify_triangles, self_contacts, self_contacts_until, self_intersections,
};
pub use tube::{Section, Tube};

/// Point in space, in the unit of the network.
pub type Point3 = nalgebra::Point3<f64>;

/// Displacement or direction.
pub type Vec3 = nalgebra::Vector3<f64>;
