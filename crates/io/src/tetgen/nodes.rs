//! Point lists: `<count> <dimension> <attributes> <markers 0 or 1>`, then `<number> <x> <y> <z> <attributes> <marker>`.

use super::error::{TetgenFault, TetgenFileError};
use crate::file::{FileError, extension, read_bytes};
use crate::text::Words;
use anastomesh_mesh::geometry::Point3;
use std::path::Path;

/// Points of a `.node` file.
///
/// ```
/// let nodes = anastomesh_io::tetgen::Nodes::parse(b"2 3 0 0\n1 0 0 0\n2 1 0 0\n")?;
/// assert_eq!((nodes.points.len(), nodes.first), (2, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nodes {
    /// Positions.
    pub points: Vec<Point3>,
    /// Attributes of all points, point by point.
    pub attributes: Vec<f64>,
    /// Number of attributes per point.
    pub attribute_count: usize,
    /// Boundary marker of each point; empty if the file has none.
    pub markers: Vec<i32>,
    /// Number of the first point: 0 or 1.
    pub first: u32,
}

impl Nodes {
    /// Parses the bytes of a `.node` file.
    ///
    /// # Errors
    /// The bytes violate the format, are incomplete, or contain no points.
    pub fn parse(bytes: &[u8]) -> Result<Self, TetgenFault> {
        let mut words = Words::new(bytes, true);
        let nodes = parse(&mut words)?;
        words.expect_end()?;
        if nodes.points.is_empty() { Err(TetgenFault::NoPoints) } else { Ok(nodes) }
    }
}

/// Reads the points of a `.node` file.
///
/// # Errors
/// `UnknownFormat`, `Read` with the error of the operating system, `Empty`, or `Content` with the fault.
pub fn read_nodes(path: &Path) -> Result<Nodes, TetgenFileError> {
    if extension(path) != "node" {
        let path = path.to_path_buf();
        return Err(FileError::UnknownFormat { path, kind: "node", known: ".node" });
    }
    read_nodes_as(path)
}

/// Reads points like [`read_nodes`], with any extension.
///
/// # Errors
/// See [`read_nodes`].
pub fn read_nodes_as(path: &Path) -> Result<Nodes, TetgenFileError> {
    Nodes::parse(&read_bytes(path)?).map_err(FileError::content(path))
}

/// Parses the list, which may be empty.
pub(super) fn parse(words: &mut Words) -> Result<Nodes, TetgenFault> {
    // "0 0 0 0\n"
    let count = words.count("the count of points", 8)?;
    if let Some(word) = words.word_here() {
        let dimension = words.as_integer(word, "the dimension")?;
        if dimension != 3 {
            return Err(TetgenFault::Dimension { line: words.line(), dimension });
        }
    }
    let attribute_count = words.count_here("the count of attributes", 2)?;
    let marked = words.flag_here("the number of markers (0 or 1)")?;
    words.skip_line();
    let mut nodes = Nodes { points: Vec::with_capacity(count), attribute_count, ..Nodes::default() };
    for i in 0..count {
        let found = words.integer("the number of a point")?;
        if i == 0 && found == 1 {
            nodes.first = 1;
        }
        let expected = i as i64 + i64::from(nodes.first);
        if found != expected {
            return Err(TetgenFault::BadNumber { line: words.line(), found, expected });
        }
        nodes.points.push(words.point_here()?);
        for _ in 0..attribute_count {
            nodes.attributes.push(words.float_here("an attribute")?);
        }
        if marked {
            nodes.markers.push(words.marker_here("a marker")?);
        }
        words.skip_line();
    }
    Ok(nodes)
}
