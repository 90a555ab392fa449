//! What can be wrong with a mesh in pieces.

use crate::volume::vtu::VtuFault;
use crate::vtk_xml::VtkError;

/// Why files are no mesh in pieces.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PvtuFault {
    /// The index is no sound VTK XML file.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// A piece is no mesh.
    #[error(transparent)]
    Piece(#[from] VtuFault),
    /// Something that every index has is not there.
    #[error("'{what}' is missing: was it written completely?")]
    Missing {
        /// Name of the element or attribute.
        what: &'static str,
    },
    /// Two pieces say of a point that they share that it is elsewhere.
    #[error("the pieces have different positions for the point {id}: they are not of one mesh; write them again")]
    PointsDiffer {
        /// Its global id.
        id: i64,
    },
}
