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
    #[error("line {line}: a declaration such as 'VERTEX {{ float[3] VertexCoordinates }} @1' is needed: correct it")]
    BadDeclaration {
        /// Line of the file, from 1.
        line: usize,
    },
    /// A data section has no declaration.
    #[error("line {line}: the data '{mark}' are declared nowhere: correct the declarations at the head")]
    Undeclared {
        /// Line of the file, from 1.
        line: usize,
        /// Mark of the data section.
        mark: String,
    },
    /// A required section of a spatial graph is missing.
    #[error("there is no {what} in the file: is it a spatial graph (HxSpatialGraph)?")]
    Missing {
        /// Missing or wrong item.
        what: &'static str,
    },
    /// The total point count of the edges differs from the number of points.
    #[error("edges have {found} points together, but {expected} are there: correct NumEdgePoints")]
    PointsDiffer {
        /// Number of points.
        expected: usize,
        /// Sum over the edges.
        found: usize,
    },
    /// An edge refers to a missing vertex.
    #[error("edge {edge} (from 0) names vertex {vertex}, but there are only {vertices} vertices (from 0): correct it")]
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
    #[error("there are more points than can be numbered ({})", u32::MAX)]
    TooMany,
}
