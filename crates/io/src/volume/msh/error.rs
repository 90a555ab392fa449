//! Errors of MSH files.

use crate::volume::content::SecondOrderFault;

/// Errors of a tetrahedral mesh in Gmsh's MSH 4.1 or 2.2.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MshFault {
    /// Second-order elements are invalid.
    #[error(transparent)]
    SecondOrder(#[from] SecondOrderFault),
    /// A required section is missing.
    #[error("'{what}' is missing: is the file truncated?")]
    Missing {
        /// Name of the section.
        what: &'static str,
    },
    /// The file is truncated.
    #[error("the file ends too early: it was not written or copied completely; write or copy it again")]
    CutShort,
    /// A number or name is invalid.
    #[error("invalid number or name before byte {byte}: is the file truncated?")]
    BadNumber {
        /// Byte offset.
        byte: usize,
    },
    /// Two nodes have an equal tag.
    #[error("duplicate node tag {tag}: tags must differ")]
    RepeatedTag {
        /// Tag that was found.
        tag: u64,
    },
    /// The format version is not supported.
    #[error("format version {version} is not supported; Gmsh writes 4.1 with -format msh41")]
    UnsupportedVersion {
        /// Version that was found.
        version: String,
    },
    /// An element is neither a tetrahedron nor a triangle.
    #[error("cell {cell} is of type {kind}; only tetrahedra and triangles of first or second order are supported")]
    UnsupportedCell {
        /// Element type, as a number of the format.
        kind: i64,
        /// The first such element.
        cell: usize,
    },
}
