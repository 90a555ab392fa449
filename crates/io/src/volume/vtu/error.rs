//! Errors of VTU files.

use crate::volume::content::SecondOrderFault;
use crate::vtk_xml::VtkError;

/// Errors of a tetrahedral mesh in a VTK unstructured grid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtuFault {
    /// The VTK XML file is invalid.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// Second-order cells are invalid.
    #[error(transparent)]
    SecondOrder(#[from] SecondOrderFault),
    /// A required element or array is missing.
    #[error("'{what}' is missing: is the file truncated?")]
    Missing {
        /// Name of the element or array.
        what: &'static str,
    },
    /// The length of an array is inconsistent with the others.
    #[error("array '{array}' has {found} values instead of {expected}: write or copy it again")]
    Length {
        /// Array name.
        array: String,
        /// Expected length.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// The cell offsets are inconsistent with the cell types.
    #[error("the number of points of cell {cell} does not match its type: correct its type or offsets")]
    BadOffset {
        /// The first such cell.
        cell: usize,
    },
    /// A cell is neither a tetrahedron nor a triangle.
    #[error("cell {cell} is of type {kind}; only tetrahedra and triangles of first or second order are supported")]
    UnsupportedCell {
        /// Cell type, as a number of the format.
        kind: i64,
        /// The first such cell.
        cell: usize,
    },
}
