//! Reader of node rows, in any order and with any ids.

use super::error::SwcError;
use crate::network::content::{NetworkFile, NetworkOptions, NodeNames};
use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::{Edge, LARGEST, Node, NodeId, Skeleton, is_usable_radius};
use rustc_hash::FxHashMap;

struct Row {
    line: usize,
    id: i64,
    parent: i64,
}

pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, SwcError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // Files from classic Mac OS end their lines with a carriage return only.
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
        let (row, mut node) = parse_row(i + 1, data, options)?;
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
    // An isolated node is not a root.
    let mut joined = vec![false; nodes.len()];
    edges.iter().flat_map(|edge| edge.nodes).for_each(|node| joined[node.index()] = true);
    let roots = (0..nodes.len() as u32).map(NodeId).filter(|n| rows[n.index()].parent == -1 && joined[n.index()]);
    Ok(NetworkFile {
        roots: roots.collect(),
        names: NodeNames::Ids(rows.iter().map(|row| row.id).collect()),
        skeleton: Skeleton { nodes, edges },
        ..NetworkFile::default()
    })
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

fn parse_row(line: usize, data: &str, options: &NetworkOptions) -> Result<(Row, Node), SwcError> {
    let mut words = [""; 7];
    let mut found = 0;
    // More than seven columns are allowed; they hold other properties.
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
    let usable = is_usable_radius(radius);
    if !usable && !options.any_radii {
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

/// Parses an integer id, which some programs write as `1.0`.
fn integer(line: usize, column: &'static str, text: &str) -> Result<i64, SwcError> {
    if let Ok(value) = text.parse() {
        return Ok(value);
    }
    let value = number(line, column, text)?;
    if value.fract() == 0.0 && value.abs() < 1e15 { Ok(value as i64) } else { Err(not_a_number(line, column, text)) }
}
