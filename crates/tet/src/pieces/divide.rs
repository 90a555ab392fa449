//! Division of a filled region by an interface: faces of a tetrahedralization of the points near a plane.
//!
//! The interface keeps the region's surface, so that both halves are closed surfaces that can be filled independently.

use super::band::Band;
use super::interface::{Cut, Interface};
use super::plane::{Plane, planes};
use super::points::points_along;
use super::sides::Sides;
use crate::builder::Tetrahedralizer;
use crate::error::TetError;
use crate::options::Interior;
use crate::plc::InputKind;
use crate::progress::Watch;
use crate::sized::tree_options;
use anastomesh_mesh::TriMesh;

/// Maximum planes that are tried.
const PLANES: usize = 6;

/// Minimum angles between faces at an interface, in radians, that are asked for in turn.
const LEAST_ANGLES: [f64; 2] = [0.2, 0.0];

/// Divides the region inside a closed surface that is oriented outwards. `None` if no plane can be used.
///
/// # Errors
/// [`TetError::Cancelled`].
pub(super) fn divide(by: &Tetrahedralizer, surface: &TriMesh, watch: &Watch) -> Result<Option<Cut>, TetError> {
    for least in LEAST_ANGLES {
        for plane in planes(surface).into_iter().take(PLANES) {
            match cut(by, surface, (plane, least), watch) {
                Err(error) if error.is_stop() => return Err(error),
                Ok(Some(cut)) => return Ok(Some(cut)),
                // The surface is difficult near this plane.
                Ok(None) | Err(_) => {}
            }
        }
    }
    Ok(None)
}

/// Divides a region near a plane.
fn cut(
    by: &Tetrahedralizer,
    surface: &TriMesh,
    (plane, least): (Plane, f64),
    watch: &Watch,
) -> Result<Option<Cut>, TetError> {
    let (interior, sizing) = by.spacing();
    let band = Band::of(surface, plane, tree_options(interior, sizing).slope);
    let points = points_along(by, &band, plane, watch)?;
    // Improvement would move points off the plane.
    let fill = Tetrahedralizer::new().kind(InputKind::Plc).interior(Interior::Points(points)).optimize(false);
    let mesh = fill.run_watched((&band.boxed).into(), watch)?.mesh;
    let sides = Sides::of(&mesh, &band, plane);
    Ok(sides.and_then(|sides| Interface { mesh: &mesh, band: &band, surface, plane, sides }.cut(least)))
}
