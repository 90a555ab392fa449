//! Meshing of a connector: the filled tube between two end surfaces (section 3.2.3 of the paper).

use super::connector_surface::{ConnectorEnd, ConnectorSurface, Division, EndVertex, connector_surface};
use super::error::BlockError;
use super::error::{ConnectorAttempt, ConnectorFailure};
use super::free_ends::FreeEnds;
use super::layered::{ThinLayers, Walled, discs_first, renumbered};
use super::params::{BlockParams, filling};
use super::template::{self, FilledTube};
use super::topology::Topology;
use crate::partition::{Cut, CutId};
use anastomesh_mesh::geometry::Section;
use anastomesh_mesh::{TetMesh, TriMesh};
use anastomesh_tet::TetError;
use anastomesh_tet::parts::{Inset, Watch, fill_outward};
use std::sync::Arc;

/// Mesh of a connector.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectorMesh {
    /// Points and tetrahedra; no tetrahedra with [`BlockParams::hollow`]. The first points are those of `shared`, bit
    /// for bit.
    pub mesh: TetMesh,
    /// Closed surface with [`BlockParams::hollow`], else empty.
    pub hull: Vec<[u32; 3]>,
    /// Cluster vertex of each of the first points: side 0's, then side 1's.
    pub shared: Vec<EndVertex>,
    /// Number of rings between the two rims.
    pub rings: u32,
    /// Report of layers that are thinner than requested.
    pub thin: Option<ThinLayers>,
    /// Failed attempts before this one.
    pub failed: Vec<ConnectorAttempt>,
    /// Topology of an image of a template.
    pub(crate) topology: Option<Arc<Topology>>,
}

/// Number of divisions of a connector's tube to try.
pub const DIVISIONS: usize = 5;

/// Divisions in the order of attempts.
const IN_ORDER: [Division; DIVISIONS] =
    [Division::Rings(1.0), Division::Rings(0.75), Division::Rings(1.35), Division::Rings(0.5), Division::Direct];

/// Meshes a connector from side 0's end surface to side 1's.
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
            // In short connectors several divisions give equal ring counts.
            Ok(surface) if tried.contains(&surface.rings) => continue,
            Ok(surface) => {
                tried.push(surface.rings);
                if params.hollow {
                    return Ok(hollow(surface, failed));
                }
                match filled(surface, &cut.path, params) {
                    Ok(mesh) => return Ok(ConnectorMesh { failed, ..mesh }),
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

/// Meshes a connector between the shared discs of the vessel, without clusters; by template if possible. `shared`
/// refers to vertices of the discs.
///
/// # Errors
/// See [`mesh_connector`].
pub fn mesh_free_connector(id: CutId, cut: &Cut, params: &BlockParams) -> Result<ConnectorMesh, BlockError> {
    params.check()?;
    let failed = |fault| BlockError::Connector {
        cut: id,
        at: cut.path.first().map_or([f64::NAN; 3], |s| s.origin.coords.into()),
        attempts: vec![ConnectorAttempt { division: IN_ORDER[0], failure: ConnectorFailure::Surface(fault) }],
    };
    let free = |params| FreeEnds::new(id, cut, params).map_err(failed);
    let ends = free(params)?;
    if params.by_template()
        && let Some(tube) = template::tube(&cut.path, &ends.discs, [false; 2], params)
    {
        return Ok(image(tube, params.hollow));
    }
    // Layers are added during filling.
    let plain = if params.layers.is_some() { free(&BlockParams { layers: None, ..*params })? } else { ends };
    mesh_connector(id, cut, plain.both(), params)
}

/// Converts a template tube to a connector.
fn image(tube: FilledTube, hollow: bool) -> ConnectorMesh {
    let shared = sides([tube.disc; 2]).collect();
    let rings = tube.rings;
    let topology = (!hollow).then(|| Arc::clone(&tube.topology));
    let (mesh, hull) = tube.kept(hollow);
    ConnectorMesh { mesh, hull, shared, rings, thin: None, failed: Vec::new(), topology }
}

/// Fills the tube of a connector along a path.
fn filled(tube: ConnectorSurface, path: &[Section], params: &BlockParams) -> Result<ConnectorMesh, TetError> {
    let fill = |surface: &TriMesh| fill_outward(&filling(surface, params.core), surface, &Watch::NOBODY);
    let ConnectorSurface { surface, shared, end_triangles, rings } = tube;
    let (hull, failed) = (Vec::new(), Vec::new());
    let Some(layers) = &params.layers else {
        return Ok(ConnectorMesh { mesh: fill(&surface)?, hull, shared, rings, thin: None, failed, topology: None });
    };
    let centres = [path.first(), path.last()].map(|section| section.map(|s| s.origin));
    let cap = |(i, triangle): (u32, &[u32; 3])| {
        let side = shared.get(triangle[0] as usize).filter(|_| i < end_triangles)?.side;
        centres[usize::from(side)]
    };
    let caps = (0..).zip(&surface.triangles).map(cap).collect();
    let axes = path.windows(2).map(|pair| [pair[0].origin, pair[1].origin]).collect();
    let (Inset { mesh, numbers, .. }, thin) = Walled { surface: &surface, caps, axes }.fill(layers, fill)?;
    let first = shared.partition_point(|v| v.side == 0) as u32;
    let plain = [0..first, first..shared.len() as u32];
    let (counts, renamed) = discs_first(&numbers, plain, layers.count, mesh.points.len());
    let shared = sides(counts).collect();
    let mesh = renumbered(mesh, &renamed);
    Ok(ConnectorMesh { mesh, hull, shared, rings, thin, failed, topology: None })
}

/// Points of two discs, one after the other.
fn sides(counts: [u32; 2]) -> impl Iterator<Item = EndVertex> {
    [0, 1].into_iter().zip(counts).flat_map(|(side, count)| (0..count).map(move |vertex| EndVertex { side, vertex }))
}

fn hollow(surface: ConnectorSurface, failed: Vec<ConnectorAttempt>) -> ConnectorMesh {
    let ConnectorSurface { surface: TriMesh { points, triangles }, shared, rings, .. } = surface;
    let mesh = TetMesh { points, tets: Vec::new() };
    ConnectorMesh { mesh, hull: triangles, shared, rings, thin: None, failed, topology: None }
}
