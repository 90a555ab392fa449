//! Errors of the regions around a lumen.

use super::embed::PiecesError;
use super::plan::DomainPlanError;
use anastomesh_mesh::units::{counted, place};
use anastomesh_tet::TetError;

/// Reason why there are no regions around a lumen.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// The plan is invalid.
    #[error(transparent)]
    Plan(#[from] DomainPlanError),
    /// No shell fits at a place.
    #[error("no space for {shells} at {}: {source}", place(*at))]
    Shell {
        /// Names of the shells.
        shells: String,
        /// Place on the wall.
        at: [f64; 3],
        /// Reason.
        source: TetError,
    },
    /// The organ's surface is not closed.
    #[error("the surface around the tissue cannot be filled: {0}")]
    Organ(TetError),
    /// Nodes of the network lie outside the organ's surface.
    #[error("{} outside the surface around the tissue, first node {node} at {}: give a surface around all vessels", lie(*count), place(*at))]
    NodesOutside {
        /// Number of nodes.
        count: usize,
        /// Name of the first in the file.
        node: String,
        /// Its place.
        at: [f64; 3],
    },
    /// Edges of the network leave the organ's surface.
    #[error(
        "{} the surface around the tissue, first edge {}-{} at {}: give a surface around all vessels",
        leave(*count), ends[0], ends[1], place(*at)
    )]
    EdgesOutside {
        /// Number of edges.
        count: usize,
        /// Names of the ends of the first in the file.
        ends: [String; 2],
        /// Place of the triangle where it leaves.
        at: [f64; 3],
    },
    /// Vessels intersect the organ's surface, or lie outside.
    #[error(
        "{} of the vessels' wall {} the surface around the tissue, first at {}: give a surface around all vessels",
        counted(*count, "triangle"), if *outside { "lie outside" } else { "intersect" }, place(*at)
    )]
    VesselsOutside {
        /// Number of triangles of the wall.
        count: usize,
        /// True if they lie outside, false if they intersect the surface.
        outside: bool,
        /// Place of the first.
        at: [f64; 3],
    },
    /// The tissue cannot be filled.
    #[error("the tissue could not be filled: {0}")]
    Tissue(TetError),
    /// The vessels cannot be divided between the cells of the tissue.
    #[error(transparent)]
    Pieces(#[from] PiecesError),
}

fn lie(count: usize) -> String {
    format!("{} lie{}", counted(count, "node"), if count == 1 { "s" } else { "" })
}

fn leave(count: usize) -> String {
    format!("{} leave{}", counted(count, "edge"), if count == 1 { "s" } else { "" })
}

impl DomainError {
    /// True if the caller cancelled the run.
    pub fn is_cancelled(&self) -> bool {
        match self {
            Self::Shell { source, .. } | Self::Organ(source) | Self::Tissue(source) => *source == TetError::Cancelled,
            Self::Pieces(source) => *source == PiecesError::Cancelled,
            _ => false,
        }
    }
}
