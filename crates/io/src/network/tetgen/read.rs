//! Reader of points and edges.

use crate::network::content::{NetworkFile, NetworkOptions, NodeNames};
use crate::network::polylines::{Polylines, Radii};
use crate::network::radii::{Choice, RadiusFault};
use crate::tetgen::{Nodes, TetgenFault};
use crate::text::{TextFault, Words, from_first};
use std::path::{Path, PathBuf};

/// Errors of a network in TetGen's files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EdgeFileError {
    /// The points are invalid.
    #[error("points: {0}")]
    Points(#[from] TetgenFault),
    /// A number of the edges is missing or invalid.
    #[error("edges: {0}")]
    Edges(#[from] TextFault),
    /// An edge refers to a missing point.
    #[error("edges: line {line} refers to point {point}, but the points have numbers {first} to {last}: correct it")]
    UnknownPoint {
        /// Line of the edges, from 1.
        line: usize,
        /// Number found.
        point: i64,
        /// Number of the first point.
        first: u32,
        /// Number of the last point.
        last: u64,
    },
    /// There are no edges.
    #[error("edges: the file has none: a network needs vessels")]
    NoEdges,
    /// No attribute is usable as radius.
    #[error(transparent)]
    Radius(#[from] RadiusFault),
    /// The number of nodes or edges exceeds the index range.
    #[error("too many points for 32-bit indices ({})", u32::MAX)]
    TooMany,
}

/// Paths of the points and of the edges.
pub(in crate::network) fn files(path: &Path) -> [PathBuf; 2] {
    ["node", "edge"].map(|extension| path.with_extension(extension))
}

/// Reads a network. A single attribute of the points is the radius; of several, the option `radius_array` selects one by
/// its name `attribute_1`, `attribute_2`, …
pub(in crate::network) fn read(
    nodes: &[u8],
    edges: &[u8],
    options: &NetworkOptions,
) -> Result<NetworkFile, EdgeFileError> {
    let nodes = Nodes::parse(nodes)?;
    let names: Vec<String> = match nodes.attribute_count {
        1 => vec!["radius".into()],
        count => (1..=count).map(|i| format!("attribute_{i}")).collect(),
    };
    let choice = Choice::of(&names, &[], options)?;
    let column = choice.points.as_ref().and_then(|name| names.iter().position(|n| n == name));
    let of_nodes = column.map(|at| {
        let values = nodes.attributes.iter().skip(at).step_by(nodes.attribute_count).copied().collect();
        choice.radii(&names[at], values)
    });
    let path = read_edges(edges, &nodes)?;
    let first = i64::from(nodes.first);
    let ids = (first..first + nodes.points.len() as i64).collect();
    let polylines = Polylines { ends: (1..=path.len() / 2).map(|i| 2 * i).collect(), points: nodes.points, path };
    let mut network = NetworkFile { notes: choice.notes(), names: NodeNames::Ids(ids), ..NetworkFile::default() };
    if !polylines.fits(&network.skeleton) {
        return Err(EdgeFileError::TooMany);
    }
    polylines.append_to(&mut network.skeleton, &Radii { nodes: of_nodes, ..Radii::default() });
    Ok(network)
}

/// Reads edges: the count and the number of markers, then number, two points, and markers.
fn read_edges(bytes: &[u8], nodes: &Nodes) -> Result<Vec<u32>, EdgeFileError> {
    let mut words = Words::new(bytes, true);
    let count = words.count("the count of edges", 6)?;
    words.skip_line();
    let mut path = Vec::with_capacity(2 * count);
    for _ in 0..count {
        words.integer("the number of an edge")?;
        for _ in 0..2 {
            let word = words.need_here("two points of the edge")?;
            let point = words.as_integer(word, "a point")?;
            let (line, last) = (words.line(), u64::from(nodes.first) + nodes.points.len() as u64 - 1);
            let unknown = || EdgeFileError::UnknownPoint { line, point, first: nodes.first, last };
            path.push(from_first(point, nodes.first, nodes.points.len()).ok_or_else(unknown)?);
        }
        words.skip_line();
    }
    words.expect_end()?;
    if path.is_empty() { Err(EdgeFileError::NoEdges) } else { Ok(path) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: &str = "3 3 1 0\n1 0 0 0 1.5\n2 0 0 9 1.25\n3 0 4 18 1\n";
    const EDGES: &str = "# by hand\n2 1\n1 1 2 -1\n2 2 3 0\n";

    fn parsed(nodes: &str, edges: &str, options: &NetworkOptions) -> Result<NetworkFile, EdgeFileError> {
        read(nodes.as_bytes(), edges.as_bytes(), options)
    }

    #[test]
    fn points_and_edges_are_a_network() {
        let file = parsed(NODES, EDGES, &NetworkOptions::default()).unwrap();
        let edges: Vec<[u32; 2]> = file.skeleton.edges.iter().map(|e| e.nodes.map(|n| n.0)).collect();
        assert_eq!(edges, [[0, 1], [1, 2]]);
        assert_eq!(file.skeleton.nodes.iter().map(|n| n.radius).collect::<Vec<_>>(), [1.5, 1.25, 1.0]);
        assert_eq!(file.names.find("3", 3).map(|n| n.0), Some(2));
    }

    #[test]
    fn one_of_several_attributes_is_chosen() {
        let nodes = "2 3 2 0\n0 0 0 0 7 1.5\n1 0 0 9 7 1.25\n";
        let options = NetworkOptions::default().radius_array("attribute_2".to_owned());
        let file = parsed(nodes, "1 0\n0 0 1\n", &options).unwrap();
        assert_eq!(file.skeleton.nodes[1].radius, 1.25);
        let refused = parsed(nodes, "1 0\n0 0 1\n", &NetworkOptions::default()).unwrap_err();
        assert!(refused.to_string().contains("attribute_1, attribute_2"), "{refused}");
    }

    #[test]
    fn faults_are_named_with_their_lines() {
        let fault = |edges: &str| parsed(NODES, edges, &NetworkOptions::default()).unwrap_err().to_string();
        assert!(fault("1 0\n1 1 4\n").contains("line 2 refers to point 4, but the points have numbers 1 to 3"));
        assert!(fault("0 0\n").contains("the file has none"));
        assert!(fault("2 0\n1 1 2\n").contains("line"));
    }
}
