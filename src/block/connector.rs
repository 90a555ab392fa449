//! One connector: the tube between two end surfaces, filled (3.2.3).

use super::connector_surface::{ConnectorEnd, ConnectorSurface, Division, EndVertex, connector_surface};
use super::error::BlockError;
use super::error::{ConnectorAttempt, ConnectorFailure};
use super::free_ends::FreeEnds;
use super::params::{BlockParams, filling};
use super::template::{self, FilledTube};
use crate::mesh::{TetMesh, TriMesh};
use crate::partition::{Cut, CutId};
use crate::tet::tetrahedralize;

/// A meshed connector.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectorMesh {
    /// Points and tetrahedra; no tetrahedra with [`BlockParams::hollow`]. The first points are those of `shared`, bit for
    /// bit.
    pub mesh: TetMesh,
    /// The closed surface, with [`BlockParams::hollow`]; else empty.
    pub hull: Vec<[u32; 3]>,
    /// For each of the first points, which vertex of which cluster it is: side 0's, then side 1's.
    pub shared: Vec<EndVertex>,
    /// Rings between the two rims.
    pub rings: u32,
    /// Attempts that failed before this one.
    pub failed: Vec<ConnectorAttempt>,
}

/// Number of ways in which a connector's tube is divided.
pub const DIVISIONS: usize = 5;

/// Divisions in the order in which they are tried.
const IN_ORDER: [Division; DIVISIONS] =
    [Division::Rings(1.0), Division::Rings(0.75), Division::Rings(1.35), Division::Rings(0.5), Division::Direct];

/// Meshes one connector from side 0's end surface to side 1's.
///
/// # Errors
/// [`BlockError::Connector`] with every attempt, or a parameter out of range.
pub fn mesh_connector(
    id: CutId,
    cut: &Cut,
    ends: [ConnectorEnd; 2],
    params: &BlockParams,
) -> Result<ConnectorMesh, BlockError> {
    params.check()?;
    let mut failed = Vec::new();
    let mut tried: Vec<u32> = Vec::new();
    for division in IN_ORDER.into_iter().skip(params.first_division) {
        let failure = match connector_surface(&cut.path, ends, division) {
            // Where there is little room, several divisions come down to the same rings.
            Ok(surface) if tried.contains(&surface.rings) => continue,
            Ok(surface) => {
                tried.push(surface.rings);
                if params.hollow {
                    return Ok(hollow(surface, failed));
                }
                match tetrahedralize(&surface.surface, &filling(&surface.surface)) {
                    Ok(mesh) => return Ok(filled(surface, mesh, failed)),
                    Err(e) => ConnectorFailure::Tetrahedra(e),
                }
            }
            Err(e) => ConnectorFailure::Surface(e),
        };
        failed.push(ConnectorAttempt { division, failure });
    }
    let at = cut.path.get(cut.path.len() / 2).map_or([f64::NAN; 3], |s| s.origin.coords.into());
    Err(BlockError::Connector { cut: id, at, attempts: failed })
}

/// Meshes one connector between the two discs that the vessel alone gives; no cluster is needed. `shared` counts the
/// discs' vertices. By template where the vessel lets it.
///
/// # Errors
/// As [`mesh_connector`].
pub fn mesh_free_connector(id: CutId, cut: &Cut, params: &BlockParams) -> Result<ConnectorMesh, BlockError> {
    params.check()?;
    let failed = |fault| BlockError::Connector {
        cut: id,
        at: cut.path.first().map_or([f64::NAN; 3], |s| s.origin.coords.into()),
        attempts: vec![ConnectorAttempt { division: IN_ORDER[0], failure: ConnectorFailure::Surface(fault) }],
    };
    let ends = FreeEnds::new(id, cut, params).map_err(failed)?;
    if params.by_template()
        && let Some(tube) = template::tube(&cut.path, &ends.discs, [false; 2], params)
    {
        return Ok(image(tube, params.hollow));
    }
    mesh_connector(id, cut, ends.both(), params)
}

/// A connector by template.
fn image(tube: FilledTube, hollow: bool) -> ConnectorMesh {
    let ends = |side| (0..tube.disc).map(move |vertex| EndVertex { side, vertex });
    let shared = ends(0).chain(ends(1)).collect();
    let rings = tube.rings;
    let (mesh, hull) = tube.kept(hollow);
    ConnectorMesh { mesh, hull, shared, rings, failed: Vec::new() }
}

fn filled(surface: ConnectorSurface, mesh: TetMesh, failed: Vec<ConnectorAttempt>) -> ConnectorMesh {
    ConnectorMesh { mesh, hull: Vec::new(), shared: surface.shared, rings: surface.rings, failed }
}

fn hollow(surface: ConnectorSurface, failed: Vec<ConnectorAttempt>) -> ConnectorMesh {
    let ConnectorSurface { surface: TriMesh { points, triangles }, shared, rings, .. } = surface;
    ConnectorMesh { mesh: TetMesh { points, tets: Vec::new() }, hull: triangles, shared, rings, failed }
}
