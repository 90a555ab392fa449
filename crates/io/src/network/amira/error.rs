//! What can be wrong with a spatial graph.

use crate::network::radii::RadiusFault;
use crate::text::TextFault;

/// Why an Amira file is no usable network.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AmiraError {
    /// The first line is not that of an Amira file.
    #[error("the first line is not '# AmiraMesh …' or '# Avizo …': is it an Amira spatial graph?")]
    NotAmira,
    /// The file is binary.
    #[error("the first line says that the data are binary: save the graph as 'Amira ASCII Spatial Graph'")]
    Binary,
    /// A number or word is missing or wrong.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// A declaration cannot be understood.
    #[error("line {line}: a declaration such as 'VERTEX {{ float[3] VertexCoordinates }} @1' is needed: correct it")]
    BadDeclaration {
        /// Line of the file, from 1.
        line: usize,
    },
    /// A section of data is declared nowhere.
    #[error("line {line}: the data '{mark}' are declared nowhere: correct the declarations at the head")]
    Undeclared {
        /// Line of the file, from 1.
        line: usize,
        /// Mark of the data section.
        mark: String,
    },
    /// Something that every spatial graph has is missing.
    #[error("there is no {what} in the file: is it a spatial graph (HxSpatialGraph)?")]
    Missing {
        /// Missing or wrong item.
        what: &'static str,
    },
    /// The edges have together another number of points than there are.
    #[error("edges have {found} points together, but {expected} are there: correct NumEdgePoints")]
    PointsDiffer {
        /// The number of points.
        expected: usize,
        /// The sum over edges.
        found: usize,
    },
    /// An edge names a vertex that does not exist.
    #[error("edge {edge} (from 0) names vertex {vertex}, but there are only {vertices} vertices (from 0): correct it")]
    UnknownVertex {
        /// Edge, from 0.
        edge: usize,
        /// What it names.
        vertex: i64,
        /// Number of vertices.
        vertices: usize,
    },
    /// No array can be taken for the radius.
    #[error(transparent)]
    Radius(#[from] RadiusFault),
    /// There are more points than can be numbered.
    #[error("there are more points than can be numbered ({})", u32::MAX)]
    TooMany,
}
