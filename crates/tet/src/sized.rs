//! Size field and goals of a run, from its options.

use super::complex::Complex;
use super::error::{InputArray, TetError};
use super::options::{Interior, Refinement, Sizing};
use super::progress::Stage;
use super::refine::{
    Goals, RefineReport, SizeLimit, SizeTree, TreeOptions, graded_points, refine_complex, vertex_sizes,
};
use super::regions::Regions;
use super::request::Request;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;

/// Clearance of interior points from the wall, relative to the edge length wanted there.
const CLEARANCE: f64 = 0.45;

/// Fraction of a volume bound that refinement aims at if vertices are moved afterwards.
const MARGIN: f64 = 0.7;

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

/// Size field of a surface.
pub(super) fn size_tree(surface: &TriMesh, sizing: &Sizing) -> Option<(SizeTree, Vec<f64>)> {
    let sizes = vertex_sizes(surface);
    let function;
    let limit = match sizing {
        Sizing::Surface => None,
        Sizing::Constant(size) => Some(SizeLimit::Constant(*size)),
        Sizing::PerVertex(sizes) => Some(SizeLimit::PerVertex(sizes)),
        Sizing::Function(f) => {
            function = |p: &Point3| f(p);
            Some(SizeLimit::Function(&function))
        }
    };
    let tree = SizeTree::new(surface, &sizes, limit.as_slice(), &TreeOptions::default())?;
    Some((tree, sizes))
}

/// Interior points of a run with a given sizing; `None` if interior or sizing exclude them.
pub(super) fn sized_points(r: &Request) -> Option<Vec<Point3>> {
    let asked =
        !matches!(r.sizing, Sizing::Surface) && matches!(r.interior, Interior::Lattice { cell: None, clearance: None });
    if !asked {
        return None;
    }
    let (tree, sizes) = size_tree(r.surface, r.sizing)?;
    Some(graded_points(r.surface, &sizes, &tree, CLEARANCE))
}

/// Splits tetrahedra that violate the goals of a run; segments must be held.
///
/// # Errors
/// A seed outside; [`TetError::Cancelled`].
pub(super) fn refine(r: &Request, carved: &mut Complex) -> Result<Option<RefineReport>, TetError> {
    let sized = !matches!(r.sizing, Sizing::Surface);
    if r.refinement.is_none() && !sized {
        return Ok(None);
    }
    r.watch.report(Stage::Refine, 0, 0)?;
    let tree = if sized { size_tree(r.surface, r.sizing) } else { None };
    let size = tree.map(|(tree, _)| move |p: &Point3| tree.size_at(p));
    let mut goals = goals(r.refinement);
    goals.size = size.as_ref().map(|f| f as &dyn Fn(&Point3) -> f64);
    let bounded = r.regions.iter().any(|region| region.max_volume.is_some());
    let bounds = if bounded { Regions::of(carved, r.regions)?.volume_bounds(r.regions) } else { Vec::new() };
    if r.optimize {
        // Smoothing enlarges some of them again.
        goals.bounds.max_volume = goals.bounds.max_volume.map(|bound| MARGIN * bound);
    }
    let report = refine_complex(carved, &goals, bounds, |points| r.watch.report(Stage::Refine, points, 0).is_ok());
    r.watch.report(Stage::Refine, report.points, report.points)?;
    Ok(Some(report))
}

/// Goals of a refinement, without sizes.
pub(super) fn goals(refinement: Option<&Refinement>) -> Goals<'static> {
    let Some(r) = refinement else { return Goals::default() };
    Goals { bounds: r.bounds, size: None, max_points: r.max_points }
}

/// Edge length of a regular tetrahedron with this volume.
pub(super) fn edge_of_volume(volume: f64) -> f64 {
    (8.485_281_374 * volume).cbrt()
}

/// Edge length wanted at a point: from the size field, or the surface's mean without one.
pub(super) fn size_function(
    surface: &TriMesh,
    sizing: &Sizing,
    volume: Option<f64>,
) -> impl Fn(&Point3) -> f64 + use<> {
    let tree = size_tree(surface, sizing);
    let mean = surface.mean_edge();
    let limit = volume.map_or(f64::INFINITY, edge_of_volume);
    move |p: &Point3| tree.as_ref().map_or(mean, |(tree, _)| tree.size_at(p)).min(limit)
}
