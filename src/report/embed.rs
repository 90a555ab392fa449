//! Report of an embedding: table of the pieces of vessels in the cells of the tissue, and their counts.

use super::rows::{Ended, row};
use super::summary::{of_check, of_mesh};
use anastomesh_domain::{Embedding, Pieces};
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::check::CheckReport;
use anastomesh_mesh::units::{counted, digits};
use anastomesh_skeleton::{NodeId, Skeleton};
use serde::Serialize;
use std::error::Error;

/// Columns. Edges, nodes and cells are those of the files. Parameters are 0 at the first node and 1 at the second; the radius
/// is that in the middle of the piece. Lengths are in the unit of the mesh.
const COLUMNS: [&str; 8] = ["edge", "first_node", "second_node", "cell", "start", "end", "length", "radius"];

/// Table with a row for each piece. `edges` are the numbers of the edges in the network file.
///
/// # Errors
/// The table cannot be created, which happens only if memory is insufficient.
pub fn table(pieces: &Pieces, network: &Skeleton, edges: &[u32], names: &NodeNames) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(COLUMNS)?;
    for of_edge in pieces.list.chunk_by(|a, b| a.edge == b.edge) {
        let edge = of_edge[0].edge;
        let tube = network.tube(edge);
        let nodes = network.edges[edge.index()].nodes.map(|node| names.of(NodeId(network.node(node).original)));
        let number = edges.get(edge.index()).copied().unwrap_or(edge.0).to_string();
        for piece in of_edge {
            let [start, end] = piece.ends;
            // Shortest form that is read back unchanged.
            let numbers = [start, end, piece.length, tube.radius(piece.middle())].map(|x| format!("{x:?}"));
            let cell = piece.tet.to_string();
            let words = [number.as_str(), &nodes[0], &nodes[1], &cell].into_iter();
            table.write_record(words.chain(numbers.iter().map(String::as_str)))?;
        }
    }
    Ok(table.into_inner()?)
}

/// Counts of an embedding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EmbedSummary {
    pub nodes: usize,
    pub edges: usize,
    /// Pieces of edges in cells.
    pub pieces: usize,
    /// Cells with a piece.
    pub cells: usize,
    /// Length of all vessels.
    pub length: f64,
}

impl EmbedSummary {
    pub fn of(made: &Embedding, network: &Skeleton) -> Self {
        let list = &made.pieces.list;
        let mut cells: Vec<u32> = list.iter().map(|piece| piece.tet).collect();
        cells.sort_unstable();
        cells.dedup();
        Self {
            nodes: network.nodes.len(),
            edges: network.edges.len(),
            pieces: list.len(),
            cells: cells.len(),
            length: list.iter().map(|piece| piece.length).sum(),
        }
    }

    /// Rows of the terminal summary.
    pub fn text(
        &self,
        check: &CheckReport,
        ended: &Ended,
        stages: &[crate::pipeline::StageTime],
        listed: bool,
    ) -> String {
        let Self { nodes, edges, pieces, cells, length } = self;
        let [pieces, cells] = [counted(*pieces, "piece"), counted(*cells, "cell")];
        row("network", &format!("{}, {}", counted(*nodes, "node"), counted(*edges, "edge")))
            + &of_mesh(check)
            + &row("embedded", &format!("{pieces} of edges in {cells}, total length {}", digits(*length)))
            + &ended.rows(stages)
            + &of_check(check, listed)
    }
}
