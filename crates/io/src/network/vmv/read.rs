//! Reader of vertices and strands.

use crate::network::columns::Value;
use crate::network::content::{NetworkFile, NetworkOptions};
use crate::network::graph::{Graph, GraphFault, GraphPlace};
use crate::text::{TextFault, Words, shown};

/// Errors of a VMV file.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VmvError {
    /// A number is missing or invalid.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// A list is missing.
    #[error("the file has no line '{list}': is it a network of VessMorphoVis?")]
    NoList {
        /// First line of the list.
        list: &'static str,
    },
    /// A list does not end.
    #[error("the list that begins in line {line} has no line '{end}': is the file truncated?")]
    Endless {
        /// Line of the file, from 1.
        line: usize,
        /// Last line of the list.
        end: &'static str,
    },
    /// The graph is not a valid network.
    #[error(transparent)]
    Graph(#[from] GraphFault),
}

const VERTICES: [&str; 2] = ["$VERT_LIST_BEGIN", "$VERT_LIST_END"];
const STRANDS: [&str; 2] = ["$STRANDS_LIST_BEGIN", "$STRANDS_LIST_END"];

pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, VmvError> {
    let mut words = Words::new(bytes, true);
    let mut graph = Graph::default();
    let mut found = [false; 2];
    while let Some(word) = words.word() {
        if word == VERTICES[0].as_bytes() {
            found[0] = true;
            list(&mut words, VERTICES[1], &mut |words, first| vertex(&mut graph, words, first))?;
        } else if word == STRANDS[0].as_bytes() {
            found[1] = true;
            list(&mut words, STRANDS[1], &mut |words, _| strand(&mut graph, words))?;
        }
    }
    match found {
        [false, _] => Err(VmvError::NoList { list: VERTICES[0] }),
        [_, false] => Err(VmvError::NoList { list: STRANDS[0] }),
        _ => Ok(graph.into_network(options)?),
    }
}

/// Reader of a row after its first word.
type ReadRow<'a, 'b> = &'b mut dyn FnMut(&mut Words<'a>, &'a [u8]) -> Result<(), VmvError>;

/// Reads the rows of a list; the reader of a row gets its first word.
fn list<'a>(words: &mut Words<'a>, end: &'static str, row: ReadRow<'a, '_>) -> Result<(), VmvError> {
    let line = words.line();
    loop {
        match words.word() {
            Some(word) if word == end.as_bytes() => return Ok(()),
            Some(first) => row(words, first)?,
            None => return Err(VmvError::Endless { line, end }),
        }
    }
}

/// Reads a vertex: number, position, radius, and other attributes.
fn vertex(graph: &mut Graph, words: &mut Words, number: &[u8]) -> Result<(), VmvError> {
    let row = graph.node(&shown(number), GraphPlace::Line(words.line()))?;
    for name in ["x", "y", "z", "radius"] {
        let value = match name {
            "radius" => words.float_here("the radius")?,
            _ => words.finite_here("a coordinate")?,
        };
        graph.nodes.set(row, name, Value::Number(value));
    }
    while words.word_here().is_some() {}
    Ok(())
}

/// Reads a strand: its number, then its vertices.
fn strand(graph: &mut Graph, words: &mut Words) -> Result<(), VmvError> {
    let place = GraphPlace::Line(words.line());
    let mut last = shown(words.need_here("the vertices of the strand")?);
    while let Some(next) = words.word_here() {
        let next = shown(next);
        graph.edge([&last, &next], place)?;
        last = next;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const Y: &str = "$PARAM_BEGIN\n$NUM_VERTS 4\n$NUM_STRANDS 2\n$NUM_ATTRIBUTES_PER_VERT 5\n$PARAM_END\n\n\
                     $VERT_LIST_BEGIN\n1 0 0 0 1.5 0\n2 0 0 9 1.5 0\n3 0 4 18 1 0\n4 0 -4 18 0.5 0\n$VERT_LIST_END\n\
                     $STRANDS_LIST_BEGIN\n1 1 2 3\n2 2 4\n$STRANDS_LIST_END\n";

    fn parsed(text: &str) -> Result<NetworkFile, VmvError> {
        read(text.as_bytes(), &NetworkOptions::default())
    }

    #[test]
    fn strands_become_edges() {
        let file = parsed(Y).unwrap();
        let edges: Vec<[u32; 2]> = file.skeleton.edges.iter().map(|e| e.nodes.map(|n| n.0)).collect();
        assert_eq!(edges, [[0, 1], [1, 2], [1, 3]]);
        assert_eq!(file.skeleton.nodes.iter().map(|n| n.radius).collect::<Vec<_>>(), [1.5, 1.5, 1.0, 0.5]);
        assert_eq!(file.names.find("4", 4).map(|n| n.0), Some(3));
    }

    #[test]
    fn faults_are_named_with_their_lines() {
        assert_eq!(parsed("1 2 3\n"), Err(VmvError::NoList { list: VERTICES[0] }));
        let cut = &Y[..Y.len() - 20];
        assert_eq!(parsed(cut), Err(VmvError::Endless { line: 13, end: STRANDS[1] }));
        let unknown = Y.replace("2 2 4", "2 2 7");
        assert!(parsed(&unknown).unwrap_err().to_string().contains("line 15: an edge ends at the unknown node '7'"));
        let short = Y.replace("3 0 4 18 1 0", "3 0 4");
        assert!(parsed(&short).unwrap_err().to_string().contains("line 10"));
    }
}
