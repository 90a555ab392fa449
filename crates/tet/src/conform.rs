//! Conforming complex: Delaunay tetrahedralization, then boundary recovery by several strategies.

use super::attempts::recover_rest;
use super::complex::Complex;
use super::error::TetError;
use super::input;
use super::lattice;
use super::options::{Interior, Refinement};
use super::progress::Stage;
use super::recover::exact::Missing;
use super::recover::{self, RecoverySummary, Rule};
use super::request::Request;
use super::survey::survey;
use super::{contacts, delaunay, sized};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::MIN_MAGNITUDE;

/// Side of the lattice's cubes, in mean edge lengths of the surface.
const CELL: f64 = 1.4;

/// Distance of the lattice from the wall, in mean edge lengths of the surface.
const CLEARANCE: f64 = 0.45;

/// Replaces an error by the defect of the surface that may have caused it.
pub(super) fn diagnosis(r: &Request, error: TetError) -> TetError {
    if error.is_stop() {
        return error;
    }
    let checked = input::no_duplicate_points(&r.surface.points)
        .and_then(|()| input::no_duplicate_triangles(&r.surface.triangles))
        .and_then(|()| contacts::no_contacts(r.surface, r.watch))
        .and_then(|()| contacts::no_points_in_triangles(r.surface));
    checked.err().unwrap_or(error)
}

/// Builds a complex with the whole surface: by flips and Steiner points, then by exact recovery of the rest.
/// The third value is the number of points that are no Steiner points.
pub(super) fn conforming(r: &Request) -> Result<(Complex, RecoverySummary, usize), TetError> {
    let surface = r.surface;
    r.watch.report(Stage::Delaunay, 0, 1)?;
    let points = points(r)?;
    let mut complex = delaunay::delaunay_watched(&points, r.watch)
        .map_err(|e| name_interior(e, surface.points.len(), points.len() - 8))?;
    r.watch.report(Stage::Delaunay, 1, 1)?;
    let (before_flips, _) = survey(&mut complex, surface, r.edges);
    let (edges, triangles) = match recover::recover(&mut complex, surface, r.edges, Rule::Positive, r.watch) {
        Ok(summary) => return Ok((complex, summary, points.len())),
        Err(TetError::NotRecovered { edges, triangles }) => (edges, triangles),
        Err(error) if error.is_stop() => return Err(error),
        Err(error) => return Err(diagnosis(r, error)),
    };
    // Exact recovery requires a surface without self-intersections.
    contacts::no_contacts(surface, r.watch)?;
    contacts::no_points_in_triangles(surface)?;
    let missing = Missing { edges: &edges, triangles: &triangles };
    let (complex, summary) = recover_rest(r, &points, complex, (missing, &before_flips))?;
    Ok((complex, summary, points.len()))
}

/// Points of the surface, interior points, and eight points around them.
fn points(r: &Request) -> Result<Vec<Point3>, TetError> {
    let surface = r.surface;
    let mut points = surface.points.clone();
    match sized::sized_points(r)? {
        Some(inside) => points.extend(inside),
        None => points.extend(interior_points(r, &for_volume(surface, r.interior, r.refinement))?),
    }
    // A smaller box has a smaller roundoff bound. Smooth walls still leave space for flips.
    let tight = matches!(r.interior, Interior::Graded { .. } | Interior::Local { .. });
    points.extend(if tight { box_around(&surface.points, 0.2) } else { box_corners(&surface.points) });
    Ok(points)
}

/// Interior as requested. A lattice without a given size gets tetrahedra within the volume bound.
fn for_volume(surface: &TriMesh, interior: &Interior, refinement: Option<&Refinement>) -> Interior {
    let usual = CELL * surface.mean_edge();
    match (interior, refinement.and_then(|r| r.bounds.max_volume)) {
        (Interior::Lattice { cell: None, clearance }, Some(bound)) => {
            // A cube holds twelve tetrahedra.
            let cell = libm::cbrt(12.0 * sized::VOLUME_SHARE * bound).min(usual);
            let near = CLEARANCE / CELL * cell.max(0.5 * usual);
            Interior::Lattice { cell: Some(cell), clearance: Some(clearance.unwrap_or(near)) }
        }
        _ => interior.clone(),
    }
}

fn interior_points(r: &Request, interior: &Interior) -> Result<Vec<Point3>, TetError> {
    let (surface, watch) = (r.surface, r.watch);
    match interior {
        Interior::None | Interior::Growing { .. } => Ok(Vec::new()),
        Interior::Lattice { cell, clearance } | Interior::Graded { cell, clearance } => {
            let h = surface.mean_edge();
            let (cell, clearance) = (cell.unwrap_or(CELL * h), clearance.unwrap_or(CLEARANCE * h));
            let graded = matches!(interior, Interior::Graded { .. });
            if !graded {
                sized::check_uniform(r, cell)?;
            }
            let points = if graded { lattice::graded_lattice_points } else { lattice::lattice_points };
            Ok(points(surface, cell, clearance, watch)?)
        }
        Interior::Local { cell, clearance } => Ok(lattice::local_lattice_points(surface, *cell, *clearance, watch)?),
        Interior::Points(points) => {
            let inside = points.iter().zip(0..).find(|(p, _)| !p.iter().all(|x| x.is_finite()));
            match inside {
                Some((&position, index)) => Err(TetError::BadInteriorPoint { index, position }),
                None => Ok(points.clone()),
            }
        }
    }
}

/// Eight points well outside, so that the convex hull has no part of the surface and flips can recover all of it.
pub(super) fn box_corners(points: &[Point3]) -> Vec<Point3> {
    box_around(points, 1.0)
}

/// Corners of a box with a margin of `share` times the size of the points.
fn box_around(points: &[Point3], share: f64) -> Vec<Point3> {
    let Some(first) = points.first() else { return Vec::new() };
    let (mut low, mut high) = (*first, *first);
    for p in points {
        low = low.inf(p);
        high = high.sup(p);
    }
    let margin = share * (high - low).max();
    let safe = |x: f64| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x };
    let ends = [low.map(|x| safe(x - margin)), high.map(|x| safe(x + margin))];
    (0..8).map(|i: usize| Point3::new(ends[i & 1].x, ends[(i >> 1) & 1].y, ends[i >> 2].z)).collect()
}

/// Attributes a duplicate point to the surface or to the interior points.
fn name_interior(error: TetError, surface: usize, inner: usize) -> TetError {
    let given = |v: u32| (surface..inner).contains(&(v as usize));
    match error {
        TetError::DuplicatePoints { ref pairs, position, .. } => match pairs.first() {
            Some(&[_, second]) if given(second) => {
                TetError::BadInteriorPoint { index: second - surface as u32, position }
            }
            _ => error,
        },
        other => other,
    }
}
