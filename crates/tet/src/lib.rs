//! Tetrahedral meshes of closed triangle surfaces and piecewise linear complexes that keep every triangle of the input.
//!
#![doc = include_str!("../docs/tets.html")]
//!
//! ```
//! use anastomesh_tet::{Point3, Tetrahedralizer, TriMesh};
//!
//! let points = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Point3::from).to_vec();
//! let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let surface = TriMesh { points, triangles };
//! let made = Tetrahedralizer::new().run(&surface)?;
//! assert_eq!(made.faces, surface.triangles);
//! assert_eq!(made.mesh.points[..4], surface.points);
//! # Ok::<(), anastomesh_tet::TetError>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | fill a surface or a complex | [`Tetrahedralizer::run`] with a [`TriMesh`] or a [`Plc`] |
//! | choose points inside, edge lengths, bounds, layers | [`Interior`], [`Sizing`], [`Refinement`], [`Layers`] |
//! | mark faces, leave holes, tell regions apart | [`Plc::markers`], [`Plc::holes`], [`Region`] |
//! | correct a surface | [`repair`], [`repair_facets`] |
//! | find the first fault of an input | [`Tetrahedralizer::check`] |
//! | tetrahedralize points | [`Tetrahedralizer::delaunay`] |
//! | verify a mesh, and measure it | [`certify`], [`check_tets`], [`TetQuality`] |
//! | follow a run, and stop it | [`Progress`] |
//!
//! A run makes one Delaunay tetrahedralization of the points of the input, of points inside and of the corners of a box. It
//! recovers the segments and triangles that are missing, removes the tetrahedra outside, improves the others, and certifies
//! the result. Types of meshes are those of [`anastomesh_mesh`], with its policy on [`nalgebra`].
//!
//! # Features
//!
//! None.
//!
//! # Regions
//!
//! A box with a wall across it, both halves of which are filled as regions:
//!
//! ```
//! use anastomesh_tet::{InputKind, Interior, Plc, Point3, Region, Tetrahedralizer};
//!
//! let mut plc = Plc::default();
//! for x in [0.0, 1.0, 2.0] {
//!     let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
//!     plc.surface.points.extend(corners.map(|(y, z)| Point3::new(x, y, z)));
//! }
//! let mut square = |a: u32, b: u32, c: u32, d: u32, marker: i32| {
//!     plc.surface.triangles.extend([[a, b, c], [a, c, d]]);
//!     plc.markers.extend([marker; 2]);
//! };
//! square(0, 3, 2, 1, 1); // an end
//! square(4, 5, 6, 7, 2); // the wall inside
//! square(8, 9, 10, 11, 3); // the other end
//! for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
//!     square(i, j, j + 4, i + 4, 4);
//!     square(i + 4, j + 4, j + 8, i + 8, 4);
//! }
//! let plc = plc.regions(vec![Region::new(Point3::new(1.5, 0.5, 0.5), 7)]);
//!
//! let out = Tetrahedralizer::new().kind(InputKind::Plc).interior(Interior::None).run(&plc)?;
//! assert_eq!(out.summary.regions, 2);
//! assert_eq!(out.mesh.points[..12], plc.surface.points);
//! assert_eq!((out.faces.len(), out.face_markers[2]), (plc.surface.triangles.len(), 2));
//! let volume_of = |region: i32| -> f64 {
//!     let corners = |t: &[u32; 4]| t.map(|v| out.mesh.points[v as usize]);
//!     let tets = out.mesh.tets.iter().zip(&out.regions).filter(|(_, r)| **r == region);
//!     tets.map(|(t, _)| { let [a, b, c, d] = corners(t); (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0 }).sum()
//! };
//! assert!((volume_of(7) - 1.0).abs() < 1e-12 && (volume_of(1) - 1.0).abs() < 1e-12);
//! # Ok::<(), anastomesh_tet::TetError>(())
//! ```

mod attempts;
mod builder;
mod carve;
pub(crate) mod certify;
mod certify_hull;
pub(crate) mod complex;
mod conform;
mod contacts;
mod corner_tets;
pub(crate) mod delaunay;
pub(crate) mod error;
mod fill;
pub(crate) mod flips;
mod input;
pub(crate) mod lattice;
mod layer;
pub(crate) mod layers;
mod names;
pub(crate) mod optimize;
mod options;
mod outside;
#[doc(hidden)]
pub mod parts;
mod pieces;
mod plc;
mod progress;
mod recover;
pub(crate) mod refine;
mod regions;
mod remesh;
mod request;
mod shells;
mod sized;
mod split;
pub(crate) mod star;
mod survey;

pub use anastomesh_mesh::check::{CheckReport, check_tets};
pub use anastomesh_mesh::progress::{Progress, Stage};
pub use anastomesh_mesh::quality::TetQuality;
pub use anastomesh_mesh::repair::{RepairReport, Repaired, repair, repair_facets};
pub use anastomesh_mesh::{Bound, Bounds, Point3, TetMesh, TriMesh, nalgebra};
pub use builder::{Summary, Tetrahedralization, Tetrahedralizer};
pub use certify::{CertifyError, certify};
pub use complex::ComplexError;
pub use error::{EdgeFaults, InputArray, LayersConflict, Obstacle, SeedKind, Stuck, TetError};
pub use layer::{Layers, LayersError};
pub use layers::LayerSummary;
pub use optimize::{Effort, OptimizeReport};
pub use options::{Boundary, Interior, Refinement, Sizing};
pub use plc::{InputKind, InputPart, LeftOut, Plc, PlcRef, Region};
pub use recover::RecoverySummary;
pub use refine::RefineReport;
pub use remesh::RemeshSummary;
pub use shells::{Ring, Shell, Shells};

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
mod input_tests;
#[cfg(test)]
mod outside_tests;
#[cfg(test)]
mod recorded;
#[cfg(test)]
mod refined_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod turned_tests;
