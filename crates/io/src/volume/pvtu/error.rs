//! Errors of meshes in pieces.

use crate::volume::vtu::VtuFault;
use crate::vtk_xml::VtkError;

/// Errors of a mesh in pieces.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PvtuFault {
    /// The index is an invalid VTK XML file.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// A piece is invalid.
    #[error(transparent)]
    Piece(#[from] VtuFault),
    /// A required element or attribute is missing.
    #[error("'{what}' is missing: is the file truncated?")]
    Missing {
        /// Name of the element or attribute.
        what: &'static str,
    },
    /// Two pieces have different positions for a shared point.
    #[error("the pieces have different positions of point {id}: they belong to different meshes; write them again")]
    PointsDiffer {
        /// Global id.
        id: i64,
    },
}
