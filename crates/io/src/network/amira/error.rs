//! Errors of spatial graphs.

use crate::network::radii::RadiusFault;
use crate::text::TextFault;

/// Errors of an Amira file.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AmiraError {
    /// The first line does not identify an Amira file.
    #[error("the first line is not '# AmiraMesh …' or '# Avizo …': is it an Amira spatial graph?")]
    NotAmira,
    /// The file is binary.
    #[error("the first line says that the data are binary: save the graph as 'Amira ASCII Spatial Graph'")]
    Binary,
    /// A number or word is missing or invalid.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// A declaration is malformed.
    #[error("line {line}: expected a declaration such as 'VERTEX {{ float[3] VertexCoordinates }} @1': correct it")]
    BadDeclaration {
        /// Line of the file, from 1.
        line: usize,
    },
    /// A data section has no declaration.
    #[error("line {line}: the data '{mark}' have no declaration: correct the header")]
    Undeclared {
        /// Line of the file, from 1.
        line: usize,
        /// Mark of the data section.
        mark: String,
    },
    /// A required section of a spatial graph is missing.
    #[error("the file has no {what}: is it a spatial graph (HxSpatialGraph)?")]
    Missing {
        /// Missing or wrong item.
        what: &'static str,
    },
    /// The total point count of the edges differs from the number of points.
    #[error("edges have {found} points in total, but the file has {expected}: correct NumEdgePoints")]
    PointsDiffer {
        /// Number of points.
        expected: usize,
        /// Sum over the edges.
        found: usize,
    },
    /// An edge refers to a missing vertex.
    #[error(
        "edge {edge} (from 0) refers to vertex {vertex} (from 0), but the file has {vertices} vertices: correct it"
    )]
    UnknownVertex {
        /// Edge, from 0.
        edge: usize,
        /// Invalid vertex index.
        vertex: i64,
        /// Number of vertices.
        vertices: usize,
    },
    /// No array is usable as radius.
    #[error(transparent)]
    Radius(#[from] RadiusFault),
    /// The number of points exceeds the index range.
    #[error("too many points for 32-bit indices ({})", u32::MAX)]
    TooMany,
}
