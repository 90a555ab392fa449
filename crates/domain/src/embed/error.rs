//! Errors of the division of vessels between cells.

use anastomesh_mesh::units::place;

/// Reason why vessels cannot be divided between the cells of a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PiecesError {
    /// A vessel leaves the mesh.
    #[error("edge {edge} leaves the tissue at {}: give a surface around all vessels", place(*at))]
    Outside {
        /// Index of the edge.
        edge: u32,
        /// Last place inside, or the node outside.
        at: [f64; 3],
    },
    /// The tetrahedra overlap, or one of them is inverted.
    #[error("the tetrahedra at edge {edge} are not valid: check the mesh of the tissue")]
    Mesh {
        /// Index of the edge.
        edge: u32,
    },
    /// The caller cancelled the run.
    #[error("cancelled")]
    Cancelled,
}

/// Violation of an invariant of pieces.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PieceFault {
    /// The pieces of an edge leave a gap, overlap, or do not reach an end.
    #[error("the pieces of edge {edge} do not cover it at {at}")]
    Cover {
        /// Index of the edge.
        edge: u32,
        /// Parameter along the edge.
        at: f64,
    },
    /// The middle of a piece lies outside its cell.
    #[error("piece {piece} lies outside its cell")]
    Cell {
        /// Index of the piece.
        piece: usize,
    },
    /// The lengths of the pieces do not add up to that of their edge.
    #[error("the pieces of edge {edge} have the length {found} instead of {expected}")]
    Length {
        /// Index of the edge.
        edge: u32,
        /// Sum of their lengths.
        found: f64,
        /// Length of the edge.
        expected: f64,
    },
}
