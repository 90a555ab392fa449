//! Points near a plane, and on it.

use super::band::Band;
use super::plane::Plane;
use crate::builder::Tetrahedralizer;
use crate::error::TetError;
use crate::plc::InputKind;
use crate::progress::Watch;
use crate::refine::{TreeOptions, Wall, graded_points, limit_by_gaps, spaced_after};
use crate::sized::{SPACED_CLEARANCE, size_tree_around, tree_options};
use anastomesh_mesh::geometry::Point3;

/// Distance from the plane within which points are projected on it, in edge lengths.
const ONTO: f64 = 0.5;

/// Minimum and maximum distance of other points from the plane, in edge lengths.
const BESIDE: [f64; 2] = [0.6, 1.8];

/// Points as in a growing interior, on a plane and within two layers beside it. Without points on the plane, the interface would
/// be as rough as a layer is thick, and would need a wider band.
///
/// # Errors
/// [`TetError::Cancelled`].
pub(super) fn points_along(
    by: &Tetrahedralizer,
    band: &Band,
    plane: Plane,
    watch: &Watch,
) -> Result<Vec<Point3>, TetError> {
    let (interior, sizing) = by.spacing();
    let mut wall = Wall::new(&band.boxed, InputKind::Plc, SPACED_CLEARANCE);
    limit_by_gaps(&mut wall);
    let options = TreeOptions { is_fine: true, ..tree_options(interior, sizing) };
    let Some(tree) = size_tree_around(&wall, &band.sources, sizing, None, &options) else { return Ok(Vec::new()) };
    let Some(grading) = tree.grading() else { return Ok(Vec::new()) };
    let (mut on, mut beside) = (Vec::new(), Vec::new());
    for p in graded_points(&tree, &wall, watch)? {
        let layers = plane.distance(&p).abs() / grading.at(&p);
        if layers < ONTO {
            on.push(plane.project(&p));
        } else if (BESIDE[0]..BESIDE[1]).contains(&layers) {
            beside.push(p);
        }
    }
    on.retain(|p| wall.is_clear(p, grading.at(p)));
    let mut points = spaced_after(&on, &beside, grading);
    points.retain(|p| band.contains(p));
    Ok(points)
}
