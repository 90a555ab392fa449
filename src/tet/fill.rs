//! From a checked input to a certified mesh: Delaunay, recovery, carving, improvement, certificate.

use super::carve::{self, Sides};
use super::certify::{Place, certify_facets, certify_left_out, certify_segments};
use super::complex::Complex;
use super::error::TetError;
use super::input::SurfaceEdges;
use super::optimize::{Effort, OptimizeOptions, OptimizeReport, optimize_complex};
use super::options::{Interior, Refinement, Sizing};
use super::outside::{LeftOut, without};
use super::plc::{InputKind, Region};
use super::progress::{Stage, Watch};
use super::recover::exact::{Missing, recover_exact};
use super::recover::{self, RecoverySummary, Rule};
use super::refine::RefineReport;
use super::regions::Regions;
use super::{contacts, delaunay, input, lattice, sized};
use crate::geometry::Point3;
use crate::geometry::predicates::MIN_MAGNITUDE;
use crate::mesh::{TetMesh, TriMesh};

/// Side of the lattice's cubes in mean edge lengths of the surface.
const CELL: f64 = 1.4;

/// Distance of the lattice from the wall in mean edge lengths of the surface.
const CLEARANCE: f64 = 0.45;

/// Volume of the lattice's tetrahedra over the bound on volumes.
const VOLUME_SHARE: f64 = 0.6;

/// A checked input and what is wanted of it.
pub(super) struct Request<'a> {
    pub surface: &'a TriMesh,
    pub edges: &'a SurfaceEdges,
    pub segments: &'a [[u32; 2]],
    pub kind: InputKind,
    pub holes: &'a [Point3],
    pub regions: &'a [Region],
    pub interior: &'a Interior,
    pub refinement: Option<&'a Refinement>,
    pub sizing: &'a Sizing,
    pub optimize: bool,
    /// Whether the mesh is proved to fill the surface.
    pub certify: bool,
    pub effort: Effort,
    /// Whether triangles and segments outside are an error.
    pub strict: bool,
    /// Whether tetrahedra are told apart by regions.
    pub label: bool,
    pub watch: &'a Watch<'a>,
}

/// A certified mesh.
pub(super) struct Filled {
    pub mesh: TetMesh,
    /// Where each triangle of the input that is not left out lies in it; empty without the certificate.
    pub places: Vec<Place>,
    /// What of the input lies outside.
    pub left_out: LeftOut,
    /// Region of each tetrahedron, where there is something to say.
    pub regions: Vec<i32>,
    pub region_count: usize,
    pub recovery: RecoverySummary,
    pub optimize: Option<OptimizeReport>,
    pub refine: Option<RefineReport>,
}

/// Fills what the request describes, and proves it.
pub(super) fn fill(r: &Request) -> Result<Filled, TetError> {
    sized::check(r.refinement, r.sizing, r.surface.points.len())?;
    let (complex, recovery) = conforming(r)?;
    r.watch.report(Stage::Carve, 0, 1)?;
    let (mut carved, left_out) = carved(r, &complex).map_err(|error| diagnosis(r, error))?;
    drop(complex);
    let segments = without(r.segments, &left_out.segments);
    r.watch.report(Stage::Carve, 1, 1)?;
    let held = carve::hold_segments(&mut carved, &segments);
    let refine = sized::refine(r, &mut carved)?;
    let optimize = if r.optimize { Some(improve(r, &mut carved)?) } else { None };
    carve::release_segments(&mut carved, &held);
    r.watch.report(Stage::Certify, 0, 1)?;
    let (regions, region_count) = if r.label { labels(r, &carved)? } else { (Vec::new(), 0) };
    let mesh = carved.into_compact_mesh(r.surface.points.len());
    let mut places = Vec::new();
    if r.certify {
        places = certify_facets(&mesh, &left_out.kept_surface(r.surface), r.kind, &regions)?;
        certify_segments(&mesh, &segments)?;
        certify_left_out(&mesh, r.surface, r.segments, &left_out)?;
    }
    r.watch.report(Stage::Certify, 1, 1)?;
    Ok(Filled { mesh, places, left_out, regions, region_count, recovery, optimize, refine })
}

/// What of a complex is filled, and what of the input lies outside of that.
fn carved(r: &Request, complex: &Complex) -> Result<(Complex, LeftOut), TetError> {
    let sides = Sides::find(complex, r.surface, r.kind, r.holes)?;
    let left_out = LeftOut::find(complex, &sides, r.surface, r.segments)?;
    match left_out.as_error() {
        Some(error) if r.strict => Err(error),
        _ => Ok((carve::carve(complex, r.surface, &sides), left_out)),
    }
}

/// Region of each tetrahedron, where there is something to say, and the number of regions.
fn labels(r: &Request, carved: &Complex) -> Result<(Vec<i32>, usize), TetError> {
    let found = Regions::of(carved, r.regions)?;
    Ok((if found.matter() { found.ids(carved) } else { Vec::new() }, found.len()))
}

/// Improves the mesh; triangles stay, and segments that are held.
fn improve(r: &Request, carved: &mut Complex) -> Result<OptimizeReport, TetError> {
    r.watch.report(Stage::Optimize, 0, 1)?;
    let options = OptimizeOptions { fixed_points: r.surface.points.len(), ..OptimizeOptions::of(r.effort) };
    let report = optimize_complex(carved, &options);
    r.watch.report(Stage::Optimize, 1, 1)?;
    Ok(report)
}

/// A failure whose cause may be the surface: then that is named instead.
fn diagnosis(r: &Request, error: TetError) -> TetError {
    let checked = input::no_duplicate_points(&r.surface.points)
        .and_then(|()| input::no_duplicate_triangles(&r.surface.triangles))
        .and_then(|()| contacts::no_contacts(r.surface, r.watch))
        .and_then(|()| contacts::no_points_in_triangles(r.surface));
    checked.err().unwrap_or(error)
}

/// A complex that has all of the surface: by flips and vertices off it, and where these leave something over exactly.
fn conforming(r: &Request) -> Result<(Complex, RecoverySummary), TetError> {
    let surface = r.surface;
    r.watch.report(Stage::Delaunay, 0, 1)?;
    let mut points = surface.points.clone();
    match sized::sized_points(r) {
        Some(inside) => points.extend(inside),
        None => points.extend(interior_points(surface, &for_volume(surface, r.interior, r.refinement))?),
    }
    let inner = points.len();
    // The smaller the box, the smaller the bound on the roundoff in it; there is room to flip in for smooth walls.
    let tight = matches!(r.interior, Interior::Graded { .. } | Interior::Local { .. });
    points.extend(if tight { box_around(&surface.points, 0.2) } else { box_corners(&surface.points) });
    let mut complex = delaunay::delaunay(&points).map_err(|e| name_interior(e, surface.points.len(), inner))?;
    r.watch.report(Stage::Delaunay, 1, 1)?;
    let (edges, triangles) = match recover::recover(&mut complex, surface, r.edges, Rule::Positive, r.watch) {
        Ok(summary) => return Ok((complex, summary)),
        Err(TetError::NotRecovered { edges, triangles }) => (edges, triangles),
        Err(TetError::Cancelled) => return Err(TetError::Cancelled),
        Err(error) => return Err(diagnosis(r, error)),
    };
    // Exact recovery takes for granted that the surface does not meet itself.
    contacts::no_contacts(surface, r.watch)?;
    contacts::no_points_in_triangles(surface)?;
    let missing = Missing { edges: &edges, triangles: &triangles };
    let thick = Rule::thick(&surface.points);
    // Where flips have met with flat parts they have left flat tetrahedra, more than one for each edge.
    let flat = complex.real_tets().filter(|&t| !thick.allows(&complex, &complex.verts(t)));
    let first = if flat.take(edges.len() + 1).count() > edges.len() {
        Err(None)
    } else {
        exactly(r, &complex, missing, points.len(), false).map_err(Some)
    };
    drop(complex);
    first.or_else(|error| match error {
        None => by_rule(r, &points, thick).or_else(|error| again(error, || by_rule(r, &points, Rule::Positive))),
        Some(error) => again(error, || by_rule(r, &points, thick)),
    })
}

/// Tries another way after an error that may be owed to the way.
fn again<T>(error: TetError, other: impl FnOnce() -> Result<T, TetError>) -> Result<T, TetError> {
    if matches!(error, TetError::Stuck { .. }) { other() } else { Err(error) }
}

/// A complex that has all of the surface, from the beginning by flips that a rule allows.
fn by_rule(r: &Request, points: &[Point3], rule: Rule) -> Result<(Complex, RecoverySummary), TetError> {
    let mut complex = delaunay::delaunay(points)?;
    match recover::recover(&mut complex, r.surface, r.edges, rule, r.watch) {
        Ok(summary) => Ok((complex, summary)),
        Err(TetError::NotRecovered { edges, triangles }) => {
            let missing = Missing { edges: &edges, triangles: &triangles };
            exactly(r, &complex, missing, points.len(), rule != Rule::Positive)
        }
        Err(error) => Err(error),
    }
}

/// Recovers exactly what is missing; `turned` where parts are flat but for rounding.
fn exactly(
    r: &Request,
    complex: &Complex,
    missing: Missing,
    points: usize,
    turned: bool,
) -> Result<(Complex, RecoverySummary), TetError> {
    let before = complex.points.len() - points;
    let (complex, exact) = recover_exact(complex, r.surface, r.edges, missing, turned, r.watch)?;
    let (missing_edges, missing_triangles) = (missing.edges.len(), missing.triangles.len());
    Ok((complex, RecoverySummary { missing_edges, missing_triangles, steiner_points: before + exact.steiner_points }))
}

/// The interior asked for; a lattice whose size is left open gets tetrahedra within the bound on volumes.
fn for_volume(surface: &TriMesh, interior: &Interior, refinement: Option<&Refinement>) -> Interior {
    let usual = CELL * surface.mean_edge();
    match (interior, refinement.and_then(|r| r.bounds.max_volume)) {
        (Interior::Lattice { cell: None, clearance }, Some(bound)) => {
            // A cube holds twelve tetrahedra.
            let cell = (12.0 * VOLUME_SHARE * bound).cbrt().min(usual);
            let near = CLEARANCE / CELL * cell.max(0.5 * usual);
            Interior::Lattice { cell: Some(cell), clearance: Some(clearance.unwrap_or(near)) }
        }
        _ => interior.clone(),
    }
}

fn interior_points(surface: &TriMesh, interior: &Interior) -> Result<Vec<Point3>, TetError> {
    match interior {
        Interior::None => Ok(Vec::new()),
        Interior::Lattice { cell, clearance } | Interior::Graded { cell, clearance } => {
            let h = surface.mean_edge();
            let (cell, clearance) = (cell.unwrap_or(CELL * h), clearance.unwrap_or(CLEARANCE * h));
            let graded = matches!(interior, Interior::Graded { .. });
            let points = if graded { lattice::graded_lattice_points } else { lattice::lattice_points };
            Ok(points(surface, cell, clearance))
        }
        Interior::Local { cell, clearance } => Ok(lattice::local_lattice_points(surface, *cell, *clearance)),
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
pub(super) fn box_corners(points: &[Point3]) -> Vec<Point3> {
    box_around(points, 1.0)
}

/// The corners of a box that stands off by so many sizes of the points' own.
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

/// A point given twice is a fault of the surface, or of the interior points.
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
