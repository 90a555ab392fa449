//! `TetGen`'s text formats, as its manual describes them (version 1.5, section 5): points (`.node`), piecewise linear
//! complexes (`.poly`, `.smesh`), and the family of files of a tetrahedral mesh (`.node`, `.ele`, `.face`, `.edge`,
//! `.neigh`).

mod node;
mod poly;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use node::Nodes;
pub use poly::{Facet, Plc, PlcFormat, Region};
pub use read::{read_mesh, read_mesh_from};
pub use write::{Extent, MeshFamily};

use super::file_error::{FileError, extension, read_bytes};
use super::text::{TextFault, Words};
use std::path::Path;

/// Why a file of `TetGen`'s could not be read or written.
pub type TetgenFileError = FileError<TetgenFault>;

/// Why the content of a file is not what `TetGen`'s format asks for. Facets are numbered as points are, from
/// 0 or 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TetgenFault {
    /// Its words are not those of the format.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// Points are not in space.
    #[error("line {line}: the points have the dimension {dimension}; it has to be 3")]
    Dimension {
        /// The line.
        line: usize,
        /// The dimension.
        dimension: i64,
    },
    /// The numbers of the points do not run on from 0 or 1.
    #[error(
        "line {line}: the point has the number {found} instead of {expected}; points are numbered from 0 or from 1"
    )]
    BadNumber {
        /// The line.
        line: usize,
        /// Its number.
        found: i64,
        /// The number it had to have.
        expected: i64,
    },
    /// A polygon names a point that does not exist.
    #[error("line {line}: facet {facet} names the point {index}, but there are {points} points, the first is {first}")]
    BadIndex {
        /// The line.
        line: usize,
        /// The facet.
        facet: usize,
        /// What it names.
        index: i64,
        /// How many points there are.
        points: usize,
        /// Number of the first point.
        first: u32,
    },
    /// A polygon has no corners, or a facet no polygons.
    #[error("line {line}: facet {facet} has nothing in it: remove it")]
    EmptyFacet {
        /// The line.
        line: usize,
        /// The facet.
        facet: usize,
    },
    /// A tetrahedron or face of a mesh names a point that does not exist.
    #[error("line {line}: {kind} {cell} names the point {index}, but there are {points} points, the first is {first}")]
    BadCell {
        /// The line.
        line: usize,
        /// What names it.
        kind: &'static str,
        /// Its number, from 0.
        cell: usize,
        /// What it names.
        index: i64,
        /// How many points there are.
        points: usize,
        /// Number of the first point.
        first: u32,
    },
    /// Tetrahedra have more points than their corners.
    #[error("line {line}: tetrahedra have {corners} points; only those of 4 are read: write the mesh without -o2")]
    Order {
        /// The line.
        line: usize,
        /// How many points they have.
        corners: i64,
    },
    /// There are no points, neither here nor in the file beside.
    #[error("there are no points in it")]
    NoPoints,
}

/// Reads the points of a `.node` file.
///
/// # Errors
/// `UnknownFormat`, `Read` with the system's reason, `Empty`, or `Content` with what is wrong.
pub fn read_nodes(path: &Path) -> Result<Nodes, TetgenFileError> {
    if extension(path) != "node" {
        return Err(FileError::UnknownFormat { path: path.to_path_buf(), known: ".node" });
    }
    read_nodes_as(path)
}

/// As [`read_nodes`], whatever the extension.
///
/// # Errors
/// As [`read_nodes`].
pub fn read_nodes_as(path: &Path) -> Result<Nodes, TetgenFileError> {
    let bytes = read_bytes(path)?;
    Nodes::parse(&bytes).map_err(|fault| FileError::Content { path: path.to_path_buf(), fault })
}

/// Reads a piecewise linear complex from a `.poly` or `.smesh` file. When it says that there are no points, they are
/// read from the `.node` file beside it.
///
/// # Errors
/// As [`read_nodes`].
pub fn read_plc(path: &Path) -> Result<Plc, TetgenFileError> {
    let format = match extension(path).as_str() {
        "poly" => PlcFormat::Poly,
        "smesh" => PlcFormat::Smesh,
        _ => return Err(FileError::UnknownFormat { path: path.to_path_buf(), known: ".poly, .smesh" }),
    };
    read_plc_as(path, format)
}

/// As [`read_plc`], in this format whatever the extension.
///
/// # Errors
/// As [`read_nodes`].
pub fn read_plc_as(path: &Path, format: PlcFormat) -> Result<Plc, TetgenFileError> {
    let content = |fault| FileError::Content { path: path.to_path_buf(), fault };
    let bytes = read_bytes(path)?;
    let mut words = Words::new(&bytes, true);
    let mut nodes = node::parse(&mut words).map_err(content)?;
    let points_beside = nodes.points.is_empty();
    if points_beside {
        nodes = read_nodes(&path.with_extension("node"))?;
    }
    let plc = poly::parse(&mut words, nodes, format).map_err(content)?;
    Ok(Plc { points_beside, ..plc })
}
