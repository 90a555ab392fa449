//! What can be wrong with a VTU file.

use crate::vtk_xml::VtkError;

/// Why a file is no tetrahedral mesh as VTK's unstructured grid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtuFault {
    /// It is no sound VTK XML file.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// Something that every such file has is not there.
    #[error("'{what}' is missing: was it written completely?")]
    Missing {
        /// Name of the element or array.
        what: &'static str,
    },
    /// An array is as long as the others do not say.
    #[error("array '{array}' has {found} values instead of {expected}: write or copy it again")]
    Length {
        /// Its name.
        array: String,
        /// How long it had to be.
        expected: usize,
        /// How long it is.
        found: usize,
    },
    /// The offsets of the cells do not ascend by their sizes.
    #[error("cell {cell} has another number of points than its type: correct its type or its offsets")]
    BadOffset {
        /// The first such cell.
        cell: usize,
    },
    /// There are cells that are neither tetrahedra nor triangles.
    #[error("cell {cell} is of type {kind}; only linear tetrahedra and triangles are supported")]
    UnsupportedCell {
        /// Type of the cell, in the numbers of the format.
        kind: i64,
        /// The first such cell.
        cell: usize,
    },
}
