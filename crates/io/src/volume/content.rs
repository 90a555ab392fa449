//! Contents of a mesh file besides the mesh.

use crate::flow::Flow;
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::region::{NamedRegion, has_interfaces, label_faces};
use anastomesh_mesh::second_order::{QuadraticMesh, SecondOrder};
use anastomesh_mesh::{Patch, TetMesh, VolumeMesh};
use std::borrow::Cow;

/// Additional information in a mesh file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshNotes {
    /// Expected results of a check.
    pub expectation: Option<Expectation>,
    /// Program and version that created the mesh.
    pub generator: String,
    /// Options of the program run.
    pub options: String,
    /// Regions of the mesh, ascending by id; the blocks of its tetrahedra are their ids. Empty if the blocks are no regions.
    pub regions: Vec<NamedRegion>,
    /// Flow through the mesh, for formats that are solver cases.
    pub flow: Option<Flow>,
}

impl MeshNotes {
    /// Flow through the mesh; the default is creeping blood flow.
    pub(super) fn flow_of(&self, patches: &[Patch]) -> Cow<'_, Flow> {
        self.flow.as_ref().map_or_else(|| Cow::Owned(Flow::usual(patches)), Cow::Borrowed)
    }
}

/// Mesh from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// Mesh; boundary and patches are empty if the file has no boundary labels.
    pub volume: VolumeMesh,
    /// True if the file has boundary labels.
    pub labelled: bool,
    /// Midpoints of a second-order mesh; `volume` then is the mesh of its corners.
    pub second_order: Option<SecondOrder>,
    /// Additional information of the file.
    pub notes: MeshNotes,
}

/// Mesh from a format without notes. Its blocks are regions if it has a label between two of them.
impl From<VolumeMesh> for MeshFile {
    fn from(mut volume: VolumeMesh) -> Self {
        let mut notes = MeshNotes::default();
        if has_interfaces(&volume) {
            notes.regions = NamedRegion::all_numbered(volume.tet_block.iter().copied());
            label_faces(&mut volume);
        }
        Self { labelled: !volume.boundary.is_empty(), volume, second_order: None, notes }
    }
}

/// Errors of a file with second-order cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SecondOrderFault {
    /// Some cells are of second order, and others are not.
    #[error("the file has linear and second-order cells: write it with one order")]
    MixedOrders,
    /// A cell refers to a missing node.
    #[error("a second-order cell names a point that does not exist: is the file truncated?")]
    MissingNode,
}

/// Cells of a mesh whose nodes include midpoints. `volume` holds the nodes as points, and the same cells with their corners. Replaces
/// these by the corners alone.
///
/// # Errors
/// The mesh has further cells, or a node is missing.
pub(super) fn separate_midpoints(
    volume: &mut VolumeMesh,
    tets: Vec<[u32; 10]>,
    faces: Vec<[u32; 6]>,
) -> Result<Option<SecondOrder>, SecondOrderFault> {
    if tets.is_empty() && faces.is_empty() {
        return Ok(None);
    }
    if (tets.len(), faces.len()) != (volume.mesh.tets.len(), volume.boundary.len()) {
        return Err(SecondOrderFault::MixedOrders);
    }
    let whole = QuadraticMesh { points: std::mem::take(&mut volume.mesh.points), tets, faces };
    let parts = whole.parts().ok_or(SecondOrderFault::MissingNode)?;
    volume.mesh = TetMesh { points: parts.points, tets: parts.tets };
    volume.boundary = parts.faces;
    Ok(Some(parts.second))
}
