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
use super::recover::remove_steiner_points;
use super::regions::Regions;
use super::request::{Filled, Request};
use super::sized;

/// Operations of the improvement per tetrahedron, as counted by budgets.
const OPTIMIZATION: usize = 15;

/// Fills the requested volume and certifies the mesh.
pub(super) fn fill(r: &Request) -> Result<Filled, TetError> {
    sized::check(r.refinement, r.sizing, r.surface.points.len())?;
    let (complex, mut recovery, given) = conforming(r)?;
    r.watch.report(Stage::Carve, 0, 1)?;
    let (mut carved, left_out, steiner) = carved(r, &complex, given).map_err(|error| diagnosis(r, error))?;
    drop(complex);
    let first = carved.points.len() - steiner;
    recovery.steiner_points = remove_steiner_points(&mut carved, first, r.watch)?;
    let segments = without(r.segments, &left_out.segments);
    r.watch.report(Stage::Carve, 1, 1)?;
    let held = carve::hold_segments(&mut carved, &segments);
    let refine = sized::refine(r, &mut carved)?;
    let optimize = if r.optimize { Some(improve(r, &mut carved)?) } else { None };
    carve::release_segments(&mut carved, &held);
    r.watch.report(Stage::Certify, 0, 1)?;
    let Labels { regions, region_count, ignored_seeds, seeds } =
        if r.label { labels(r, &carved)? } else { Labels::default() };
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
    Ok(Filled { mesh, places, left_out, regions, region_count, ignored_seeds, seeds, recovery, optimize, refine })
}

/// Carves a complex. Returns the filled part, the parts of the input outside, and the number of Steiner points. These are the
/// last points of the part; in `complex` their indices are at least `given`.
fn carved(r: &Request, complex: &Complex, given: usize) -> Result<(Complex, LeftOut, usize), TetError> {
    let sides = match r.baffles {
        0 => Sides::find(complex, r.surface, r.kind, r.holes)?,
        baffles => Sides::find_around(complex, r.surface, baffles)?,
    };
    r.watch.ask()?;
    let left_out = LeftOut::find(complex, &sides, r.surface, r.segments)?;
    match left_out.as_error() {
        Some(error) if r.strict => Err(error),
        _ => {
            let inside = complex.real_tets().filter(|&t| sides.is_inside(t));
            let mut steiner: Vec<u32> =
                inside.flat_map(|t| complex.verts(t)).filter(|&v| v as usize >= given).collect();
            steiner.sort_unstable();
            steiner.dedup();
            Ok((carve::carve(complex, r.surface, &sides), left_out, steiner.len()))
        }
    }
}

/// Regions of a mesh.
#[derive(Default)]
struct Labels {
    /// Region of each tetrahedron, empty if there is only one unnamed region.
    regions: Vec<i32>,
    region_count: usize,
    /// Seeds in regions with an earlier one, each with that one.
    ignored_seeds: Vec<[u32; 2]>,
    /// Seed of each region.
    seeds: Vec<Option<u32>>,
}

fn labels(r: &Request, carved: &Complex) -> Result<Labels, TetError> {
    let found = Regions::of(carved, r.regions)?;
    let regions = if found.matter() { found.ids(carved) } else { Vec::new() };
    let seeds = found.seeds().collect();
    Ok(Labels { regions, region_count: found.len(), ignored_seeds: found.into_ignored(), seeds })
}

/// Improves the mesh; triangles and held segments stay.
fn improve(r: &Request, carved: &mut Complex) -> Result<OptimizeReport, TetError> {
    r.watch.report(Stage::Optimize, 0, 1)?;
    // The improvement limits itself by attempts per tetrahedron.
    r.watch.spend(OPTIMIZATION * carved.slots())?;
    let fixed_points = r.surface.points.len();
    let options = OptimizeOptions { fixed_points, spare_needles: r.spare_needles, ..OptimizeOptions::of(r.effort) };
    let report = optimize_complex(carved, &options, r.watch);
    r.watch.report(Stage::Optimize, 1, 1)?;
    Ok(report)
}
