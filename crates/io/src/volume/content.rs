//! Contents of a mesh file besides the mesh.

use crate::flow::Flow;
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::region::{NamedRegion, has_interfaces, label_faces};
use anastomesh_mesh::{Patch, VolumeMesh};
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
        Self { labelled: !volume.boundary.is_empty(), volume, notes }
    }
}
