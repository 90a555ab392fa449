//! What can be wrong with tables of nodes and edges.

use crate::network::graph::GraphFault;

/// Which of the two tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// That of nodes.
    Nodes,
    /// That of edges.
    Edges,
}

impl std::fmt::Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Nodes => "table of nodes",
            Self::Edges => "table of edges",
        })
    }
}

/// Why tables are no usable network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CsvError {
    /// A row cannot be read.
    #[error("line {line}, {table}: {what}; correct the row")]
    Row {
        /// Line of the file, from 1.
        line: usize,

        /// Table.
        table: Table,
        /// What is wrong with it.
        what: String,
    },
    /// There is one table where two are needed.
    #[error(
        "one table alone: nodes and edges are needed, in two files whose names differ by 'nodes' (or 'vertices') and \
         'edges', or in one file with an empty line between them"
    )]
    OneTable,
    /// The edges name no nodes.
    #[error(
        "no two columns say where edges begin and end (source and target, from and to, node1id and node2id, start and \
         end); there are: {}",
        available.join(", ")
    )]
    NoEnds {
        /// The columns there are.
        available: Vec<String>,
    },
    /// The tables are no network.
    #[error(transparent)]
    Graph(#[from] GraphFault),
}
