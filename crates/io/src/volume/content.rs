//! What a mesh file holds beside the mesh.

use super::conditions::Flow;
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::{Patch, VolumeMesh};
use std::borrow::Cow;

/// What a mesh file says beside the mesh itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshNotes {
    /// What a check has to find.
    pub expectation: Option<Expectation>,
    /// The program that made the mesh and its version.
    pub generator: String,
    /// The options it was made with.
    pub options: String,
    /// Whether the blocks of the tetrahedra are regions, which a format that groups cells is to keep apart.
    pub regions: bool,
    /// What flows through the mesh, for formats that are cases of a solver.
    pub flow: Option<Flow>,
}

impl MeshNotes {
    /// What flows through the mesh; where nobody has said, blood that creeps.
    pub(super) fn flow_of(&self, patches: &[Patch]) -> Cow<'_, Flow> {
        self.flow.as_ref().map_or_else(|| Cow::Owned(Flow::usual(patches)), Cow::Borrowed)
    }
}

/// A mesh as it was read from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// The mesh. Boundary and patches are empty when the file labels no boundary.
    pub volume: VolumeMesh,
    /// Whether the file labels a boundary.
    pub labelled: bool,
    /// What else the file says.
    pub notes: MeshNotes,
}

/// A mesh from a format that has no place for notes.
impl From<VolumeMesh> for MeshFile {
    fn from(volume: VolumeMesh) -> Self {
        let labelled = !volume.boundary.is_empty();
        Self { volume, labelled, notes: MeshNotes::default() }
    }
}
