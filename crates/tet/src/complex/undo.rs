//! Undo log of a complex: the former content of all that changes. Going back costs as much as the changes, however
//! large the complex is.

use super::cell::Cell;
use anastomesh_mesh::geometry::Point3;

/// Former content of one place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Change {
    /// A slot, with its frozen faces.
    Slot(u32, Cell, u8),
    /// A slot was added.
    SlotAdded,
    /// A slot was put on the list of free ones.
    Freed,
    /// A slot was taken from the list of free ones.
    Taken(u32),
    /// Tetrahedron of a vertex.
    VertexTet(u32, u32),
    /// Position of a vertex.
    Position(u32, Point3),
    PointAdded,
    PointRemoved(Point3, u32),
}

/// Changes since [`Complex::record`](super::Complex::record).
#[derive(Clone, Debug, Default)]
pub(super) struct UndoLog {
    pub(super) changes: Vec<Change>,
    pub(super) recording: bool,
}
