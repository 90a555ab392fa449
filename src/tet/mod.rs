//! Floor 3: the tetrahedralizer. A closed surface goes in, a tetrahedral mesh that keeps every triangle of it comes out.
//! Knows nothing of vessels.
//!
//! One Delaunay run over the surface's points, interior points and the corners of a box around them; recovery of what
//! the surface has and the complex lacks; carving; improvement; certificate.

mod carve;
pub mod certify;
pub mod complex;
pub mod delaunay;
pub mod error;
pub mod flips;
mod input;
pub mod lattice;
pub mod optimize;
mod recover;
pub mod star;

pub use complex::Complex;
pub use error::{Obstacle, TetError};
pub use recover::RecoverySummary;

use crate::geometry::Point3;
use crate::mesh::{TetMesh, TriMesh};

/// Side of the lattice's cubes in mean edge lengths of the surface.
const CELL: f64 = 1.5;

/// Distance of the lattice from the wall in mean edge lengths of the surface.
const CLEARANCE: f64 = 0.55;

/// Times that recovery is tried.
const ATTEMPTS: u32 = 8;

/// Which points are put inside the surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Interior {
    /// None but those that recovery needs.
    None,
    /// A body-centred cubic lattice; lengths in the unit of the surface.
    Lattice {
        /// Side of the cubes; none: 1.5 mean edge lengths of the surface.
        cell: Option<f64>,
        /// Distance kept from the wall; none: 0.55 mean edge lengths of the surface.
        clearance: Option<f64>,
    },
    /// These points; those outside the surface are dropped.
    Points(Vec<Point3>),
}

/// How a surface is tetrahedralized.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TetOptions {
    /// Points inside.
    pub interior: Interior,
    /// Whether the mesh is improved, with its boundary as it is.
    pub optimize: bool,
}

impl Default for TetOptions {
    fn default() -> Self {
        Self { interior: Interior::Lattice { cell: None, clearance: None }, optimize: true }
    }
}

impl TetOptions {
    /// With other points inside.
    #[must_use]
    pub fn interior(mut self, interior: Interior) -> Self {
        self.interior = interior;
        self
    }

    /// With or without improvement.
    #[must_use]
    pub fn optimize(mut self, optimize: bool) -> Self {
        self.optimize = optimize;
        self
    }
}

/// A certified mesh and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Tetrahedralization {
    /// The mesh; its points begin with the surface's.
    pub mesh: TetMesh,
    /// What recovery did.
    pub recovery: RecoverySummary,
}

/// Fills a closed surface, oriented outwards, with tetrahedra. The points of the mesh begin with the surface's, in
/// their order and bit for bit; interior points follow. Every triangle of the surface is a boundary face with the same
/// orientation, and there are no others: the result is certified ([`certify::certify`]) or an error.
///
/// # Errors
/// [`TetError`]: what is wrong with the surface, or what could not be recovered.
pub fn tetrahedralize(surface: &TriMesh, options: &TetOptions) -> Result<TetMesh, TetError> {
    tetrahedralize_with_summary(surface, options).map(|t| t.mesh)
}

/// As [`tetrahedralize`], and says what recovery did.
///
/// # Errors
/// As [`tetrahedralize`].
pub fn tetrahedralize_with_summary(surface: &TriMesh, options: &TetOptions) -> Result<Tetrahedralization, TetError> {
    let edges = input::validate(surface)?;
    let (complex, recovery) = conforming(surface, &edges, options)?;
    let mut carved = carve::carve(&complex, surface)?;
    drop(complex);
    if options.optimize {
        let improvement = optimize::OptimizeOptions { fixed_points: surface.points.len(), ..Default::default() };
        optimize::optimize_complex(&mut carved, &improvement);
    }
    let mesh = carved.into_compact_mesh(surface.points.len());
    certify::certify(&mesh, surface)?;
    Ok(Tetrahedralization { mesh, recovery })
}

/// A complex that has all of the surface. Where recovery leaves a little over, it is tried again with other interior
/// points: what blocks it is a matter of chance on smooth surfaces.
fn conforming(
    surface: &TriMesh,
    edges: &input::SurfaceEdges,
    options: &TetOptions,
) -> Result<(Complex, RecoverySummary), TetError> {
    let mut attempt = 0;
    loop {
        let mut points = surface.points.clone();
        points.extend(interior_points(surface, &other_interior(surface, &options.interior, attempt))?);
        let inner = points.len();
        points.extend(box_corners(&surface.points));
        let mut complex = delaunay::delaunay(&points).map_err(|e| name_interior(e, surface.points.len(), inner))?;
        drop(points);
        match recover::recover(&mut complex, surface, edges, attempt) {
            Ok(summary) => return Ok((complex, summary)),
            Err(TetError::NotRecovered { edges, triangles })
                if attempt + 1 < ATTEMPTS && edges.len() + triangles.len() <= recover::FEW => {}
            Err(error) => return Err(error),
        }
        attempt += 1;
    }
}

/// The interior asked for, or for later attempts one like it.
fn other_interior(surface: &TriMesh, interior: &Interior, attempt: u32) -> Interior {
    let factor = [1.0, 1.07, 0.93, 1.15, 0.87, 1.23, 1.31, 0.8][attempt as usize % 8];
    let h = lattice::mean_edge(surface);
    match interior {
        Interior::Lattice { cell, clearance } if attempt > 0 => Interior::Lattice {
            cell: Some(cell.unwrap_or(CELL * h) * factor),
            clearance: Some(clearance.unwrap_or(CLEARANCE * h) * factor.max(1.0)),
        },
        Interior::None if attempt > 0 => {
            Interior::Lattice { cell: Some(4.0 * CELL * h * factor), clearance: Some(CELL * h) }
        }
        other => other.clone(),
    }
}

fn interior_points(surface: &TriMesh, interior: &Interior) -> Result<Vec<Point3>, TetError> {
    match interior {
        Interior::None => Ok(Vec::new()),
        Interior::Lattice { cell, clearance } => {
            let h = lattice::mean_edge(surface);
            let (cell, clearance) = (cell.unwrap_or(CELL * h), clearance.unwrap_or(CLEARANCE * h));
            Ok(lattice::lattice_points(surface, cell, clearance))
        }
        Interior::Points(points) => {
            let inside = points.iter().zip(0..).find(|(p, _)| !p.iter().all(|x| x.is_finite()));
            match inside {
                Some((&position, index)) => Err(TetError::BadInteriorPoint { index, position }),
                None => Ok(points.clone()),
            }
        }
    }
}

/// Eight points well outside, so that the hull of all points is no part of the surface and all of the surface can be
/// flipped to.
fn box_corners(points: &[Point3]) -> Vec<Point3> {
    let Some(first) = points.first() else { return Vec::new() };
    let (mut low, mut high) = (*first, *first);
    for p in points {
        low = low.inf(p);
        high = high.sup(p);
    }
    let margin = (high - low).max();
    let ends = [low.map(|x| x - margin), high.map(|x| x + margin)];
    (0..8).map(|i: usize| Point3::new(ends[i & 1].x, ends[(i >> 1) & 1].y, ends[i >> 2].z)).collect()
}

/// A point given twice is a fault of the surface, or of the interior points.
fn name_interior(error: TetError, surface: usize, inner: usize) -> TetError {
    match error {
        TetError::DuplicatePoints { second, position, .. } if (surface..inner).contains(&(second as usize)) => {
            TetError::BadInteriorPoint { index: second - surface as u32, position }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests;
