//! Floor 3: the tetrahedralizer. A closed surface or a piecewise linear complex goes in, a tetrahedral mesh that keeps
//! every triangle of it comes out. Knows nothing of vessels.
//!
//! One Delaunay run over the surface's points, interior points and the corners of a box around them; recovery of what
//! the surface has and the complex lacks; carving; improvement; certificate.
//!
//! A box with a wall across it, of which both halves are filled and told apart:
//!
//! ```
//! use anastomesh_mesh::Point3;
//! use anastomesh_tet::{InputKind, Interior, Plc, Region, Tetrahedralizer};
//!
//! let mut plc = Plc::default();
//! for x in [0.0, 1.0, 2.0] {
//!     plc.points.extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(y, z)| Point3::new(x, y, z)));
//! }
//! let mut square = |a: u32, b: u32, c: u32, d: u32, marker: i32| {
//!     plc.triangles.extend([[a, b, c], [a, c, d]]);
//!     plc.markers.extend([marker; 2]);
//! };
//! square(0, 3, 2, 1, 1); // an end
//! square(4, 5, 6, 7, 2); // the wall inside
//! square(8, 9, 10, 11, 3); // the other end
//! for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
//!     square(i, j, j + 4, i + 4, 4);
//!     square(i + 4, j + 4, j + 8, i + 8, 4);
//! }
//! plc.regions.push(Region { seed: Point3::new(1.5, 0.5, 0.5), id: 7, max_volume: None });
//!
//! let out = Tetrahedralizer::new().kind(InputKind::Plc).interior(Interior::None).run(&plc)?;
//! assert_eq!(out.summary.regions, 2);
//! assert_eq!(out.mesh.points[..12], plc.points);
//! assert_eq!((out.faces.len(), out.face_markers[2]), (plc.triangles.len(), 2));
//! let volume_of = |region: i32| -> f64 {
//!     let corners = |t: &[u32; 4]| t.map(|v| out.mesh.points[v as usize]);
//!     let tets = out.mesh.tets.iter().zip(&out.regions).filter(|(_, r)| **r == region);
//!     tets.map(|(t, _)| { let [a, b, c, d] = corners(t); (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0 }).sum()
//! };
//! assert!((volume_of(7) - 1.0).abs() < 1e-12 && (volume_of(1) - 1.0).abs() < 1e-12);
//! # Ok::<(), anastomesh_tet::TetError>(())
//! ```

mod builder;
mod carve;
pub(crate) mod certify;
pub(crate) mod complex;
mod conform;
mod contacts;
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
mod plc;
mod progress;
mod recover;
pub(crate) mod refine;
mod regions;
mod request;
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
pub use error::{InputArray, InputPart, LayersConflict, Obstacle, SeedKind, Stuck, TetError};
pub use layer::{Layers, LayersError};
pub use layers::LayerSummary;
pub use optimize::{Effort, OptimizeReport};
pub use options::{Boundary, Interior, Refinement, Sizing};
pub use plc::{InputKind, LeftOut, Plc, PlcRef, Region};
pub use recover::RecoverySummary;
pub use refine::RefineReport;

#[cfg(test)]
mod input_tests;
#[cfg(test)]
mod outside_tests;
#[cfg(test)]
mod refined_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod turned_tests;
