//! Conforming complex: Delaunay tetrahedralization, then boundary recovery by several strategies.

use super::complex::Complex;
use super::error::TetError;
use super::input;
use super::lattice;
use super::options::{Interior, Refinement};
use super::progress::Stage;
use super::recover::exact::{Missing, RecoveryStrategy, recover_exact};
use super::recover::{self, RecoverySummary, Rule, flat_height, flat_height_in_single, lies_in_planes, lies_turned};
use super::request::Request;
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
pub(super) fn conforming(r: &Request) -> Result<(Complex, RecoverySummary), TetError> {
    let surface = r.surface;
    r.watch.report(Stage::Delaunay, 0, 1)?;
    let points = points(r)?;
    let mut complex = delaunay::delaunay_watched(&points, r.watch)
        .map_err(|e| name_interior(e, surface.points.len(), points.len() - 8))?;
    r.watch.report(Stage::Delaunay, 1, 1)?;
    let (edges, triangles) = match recover::recover(&mut complex, surface, r.edges, Rule::Positive, r.watch) {
        Ok(summary) => return Ok((complex, summary)),
        Err(TetError::NotRecovered { edges, triangles }) => (edges, triangles),
        Err(error) if error.is_stop() => return Err(error),
        Err(error) => return Err(diagnosis(r, error)),
    };
    // Exact recovery requires a surface without self-intersections.
    contacts::no_contacts(surface, r.watch)?;
    contacts::no_points_in_triangles(surface)?;
    let missing = Missing { edges: &edges, triangles: &triangles };
    exactly(r, &points, &complex, missing)
}

/// Recovers the rest after flips, strategy by strategy.
fn exactly(
    r: &Request,
    points: &[Point3],
    complex: &Complex,
    missing: Missing,
) -> Result<(Complex, RecoverySummary), TetError> {
    let flat = flat_height(&r.surface.points);
    let single = flat_height_in_single(&r.surface.points);
    let continue_recovery =
        |ways: &[RecoveryStrategy]| continue_recovery(r, complex, points.len(), missing, (ways, flat));
    let restart_with = |flat, ways: &[RecoveryStrategy]| restart(r, points, flat, ways);
    let restart = |flat| restart_with(flat, &RecoveryStrategy::TURNED);
    let rounded = single.filter(|&coarse| lies_turned(r.surface, missing.edges, coarse));
    let planes = lies_in_planes(r.surface, missing.edges, flat);
    let turned = planes || lies_turned(r.surface, missing.edges, flat) || has_flat(complex, flat, missing.edges.len());
    let first = match rounded {
        Some(coarse) => restart(coarse),
        None if turned => restart(flat),
        None => continue_recovery(&RecoveryStrategy::FIRST),
    };
    let second = or_retry(first, || match single.filter(|_| rounded.is_none()) {
        Some(coarse) => restart(coarse),
        None if turned || rounded.is_some() => continue_recovery(&RecoveryStrategy::FIRST),
        None => restart(flat),
    });
    let third = or_retry(second, || continue_recovery(&RecoveryStrategy::OTHERS));
    or_retry(third, || restart_with(rounded.unwrap_or(flat), &RecoveryStrategy::LAST))
}

/// True if flips have left more flat tetrahedra than edges, a sign of flat surface parts.
fn has_flat(complex: &Complex, height: f64, edges: usize) -> bool {
    let flat = complex.real_tets().filter(|&t| !Rule::Thick(height).allows(complex, &complex.verts(t)));
    flat.take(edges + 1).count() > edges
}

/// Tries another strategy after an error that may depend on the strategy.
fn or_retry<T>(result: Result<T, TetError>, other: impl FnOnce() -> Result<T, TetError>) -> Result<T, TetError> {
    if matches!(result, Err(TetError::Stuck { .. })) { other() } else { result }
}

/// Continues exact recovery in the complex left by flips, with the given strategies.
fn continue_recovery(
    r: &Request,
    complex: &Complex,
    points: usize,
    missing: Missing,
    ways: (&[RecoveryStrategy], f64),
) -> Result<(Complex, RecoverySummary), TetError> {
    let before = complex.points.len() - points;
    let (complex, exact) = recover_exact(complex, r.surface, r.edges, missing, ways, r.watch)?;
    let (missing_edges, missing_triangles) = (missing.edges.len(), missing.triangles.len());
    Ok((complex, RecoverySummary { missing_edges, missing_triangles, steiner_points: before + exact.steiner_points }))
}

/// Restarts with flips that make nothing thinner than `flat`, then continues with the given strategies.
fn restart(
    r: &Request,
    points: &[Point3],
    flat: f64,
    ways: &[RecoveryStrategy],
) -> Result<(Complex, RecoverySummary), TetError> {
    let mut complex = delaunay::delaunay_watched(points, r.watch)?;
    match recover::recover(&mut complex, r.surface, r.edges, Rule::Thick(flat), r.watch) {
        Ok(summary) => Ok((complex, summary)),
        Err(TetError::NotRecovered { edges, triangles }) => {
            let missing = Missing { edges: &edges, triangles: &triangles };
            continue_recovery(r, &complex, points.len(), missing, (ways, flat))
        }
        Err(error) => Err(error),
    }
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
            let cell = (12.0 * sized::VOLUME_SHARE * bound).cbrt().min(usual);
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
