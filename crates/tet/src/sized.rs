//! Size field and goals of a run, from its options.

use super::complex::Complex;
use super::error::{InputArray, TetError};
use super::options::{Interior, Refinement, Sizing};
use super::plc::{InputKind, Region};
use super::progress::Stage;
use super::refine::{
    Goals, PER_LENGTH, RefineReport, RegionGoals, SizeLimit, SizeTree, TreeOptions, Wall, estimate_spaced,
    estimate_tets, estimate_uniform, graded_points, limit_by_gaps, refine_complex, spaced_points, surrounding_points,
};
use super::regions::Regions;
use super::request::Request;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Point3};
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// Edge length as a function of the position.
pub(super) type SizeFunction = Arc<dyn Fn(&Point3) -> f64 + Send + Sync>;

/// Clearance of interior points from the wall, relative to the edge length wanted there.
const CLEARANCE: f64 = 0.45;

/// Clearance of the points of [`Interior::Growing`], relative to the edge length of the wall.
const GROWING_CLEARANCE: f64 = 0.5;

/// As [`GROWING_CLEARANCE`], for selected points. Distances between them are longer, too.
pub(super) const SPACED_CLEARANCE: f64 = 0.6;

/// Radius-edge ratio above which tetrahedra are split if no bounds are given, where the wall allows. Without it, the mean
/// radius ratio falls below TetGen's on thin surfaces.
const GROWING_RATIO: f64 = 1.4;

/// Volume of the lattice's tetrahedra relative to the volume bound.
pub(super) const VOLUME_SHARE: f64 = 0.6;

/// Margin of the scaffold's points around the surface, relative to its size. The tetrahedralized box is larger.
const SCAFFOLD_MARGIN: f64 = 0.1;

/// Maximum points of the scaffold inside, per point of the surface.
const SCAFFOLD_POINTS: f64 = 20.0;

/// Height of the regular tetrahedron, in edge lengths.
const REGULAR_HEIGHT: f64 = 0.816;

/// Tetrahedra per point that refinement adds.
const TETS_PER_POINT: usize = 6;

/// Largest number of tetrahedra that is told.
const LARGEST_ESTIMATE: f64 = 1e18;

/// Fraction of a volume bound that refinement aims at if vertices are moved afterwards.
const MARGIN: f64 = 0.7;

/// Checks the growth of an interior and the sizes of regions.
///
/// # Errors
/// [`TetError::BadGrowth`], [`TetError::BadSize`].
pub(super) fn check_growth(interior: &Interior, regions: &[Region]) -> Result<(), TetError> {
    let general = if let Interior::Growing { growth } = interior { Some(*growth) } else { None };
    for value in general.into_iter().chain(regions.iter().filter_map(|r| r.growth)) {
        if !(value >= Interior::LEAST_GROWTH && value.is_finite()) {
            return Err(TetError::BadGrowth { value, least: Interior::LEAST_GROWTH });
        }
    }
    match regions.iter().filter_map(|r| r.size).find(|&size| !(size > 0.0 && size.is_finite())) {
        Some(value) => Err(TetError::BadSize { value }),
        None => Ok(()),
    }
}

/// Checks the values of a refinement and a sizing for a surface with `points` points.
///
/// # Errors
/// [`TetError::BadSize`], [`TetError::WrongLength`], [`TetError::BadBound`].
pub(super) fn check(refinement: Option<&Refinement>, sizing: &Sizing, points: usize) -> Result<(), TetError> {
    let positive = |value: f64| {
        if value > 0.0 && value.is_finite() { Ok(()) } else { Err(TetError::BadSize { value }) }
    };
    match sizing {
        Sizing::Constant(size) => positive(*size)?,
        Sizing::PerVertex(sizes) => {
            if sizes.len() != points {
                return Err(TetError::WrongLength { array: InputArray::Sizes, found: sizes.len(), expected: points });
            }
            sizes.iter().try_for_each(|&s| positive(s))?;
        }
        Sizing::Surface | Sizing::Function(_) => {}
    }
    match refinement.and_then(|r| r.bounds.senseless()) {
        Some((bound, value)) => Err(TetError::BadBound { bound, value }),
        None => Ok(()),
    }
}

/// Options of the size field of an interior with these sizes.
pub(super) fn tree_options(interior: &Interior, sizing: &Sizing) -> TreeOptions {
    match (interior, sizing) {
        // Lengths at points are interpolated.
        (Interior::Growing { .. }, Sizing::PerVertex(_)) => TreeOptions { doubling: None, ..TreeOptions::growing(1.0) },
        (Interior::Growing { growth }, _) => TreeOptions::growing(*growth),
        _ => TreeOptions::default(),
    }
}

/// Size field of a surface. `longest` bounds all edge lengths.
fn size_tree(wall: &Wall, sizing: &Sizing, longest: Option<f64>, options: &TreeOptions) -> Option<SizeTree> {
    size_tree_around(wall, &[], sizing, longest, options)
}

/// As [`size_tree`], with lengths at points inside.
pub(super) fn size_tree_around(
    wall: &Wall,
    inside: &[(Point3, f64)],
    sizing: &Sizing,
    longest: Option<f64>,
    options: &TreeOptions,
) -> Option<SizeTree> {
    let function;
    let first: Vec<f64> =
        wall.heights.iter().zip(&wall.sizes).map(|(height, size)| size.max(height / REGULAR_HEIGHT)).collect();
    let mut limits: Vec<SizeLimit> = longest.map(SizeLimit::Constant).into_iter().collect();
    limits.extend((!first.is_empty()).then_some(SizeLimit::PerVertex(&first)));
    limits.extend((!inside.is_empty()).then_some(SizeLimit::Inside(inside)));
    match sizing {
        Sizing::Surface => {}
        Sizing::Constant(size) => limits.push(SizeLimit::Constant(*size)),
        Sizing::PerVertex(sizes) => limits.push(SizeLimit::PerVertex(sizes)),
        Sizing::Function(f) => {
            function = |p: &Point3| f(p);
            limits.push(SizeLimit::Function(&function));
        }
    }
    SizeTree::new(wall.surface, &wall.sizes, &limits, options)
}

/// Wall of a run, with sizes as its interior asks.
fn wall<'a>(r: &Request<'a>) -> Wall<'a> {
    let growing = matches!(r.interior, Interior::Growing { .. });
    let clearance = match (growing, r.spaced) {
        (false, _) => CLEARANCE,
        (true, false) => GROWING_CLEARANCE,
        (true, true) => SPACED_CLEARANCE,
    };
    let mut wall = wall_of(r, clearance);
    if growing {
        limit_by_gaps(&mut wall);
    }
    wall
}

/// Wall of a run, with the edge lengths of the surface.
fn wall_of<'a>(r: &Request<'a>, clearance: f64) -> Wall<'a> {
    Wall { baffles: r.baffles, heights: r.heights, ..Wall::new(r.surface, r.kind, clearance) }
}

/// Interior points of a run on a graded lattice; `None` if interior and sizing ask for others.
///
/// # Errors
/// [`TetError::TooMany`], [`TetError::Cancelled`].
pub(super) fn sized_points(r: &Request) -> Result<Option<Vec<Point3>>, TetError> {
    let longest = match r.interior {
        // A cube holds twelve tetrahedra.
        Interior::Growing { .. } => r
            .refinement
            .and_then(|x| x.bounds.max_volume)
            .map(|v| TreeOptions::edge_of(libm::cbrt(12.0 * VOLUME_SHARE * v))),
        Interior::Lattice { cell: None, clearance: None } if !matches!(r.sizing, Sizing::Surface) => None,
        _ => return Ok(None),
    };
    let wall = wall(r);
    let options = TreeOptions { is_fine: r.spaced, ..tree_options(r.interior, r.sizing) };
    let Some(tree) = size_tree_around(&wall, r.sources, r.sizing, longest, &options) else {
        // Far too many cubes have no indices.
        let constant = if let Sizing::Constant(size) = r.sizing { Some(*size) } else { None };
        if let Some(length) = longest.into_iter().chain(constant).reduce(f64::min) {
            let limit = r.max_tets.unwrap_or(u32::MAX as usize);
            within(estimate_uniform(length / TreeOptions::edge_of(1.0), &wall), limit)?;
        }
        return Ok(None);
    };
    let grading = tree.grading().filter(|_| r.spaced);
    if let Some(limit) = r.max_tets {
        let estimate = match grading {
            Some(grading) => estimate_spaced(&tree, &wall, grading),
            None => estimate_tets(&tree, &wall),
        };
        within(if tree.is_truncated() { estimate.max(limit as f64 + 1.0) } else { estimate }, limit)?;
    }
    let points = graded_points(&tree, &wall, r.watch)?;
    Ok(Some(match grading {
        Some(grading) => spaced_points(&points, grading),
        None => points,
    }))
}

/// Points on both sides of a surface, none of which is in `others`. They grow apart with the distance from the surface.
/// Returns none if too many would be needed, for example between long needles.
///
/// # Errors
/// [`TetError::Cancelled`].
pub(super) fn scaffold_points(r: &Request, others: &[Point3]) -> Result<Vec<Point3>, TetError> {
    let mut wall = wall_of(r, GROWING_CLEARANCE);
    limit_by_gaps(&mut wall);
    let options = TreeOptions::growing(Interior::GROWTH);
    let Some(tree) = size_tree(&wall, &Sizing::Surface, None, &options) else { return Ok(Vec::new()) };
    let most = TETS_PER_POINT as f64 * SCAFFOLD_POINTS * r.surface.points.len() as f64;
    if tree.is_truncated() || estimate_tets(&tree, &wall) > most {
        return Ok(Vec::new());
    }
    let mut points = surrounding_points(&tree, &wall, r.watch)?;
    let bits = |p: &Point3| [p.x, p.y, p.z].map(f64::to_bits);
    let known: FxHashSet<[u64; 3]> = others.iter().map(bits).collect();
    let around = Aabb::of_points(&r.surface.points);
    let around = around.grown(SCAFFOLD_MARGIN * (around.max - around.min).max());
    let near = |p: &Point3| (0..3).all(|i| (around.min[i]..=around.max[i]).contains(&p[i]));
    points.retain(|p| near(p) && !known.contains(&bits(p)));
    Ok(points)
}

/// Checks the number of tetrahedra of a uniform lattice with cubes of this side.
///
/// # Errors
/// [`TetError::TooMany`].
pub(super) fn check_uniform(r: &Request, side: f64) -> Result<(), TetError> {
    let Some(limit) = r.max_tets else { return Ok(()) };
    within(estimate_uniform(side, &wall_of(r, CLEARANCE)), limit)
}

fn within(estimate: f64, limit: usize) -> Result<(), TetError> {
    if estimate <= limit as f64 { Ok(()) } else { Err(TetError::TooMany { estimate: rounded(estimate), limit }) }
}

/// Rounds an estimate to two digits.
fn rounded(estimate: f64) -> usize {
    let estimate = estimate.min(LARGEST_ESTIMATE);
    let unit = libm::pow(10_f64, (libm::log10(estimate).floor() - 1.0).max(0.0));
    ((estimate / unit).ceil() * unit) as usize
}

/// Checks that a volume filled with tetrahedra of at most this edge length may have at most `limit` of them, as
/// [`fill_spaced`](crate::parts::fill_spaced) makes them. The number is a lower bound.
///
/// # Errors
/// [`TetError::TooMany`].
pub fn ensure_countable(volume: f64, size: f64, limit: usize) -> Result<(), TetError> {
    within(PER_LENGTH * volume / libm::pow(size, 3.0), limit)
}

/// Splits tetrahedra that violate the goals of a run; segments must be held.
///
/// # Errors
/// A seed outside; [`TetError::TooMany`]; [`TetError::Cancelled`].
pub(super) fn refine(r: &Request, carved: &mut Complex) -> Result<Option<RefineReport>, TetError> {
    let sized = !matches!(r.sizing, Sizing::Surface);
    let bounded = r.regions.iter().chain(r.region).any(Region::is_bounded);
    let asked_for = r.refinement.is_some() || sized || bounded;
    let growing = matches!(r.interior, Interior::Growing { .. });
    if !asked_for && !growing {
        return Ok(None);
    }
    r.watch.report(Stage::Refine, 0, 0)?;
    let wall = (sized || r.regions.iter().chain(r.region).any(|region| region.growth.is_some())).then(|| wall(r));
    let tree = wall.as_ref().filter(|_| sized);
    let tree = tree.and_then(|w| size_tree(w, r.sizing, None, &tree_options(r.interior, r.sizing)));
    let size = tree.map(|tree| move |p: &Point3| tree.size_at(p));
    let mut goals = goals(r.refinement);
    if growing && r.refinement.is_none() {
        goals.bounds.max_radius_edge = Some(GROWING_RATIO);
    }
    goals.size = size.as_ref().map(|f| f as &dyn Fn(&Point3) -> f64);
    let (mut region_goals, mut of) = (Vec::new(), Vec::new());
    if r.region.is_some() {
        region_goals = vec![region_goal(r, wall.as_ref(), r.region)];
        of = vec![0; carved.slots()];
    } else if bounded {
        let found = Regions::of(carved, r.regions)?;
        let region = |seed: Option<u32>| seed.map(|s| &r.regions[s as usize]);
        region_goals = found.seeds().map(|seed| region_goal(r, wall.as_ref(), region(seed))).collect();
        of = found.into_slots();
    }
    goals.regions = &region_goals;
    if r.optimize {
        // Smoothing enlarges some of them again.
        goals.bounds.max_volume = goals.bounds.max_volume.map(|bound| MARGIN * bound);
    }
    let free = r.max_tets.map(|limit| limit.saturating_sub(carved.real_tets().count()) / TETS_PER_POINT);
    let asked = goals.max_points.unwrap_or(usize::MAX);
    goals.max_points = goals.max_points.or(free).map(|points| points.min(free.unwrap_or(points)));
    let report = refine_complex(carved, &goals, of, |points| r.watch.report(Stage::Refine, points, 0).is_ok());
    r.watch.report(Stage::Refine, report.points, report.points)?;
    match (r.max_tets, free) {
        (Some(limit), Some(free)) if report.limit_reached && free < asked => {
            Err(TetError::TooMany { estimate: limit.saturating_add(1), limit })
        }
        _ => Ok(Some(report).filter(|_| asked_for)),
    }
}

/// Goals of a region with this seed.
fn region_goal(r: &Request, wall: Option<&Wall>, region: Option<&Region>) -> RegionGoals {
    let Some(region) = region else { return RegionGoals::default() };
    let field = wall.zip(region.growth);
    let field = field.and_then(|(wall, g)| size_tree(wall, r.sizing, region.size, &TreeOptions::growing(g)));
    let constant = region.size.unwrap_or(f64::INFINITY);
    RegionGoals {
        max_volume: region.max_volume.filter(|&b| b > 0.0),
        size: if field.is_some() || region.size.is_some() {
            Some(Box::new(move |p: &Point3| field.as_ref().map_or(constant, |tree| tree.size_at(p).min(constant))))
        } else {
            None
        },
    }
}

/// Goals of a refinement, without sizes.
pub(super) fn goals(refinement: Option<&Refinement>) -> Goals<'static> {
    let Some(r) = refinement else { return Goals::default() };
    Goals { bounds: r.bounds, size: None, max_points: r.max_points, regions: &[] }
}

/// Edge length of a regular tetrahedron with this volume.
pub(super) fn edge_of_volume(volume: f64) -> f64 {
    libm::cbrt(8.485_281_374 * volume)
}

/// Edge length wanted at a point: from the size field, or the surface's mean without one.
pub(super) fn size_function(
    surface: &TriMesh,
    sizing: &Sizing,
    volume: Option<f64>,
) -> impl Fn(&Point3) -> f64 + use<> {
    let tree = size_tree(&Wall::new(surface, InputKind::Plc, CLEARANCE), sizing, None, &TreeOptions::default());
    let mean = surface.mean_edge();
    let limit = volume.map_or(f64::INFINITY, edge_of_volume);
    move |p: &Point3| tree.as_ref().map_or(mean, |tree| tree.size_at(p)).min(limit)
}
