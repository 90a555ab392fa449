//! Reader of vertices, arcs and edges.

use crate::network::columns::Value;
use crate::network::content::{NetworkFile, NetworkOptions};
use crate::network::graph::{Graph, GraphFault, GraphPlace};

/// Errors of a Pajek file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PajekError {
    /// There is no vertex section.
    #[error("the file has no line '*Vertices': is it a Pajek network?")]
    NoVertices,
    /// The section type is not supported, such as a matrix.
    #[error("line {line}: the section '{section}' is not supported: save vertices, arcs and edges as lists")]
    UnknownSection {
        /// Line of the file, from 1.
        line: usize,
        /// Section.
        section: String,
    },
    /// A line has too few numbers.
    #[error("line {line}: an edge needs two vertex numbers: complete it")]
    TooShort {
        /// Line of the file, from 1.
        line: usize,
    },
    /// The graph is not a valid network.
    #[error(transparent)]
    Graph(#[from] GraphFault),
}

/// Section of the current line.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Before,
    Vertices,
    /// Two vertices and the value of the line per row.
    Edges,
    /// A vertex and all its neighbours per row.
    Lists,
}

pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, PajekError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut graph = Graph::default();
    let mut section = Section::Before;
    for (i, content) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = i + 1;
        let text = String::from_utf8_lossy(content);
        let text = text.trim();
        if text.is_empty() || text.starts_with('%') {
            continue;
        }
        let words = words(text);
        if text.starts_with('*') {
            section = section_of(words[0], line)?;
            continue;
        }
        match section {
            Section::Before => return Err(PajekError::NoVertices),
            Section::Vertices => vertex(&mut graph, &words, line)?,
            Section::Edges => {
                let [from, to] = ends(&words, line)?;
                let row = graph.edge([from, to], GraphPlace::Line(line))?;
                let value = words.get(2).map(|value| ("value", Value::of(value)));
                for (name, value) in value.into_iter().chain(pairs(words.get(3..).unwrap_or_default())) {
                    graph.edges.set(row, name, value);
                }
            }
            Section::Lists => {
                ends(&words, line)?;
                for to in &words[1..] {
                    graph.edge([words[0], to], GraphPlace::Line(line))?;
                }
            }
        }
    }
    if section == Section::Before {
        return Err(PajekError::NoVertices);
    }
    Ok(graph.into_network(options)?)
}

fn section_of(word: &str, line: usize) -> Result<Section, PajekError> {
    match word.to_ascii_lowercase().as_str() {
        "*network" => Ok(Section::Before),
        "*vertices" => Ok(Section::Vertices),
        "*arcs" | "*edges" => Ok(Section::Edges),
        "*arcslist" | "*edgeslist" => Ok(Section::Lists),
        other => Err(PajekError::UnknownSection { line, section: other.chars().take(40).collect() }),
    }
}

/// Parses a vertex: number, label, coordinates, optional shape, then name-value parameters.
fn vertex(graph: &mut Graph, words: &[&str], line: usize) -> Result<(), PajekError> {
    let row = graph.node(words[0], GraphPlace::Line(line))?;
    let rest = words.get(2..).unwrap_or_default();
    let coordinates = rest.iter().take(3).map_while(|w| w.parse::<f64>().ok());
    let mut found = 0;
    for (name, coordinate) in ["x", "y", "z"].into_iter().zip(coordinates) {
        graph.nodes.set(row, name, Value::Number(coordinate));
        found += 1;
    }
    let rest = &rest[found..];
    // Parameters are pairs, so an odd leading word is a shape.
    for (name, value) in pairs(&rest[rest.len() % 2..]) {
        graph.nodes.set(row, name, value);
    }
    Ok(())
}

fn ends<'a>(words: &'a [&str], line: usize) -> Result<[&'a str; 2], PajekError> {
    match words {
        [from, to, ..] => Ok([from, to]),
        _ => Err(PajekError::TooShort { line }),
    }
}

/// Pairs of names and values.
fn pairs<'a>(words: &'a [&str]) -> impl Iterator<Item = (&'a str, Value)> {
    words.as_chunks::<2>().0.iter().map(|[name, value]| (*name, Value::of(value)))
}

/// Words of a line; quoted words may contain spaces.
fn words(text: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let (word, after) = match rest.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"').unwrap_or((quoted, "")),
            None => rest.split_once(char::is_whitespace).unwrap_or((rest, "")),
        };
        words.push(word);
        rest = after.trim_start();
    }
    words
}
