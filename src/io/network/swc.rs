//! SWC: one node a row (id, type, x, y, z, radius, parent), in any order, with any ids.

use super::NetworkFile;
use crate::geometry::Point3;
use crate::skeleton::{Edge, LARGEST, Node, NodeId, Skeleton};
use rustc_hash::FxHashMap;

/// Why an SWC file could not be understood. Lines are numbered from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SwcError {
    /// A row has too few columns.
    #[error("line {line} has {found} columns; a row of an SWC file has seven: id, type, x, y, z, radius, parent")]
    TooFewColumns {
        /// The line.
        line: usize,
        /// How many columns it has.
        found: usize,
    },
    /// A column holds no number.
    #[error("line {line}: the {column} is '{text}', not a number; columns are id, type, x, y, z, radius, parent")]
    NotANumber {
        /// The line.
        line: usize,
        /// The column.
        column: &'static str,
        /// What is there.
        text: String,
    },
    /// A coordinate is infinite or not a number, or too large to be computed with.
    #[error(
        "line {line}: node {id} has the {column} {value}; coordinates must be finite and below {LARGEST:e}: correct it"
    )]
    BadCoordinate {
        /// The line.
        line: usize,
        /// The node's id.
        id: i64,
        /// The column.
        column: &'static str,
        /// What is there.
        value: f64,
    },
    /// A radius is zero, negative, infinite or not a number.
    #[error(
        "line {line}: node {id} has the radius {radius}; radii must be finite and above zero: give it the radius of its vessel"
    )]
    BadRadius {
        /// The line.
        line: usize,
        /// The node's id.
        id: i64,
        /// What is there.
        radius: f64,
    },
    /// Two rows have one id.
    #[error("line {line}: node {id} was given in line {first} already; ids must differ")]
    RepeatedId {
        /// The line.
        line: usize,
        /// The id.
        id: i64,
        /// The line that had it first.
        first: usize,
    },
    /// A node is its own parent.
    #[error("line {line}: node {id} is its own parent; a root has the parent -1")]
    SelfParent {
        /// The line.
        line: usize,
        /// The node's id.
        id: i64,
    },
    /// A node's parent does not exist.
    #[error("line {line}: node {id} has the parent {parent}, which is in no row; a root has the parent -1")]
    UnknownParent {
        /// The line.
        line: usize,
        /// The node's id.
        id: i64,
        /// Its parent.
        parent: i64,
    },
    /// There are only comments.
    #[error("there is no row with a node in it; is it an SWC file?")]
    NoNodes,
}

struct Row {
    line: usize,
    id: i64,
    parent: i64,
}

/// Parses a file.
pub(super) fn parse(bytes: &[u8]) -> Result<NetworkFile, SwcError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // Files from old Macs end their lines by a carriage return alone.
    let newline = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    let mut rows: Vec<Row> = Vec::new();
    let mut nodes: Vec<Node> = Vec::new();
    let mut index: FxHashMap<i64, u32> = FxHashMap::default();
    for (i, content) in bytes.split(|&b| b == newline).enumerate() {
        let text = String::from_utf8_lossy(content);
        let data = text.split('#').next().unwrap_or_default();
        if data.trim().is_empty() {
            continue;
        }
        let (row, mut node) = parse_row(i + 1, data)?;
        node.original = nodes.len() as u32;
        if let Some(before) = index.insert(row.id, node.original) {
            return Err(SwcError::RepeatedId { line: row.line, id: row.id, first: rows[before as usize].line });
        }
        rows.push(row);
        nodes.push(node);
    }
    if nodes.is_empty() {
        return Err(SwcError::NoNodes);
    }
    let edges = join_parents(&rows, &nodes, &index)?;
    Ok(NetworkFile { skeleton: Skeleton { nodes, edges }, notes: Vec::new() })
}

fn join_parents(rows: &[Row], nodes: &[Node], index: &FxHashMap<i64, u32>) -> Result<Vec<Edge>, SwcError> {
    let mut edges = Vec::with_capacity(rows.len());
    for (child, &Row { line, id, parent }) in rows.iter().enumerate() {
        if parent == id {
            return Err(SwcError::SelfParent { line, id });
        }
        match index.get(&parent) {
            Some(&up) => edges.push(Edge {
                nodes: [NodeId(up), NodeId(child as u32)],
                radii: [nodes[up as usize].radius, nodes[child].radius],
            }),
            None if parent == -1 => {}
            None => return Err(SwcError::UnknownParent { line, id, parent }),
        }
    }
    Ok(edges)
}

fn parse_row(line: usize, data: &str) -> Result<(Row, Node), SwcError> {
    let mut words = [""; 7];
    let mut found = 0;
    // More columns than seven are legal; they hold other properties.
    for (slot, word) in words.iter_mut().zip(data.split_ascii_whitespace()) {
        *slot = word;
        found += 1;
    }
    if found < 7 {
        return Err(SwcError::TooFewColumns { line, found });
    }
    let id = integer(line, "id", words[0])?;
    number(line, "type", words[1])?;
    let mut position = Point3::origin();
    for (axis, column) in ["x", "y", "z"].into_iter().enumerate() {
        let value = number(line, column, words[2 + axis])?;
        if value.is_nan() || value.abs() >= LARGEST {
            return Err(SwcError::BadCoordinate { line, id, column, value });
        }
        position[axis] = value;
    }
    let radius = number(line, "radius", words[5])?;
    if radius.is_nan() || radius <= 0.0 || radius >= LARGEST {
        return Err(SwcError::BadRadius { line, id, radius });
    }
    let parent = integer(line, "parent", words[6])?;
    Ok((Row { line, id, parent }, Node { position, radius, original: 0 }))
}

fn not_a_number(line: usize, column: &'static str, text: &str) -> SwcError {
    SwcError::NotANumber { line, column, text: text.chars().take(40).collect() }
}

fn number(line: usize, column: &'static str, text: &str) -> Result<f64, SwcError> {
    text.parse().map_err(|_| not_a_number(line, column, text))
}

/// Some programs write ids as `1.0`.
fn integer(line: usize, column: &'static str, text: &str) -> Result<i64, SwcError> {
    if let Ok(value) = text.parse() {
        return Ok(value);
    }
    let value = number(line, column, text)?;
    if value.fract() == 0.0 && value.abs() < 1e15 { Ok(value as i64) } else { Err(not_a_number(line, column, text)) }
}
