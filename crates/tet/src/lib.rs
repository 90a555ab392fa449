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
mod certify_hull;
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

pub use anastomesh_mesh::repair::{Repaired, repair};
pub use builder::{Tetrahedralization, Tetrahedralizer};
pub use certify::{CertifyError, certify};
pub use error::TetError;
pub use layer::{Layers, LayersError};
pub use layers::LayerSummary;
pub use optimize::Effort;
use options::TetOptions;
pub use options::{Boundary, Interior, Refinement, Sizing};
pub use plc::{InputKind, Plc, Region};
use progress::Watch;

/// Parts of the tetrahedralizer that the vascular mesher assembles itself. Not covered by semantic versioning.
#[doc(hidden)]
pub mod parts {
    pub use crate::complex::Complex;
    pub use crate::delaunay::delaunay;
    pub use crate::error::Stuck;
    pub use crate::layers::{Directions, Inset, Numbers, Places, inset, rims, toward};
    pub use crate::names::Names;
    pub use crate::optimize::{OptimizeOptions, optimize};
    pub use crate::options::TetOptions;
    pub use crate::plc::LeftOut;
    pub use crate::progress::Watch;
    pub use crate::{tetrahedralize, tetrahedralize_watched};
}

use anastomesh_mesh::{TetMesh, TriMesh};
use certify::Place;

/// Fills a closed surface, oriented outwards, with tetrahedra. The points of the mesh begin with the surface's, in
/// their order and bit for bit; interior points follow. Every triangle of the surface is a boundary face with the same
/// orientation, and there are no others: the result is certified ([`certify::certify`], unless the options say otherwise)
/// or an error.
///
/// # Errors
/// [`TetError`]: what is wrong with the surface, or what could not be recovered.
pub fn tetrahedralize(surface: &TriMesh, options: &TetOptions) -> Result<TetMesh, TetError> {
    tetrahedralize_watched(surface, options, &Watch::NOBODY)
}

/// As [`tetrahedralize`], watched.
///
/// # Errors
/// [`TetError`]; [`TetError::Cancelled`] when the watch says so.
pub fn tetrahedralize_watched(surface: &TriMesh, options: &TetOptions, watch: &Watch) -> Result<TetMesh, TetError> {
    let edges = input::validate(surface, &[], InputKind::Closed)?;
    input::outward(surface)?;
    let filled = fill::fill(&request::Request {
        surface,
        edges: &edges,
        segments: &[],
        kind: InputKind::Closed,
        holes: &[],
        regions: &[],
        interior: &options.interior,
        refinement: None,
        sizing: &Sizing::Surface,
        optimize: options.optimize,
        certify: options.certify,
        effort: options.effort,
        strict: true,
        label: false,
        watch,
    })?;
    match filled.places.iter().position(|&p| p != Place::Boundary) {
        Some(triangle) => Err(TetError::NotSeparating { triangle: triangle as u32 }),
        None => Ok(filled.mesh),
    }
}

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

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
