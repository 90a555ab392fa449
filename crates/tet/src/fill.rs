//! Pipeline from a checked input to a certified mesh: conforming complex, carving, improvement, certificate.

use super::carve::{self, Sides};
use super::certify::{certify_facets, certify_left_out, certify_segments};
use super::complex::Complex;
use super::conform::{conforming, diagnosis};
use super::error::TetError;
use super::optimize::{OptimizeOptions, OptimizeReport, optimize_complex};
use super::outside::without;
use super::plc::LeftOut;
use super::progress::Stage;
use super::regions::Regions;
use super::request::{Filled, Request};
use super::sized;

/// Operations of the improvement per tetrahedron, as counted by budgets.
const OPTIMIZATION: usize = 15;

/// Fills the requested volume and certifies the mesh.
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
    r.watch.ask()?;
    let mut places = Vec::new();
    if r.certify {
        places = certify_facets(&mesh, &left_out.kept_surface(r.surface), r.kind, &regions)?;
        r.watch.ask()?;
        certify_segments(&mesh, &segments)?;
        certify_left_out(&mesh, r.surface, r.segments, &left_out)?;
    }
    r.watch.report(Stage::Certify, 1, 1)?;
    Ok(Filled { mesh, places, left_out, regions, region_count, recovery, optimize, refine })
}

/// Carves a complex. Returns the filled part and the parts of the input outside of it.
fn carved(r: &Request, complex: &Complex) -> Result<(Complex, LeftOut), TetError> {
    let sides = Sides::find(complex, r.surface, r.kind, r.holes)?;
    r.watch.ask()?;
    let left_out = LeftOut::find(complex, &sides, r.surface, r.segments)?;
    match left_out.as_error() {
        Some(error) if r.strict => Err(error),
        _ => Ok((carve::carve(complex, r.surface, &sides), left_out)),
    }
}

/// Region of each tetrahedron, empty if there is only one unnamed region, and the number of regions.
fn labels(r: &Request, carved: &Complex) -> Result<(Vec<i32>, usize), TetError> {
    let found = Regions::of(carved, r.regions)?;
    Ok((if found.matter() { found.ids(carved) } else { Vec::new() }, found.len()))
}

/// Improves the mesh; triangles and held segments stay.
fn improve(r: &Request, carved: &mut Complex) -> Result<OptimizeReport, TetError> {
    r.watch.report(Stage::Optimize, 0, 1)?;
    // The improvement limits itself by attempts per tetrahedron.
    r.watch.spend(OPTIMIZATION * carved.slots())?;
    let fixed_points = r.surface.points.len();
    // Callers without a certificate improve their meshes further.
    let options = OptimizeOptions { fixed_points, spare_needles: r.certify, ..OptimizeOptions::of(r.effort) };
    let report = optimize_complex(carved, &options, r.watch);
    r.watch.report(Stage::Optimize, 1, 1)?;
    Ok(report)
}
