//! Errors of node and edge tables.

use crate::network::graph::GraphFault;

/// Identifies one of the two tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// Node table.
    Nodes,
    /// Edge table.
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

/// Errors of tables.
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
        /// Fault of the row.
        what: String,
    },
    /// One of the two tables is missing.
    #[error(
        "only one table: give nodes and edges in two files named with 'nodes' (or 'vertices') and 'edges', \
         or in one file separated by an empty line"
    )]
    OneTable,
    /// The columns with the ends of edges are missing.
    #[error(
        "no columns for the ends of edges (source and target, from and to, node1id and node2id, start and end); \
         columns: {}",
        available.join(", ")
    )]
    NoEnds {
        /// Column names found.
        available: Vec<String>,
    },
    /// The tables are not a valid network.
    #[error(transparent)]
    Graph(#[from] GraphFault),
}
