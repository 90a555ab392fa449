//! Triangle and tetrahedral meshes: exact predicates, self-intersections, quality, repair, and a validity check.
//!
//! ```
//! use anastomesh_mesh::{Point3, TetMesh, check::check_tets, quality::TetQuality};
//!
//! let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
//! let mesh = TetMesh { points, tets: vec![[0, 1, 2, 3]] };
//! assert!(check_tets(&mesh, None).failed().next().is_none());
//! assert!(TetQuality::of(&mesh).mean > 0.7);
//! ```
//!
//! | module | contents |
//! |---|---|
//! | [`check`] | validity of a mesh, in one piece or in parts |
//! | [`quality`], [`dihedral`] | radius ratios and dihedral angles |
//! | [`repair`], [`facets`] | surfaces corrected; polygons with holes cut into triangles |
//! | [`source`], [`boundary`] | meshes and boundaries that are read a part at a time |
//! | [`adjacency`], [`faces`], [`stacks`], [`relabel`], [`beside`], [`region`] | neighbours, faces, prisms of layers, labels, values beside a mesh, regions |
//! | [`second_order`] | midpoints of edges on curved surfaces, Jacobian determinants |
//! | [`smooth`], [`shapes`] | smoothing; spheres, tubes and other shapes |
//! | [`geometry`], [`bits`] | predicates, intersections, distances, search trees; bits of numbers |
//! | [`progress`], [`units`] | progress and cancellation; numbers for people |
//!
//! The crate has no features.
//!
//! # nalgebra
//!
//! [`Point3`] and [`Vec3`] are types of `nalgebra`, which is re-exported as [`nalgebra`]. A program that uses
//! `anastomesh_mesh::nalgebra` needs no dependency of its own and no matching version. A new major version of `nalgebra` (0.x counts
//! as major) comes only with a new major version of this crate. Before version 1.0 of this crate, a new minor version suffices.

pub mod adjacency;
pub mod beside;
pub mod bits;
pub mod boundary;
mod bounds;
pub mod budget;
pub mod check;
pub mod dihedral;
pub mod faces;
pub mod facets;
pub mod geometry;
mod keep;
mod keys;
mod of_mesh;
pub mod progress;
pub mod quality;
pub mod region;
pub mod relabel;
pub mod repair;
pub mod second_order;
mod setters;
pub mod shapes;
pub mod smooth;
pub mod source;
pub mod stacks;
pub mod units;

pub use bounds::{Bound, Bounds, REGULAR_DIHEDRAL};
pub use keep::Kept;
pub use keys::{face_key, same_turn, tet_key};
pub use region::NamedRegion;

pub use geometry::{Point3, Vec3};
pub use nalgebra;

/// A triangle surface. A closed surface is oriented outwards: seen from outside, vertices run counter-clockwise.
///
/// ```
/// use anastomesh_mesh::{Point3, TriMesh, repair::repair};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let surface = TriMesh { points, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] };
/// assert_eq!(repair(&surface).report.turned_triangles, 0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions.
    pub points: Vec<Point3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// Mean edge length, each edge counted with each of its triangles; 0 without any.
    pub fn mean_edge(&self) -> f64 {
        let mut sum = 0.0;
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| self.points[v as usize]);
            sum += (b - a).norm() + (c - b).norm() + (a - c).norm();
        }
        sum / (3 * self.triangles.len()).max(1) as f64
    }
}

/// A tetrahedral mesh. Tetrahedra `[a, b, c, d]` are positive: `orient3d(a, b, c, d) > 0`, that is
/// `det(b − a, c − a, d − a) > 0`.
///
/// ```
/// use anastomesh_mesh::{Point3, TetMesh, check::check_tets};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let mut mesh = TetMesh { points, tets: vec![[0, 1, 2, 3]] };
/// assert_eq!(check_tets(&mesh, None).failed().count(), 0);
/// mesh.tets[0].swap(0, 1);
/// assert_ne!(check_tets(&mesh, None).failed().count(), 0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetMesh {
    /// Vertex positions.
    pub points: Vec<Point3>,
    /// Vertex indices of each tetrahedron.
    pub tets: Vec<[u32; 4]>,
}

/// The faces of a positive tetrahedron: face `i` lies opposite vertex `i` and, seen from outside, runs
/// counter-clockwise.
pub const TET_FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Tetrahedral mesh with a labelled boundary. The pipeline returns it, and the writers take it.
///
/// ```
/// use anastomesh_mesh::check::{Expectation, check_volume};
/// use anastomesh_mesh::{Patch, Point3, TetMesh, VolumeMesh, WALL};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let volume = VolumeMesh {
///     mesh: TetMesh { points, tets: vec![[0, 1, 2, 3]] },
///     tet_block: vec![0],
///     boundary: vec![[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]],
///     boundary_block: vec![0; 4],
///     boundary_patch: vec![WALL; 4],
///     patches: vec![Patch { id: WALL, name: "wall".into(), cap: None }],
/// };
/// assert!(check_volume(&volume, Some(&Expectation { loops: vec![0], terminals: vec![] })).is_valid());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VolumeMesh {
    /// Points and tetrahedra.
    pub mesh: TetMesh,
    /// Block of each tetrahedron (clusters first, then connectors), or its region ([`NamedRegion`]).
    pub tet_block: Vec<i32>,
    /// Every boundary face exactly once, oriented outwards; in a mesh with regions also every interface face.
    pub boundary: Vec<[u32; 3]>,
    /// Block of the tetrahedron under each boundary face.
    pub boundary_block: Vec<i32>,
    /// Patch of each boundary face: `WALL`, or another patch of `patches`.
    pub boundary_patch: Vec<i32>,
    /// The patches, in ascending order of their id.
    pub patches: Vec<Patch>,
}

/// Patch id of the vessel wall. The first inlet has id 2, the others follow: further inlets, then outlets.
pub const WALL: i32 = 1;

/// A named part of the boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Id, as in `VolumeMesh::boundary_patch`.
    pub id: i32,
    /// `wall`, `inlet`, `inlet_1`, …, `outlet_0`, `outlet_1`, …
    pub name: String,
    /// Cap of the patch; `None` for the wall.
    pub cap: Option<Cap>,
}

impl Patch {
    /// True if the name of the patch begins with `inlet`.
    pub fn is_inlet(&self) -> bool {
        self.id != WALL && self.name.starts_with("inlet")
    }

    /// True if the name of the patch begins with `outlet`.
    pub fn is_outlet(&self) -> bool {
        self.id != WALL && self.name.starts_with("outlet")
    }
}

/// A flat disc that closes a vessel: an inlet or outlet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Index of the terminal node in the network as it was read.
    pub node: u32,
    /// Centre of the disc.
    pub center: Point3,
    /// Unit normal, out of the mesh.
    pub normal: crate::geometry::Vec3,
    /// Radius of the vessel there.
    pub radius: f64,
}

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
