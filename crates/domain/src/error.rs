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
    /// A part of the mesh cannot be read or stored.
    #[error("the regions cannot be stored: {0}")]
    Io(#[from] std::io::Error),
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
    #[error("{} outside the surface around the tissue, first node {node} at {}: give a surface around all vessels", lie(*count, "node"), place(*at))]
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
    /// The margin of a box is within the shells.
    #[error(
        "no space for tissue: the margin {margin} of the box is within the shells, whose thickness is up to {thickness}: give a wider margin"
    )]
    NoSpace {
        /// Margin.
        margin: f64,
        /// Largest thickness of all shells together.
        thickness: f64,
    },
    /// The margin of a hull is too small for its triangles.
    #[error("the margin {margin} of the hull is too small for the extent of the vessels: give at least {least:.2e}")]
    Margin {
        /// Margin.
        margin: f64,
        /// Minimum.
        least: f64,
    },
    /// The hull of the vessels cannot be made.
    #[error("the hull of the vessels cannot be made: {0}")]
    Hull(TetError),
    /// Surfaces cannot be remeshed.
    #[error("the surfaces of the tissue cannot be remeshed: {0}")]
    Remesh(TetError),
    /// The surface of a region in the tissue is not closed, or intersects itself.
    #[error("the surface of {region} cannot be filled: {source}")]
    Region {
        /// Name of the region.
        region: String,
        /// Reason.
        source: TetError,
    },
    /// A region reaches out of the organ.
    #[error(
        "in {region}, {} outside the surface around the tissue, first at {}: give a region inside, or a larger surface",
        lie(*count, "point"), place(*at)
    )]
    RegionOutside {
        /// Name of the region.
        region: String,
        /// Number of points outside.
        count: usize,
        /// The first.
        at: [f64; 3],
    },
    /// Two surfaces in the tissue touch.
    #[error(
        "the surfaces of {} and {} meet at {}, first at {}: give surfaces that do not touch",
        regions[0], regions[1], counted(*count, "triangle"), place(*at)
    )]
    SurfacesMeet {
        /// Names of the regions.
        regions: [String; 2],
        /// Number of triangles of the second.
        count: usize,
        /// Place of the first.
        at: [f64; 3],
    },
    /// Vessels of the network cross a surface in the tissue.
    #[error(
        "{} through the surface of {region}, first between nodes {} and {} at {}: {}",
        pass(*count), nodes[0], nodes[1], place(*at),
        if *is_organ { "shorten the vessels, or give a surface around all of them" } else { "move the surface, so that each vessel lies inside or outside" }
    )]
    VesselsCross {
        /// Name of the region inside the surface.
        region: String,
        /// True for the surface around the tissue.
        is_organ: bool,
        /// Number of edges of the network.
        count: usize,
        /// Names of the ends of the first in the file.
        nodes: [String; 2],
        /// Place on the surface.
        at: [f64; 3],
    },
    /// The vessels' wall meets the surface of a region.
    #[error(
        "{} of the vessels' wall meet the surface of {region}, first at {}: move the surface, so that each vessel lies inside or outside",
        counted(*count, "triangle"), place(*at)
    )]
    VesselsMeet {
        /// Name of the region.
        region: String,
        /// Number of triangles of the wall.
        count: usize,
        /// Place of the first.
        at: [f64; 3],
    },
    /// All vessels lie outside the organ.
    #[error(
        "no vessel lies inside the surface around the tissue: give the surface in the unit of the network, and at its place"
    )]
    NoVesselInside,
    /// The organ cannot be opened where a vessel leaves.
    #[error("the surface around the tissue cannot be opened for the vessel at {}: {fault}", place(*at))]
    Gate {
        /// Place.
        at: [f64; 3],
        /// Reason.
        fault: GateFault,
    },
    /// The tissue cannot be filled.
    #[error("the tissue could not be filled: {0}")]
    Tissue(TetError),
    /// The vessels cannot be divided between the cells of the tissue.
    #[error(transparent)]
    Pieces(#[from] PiecesError),
}

/// Reason why an organ cannot be opened where a vessel leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GateFault {
    /// No vessel ends there.
    #[error("its end was moved; let the vessel end inside")]
    NoEnd,
    /// The surface is too far from the end.
    #[error("it ends far from the surface; let it end inside")]
    Far,
    /// The vessel leaves at a small angle to the surface.
    #[error("it leaves at a small angle; let it end inside")]
    Flat,
    /// The surface is too rough there.
    #[error("the surface is too rough there; smooth it, or let the vessel end inside")]
    Rim,
    /// Another vessel leaves beside it.
    #[error("another vessel leaves beside it; let one of them end inside")]
    Close,
}

fn lie(count: usize, what: &str) -> String {
    format!("{} {}", counted(count, what), if count == 1 { "lies" } else { "lie" })
}

fn pass(count: usize) -> String {
    format!("{} {}", counted(count, "vessel"), if count == 1 { "passes" } else { "pass" })
}

fn leave(count: usize) -> String {
    format!("{} leave{}", counted(count, "edge"), if count == 1 { "s" } else { "" })
}

impl DomainError {
    /// True if the caller cancelled the run.
    pub fn is_cancelled(&self) -> bool {
        match self {
            Self::Shell { source, .. }
            | Self::Region { source, .. }
            | Self::Organ(source)
            | Self::Hull(source)
            | Self::Remesh(source)
            | Self::Tissue(source) => *source == TetError::Cancelled,
            Self::Io(source) => anastomesh_mesh::progress::Cancelled::is_in(source),
            Self::Pieces(source) => *source == PiecesError::Cancelled,
            _ => false,
        }
    }
}
