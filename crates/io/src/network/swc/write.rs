//! Writer of trees as node rows, each with its parent.

use anastomesh_skeleton::{NodeId, Skeleton};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Buffer size of the writer, in bytes.
const CHUNK: usize = 1 << 20;

/// Writes a tree, given the parent of each node.
pub(in crate::network) fn write(out: &mut impl Write, tree: &Skeleton, parents: &[Option<NodeId>]) -> io::Result<()> {
    let mut rows = String::from("# id type x y z radius parent\n");
    for (id, (node, parent)) in (1..).zip(tree.nodes.iter().zip(parents)) {
        let [x, y, z]: [f64; 3] = node.position.into();
        let parent = parent.map_or(-1, |p| i64::from(p.0) + 1);
        // Writing to a string cannot fail. Type 0 means undefined.
        let _ = writeln!(rows, "{id} 0 {x} {y} {z} {} {parent}", node.radius);
        if rows.len() > CHUNK {
            out.write_all(rows.as_bytes())?;
            rows.clear();
        }
    }
    out.write_all(rows.as_bytes())
}

/// Parent of each node; the error is a node with several incoming edges, which is not a tree.
pub(in crate::network) fn parents(tree: &Skeleton) -> Result<Vec<Option<NodeId>>, NodeId> {
    let mut parents = vec![None; tree.nodes.len()];
    for edge in &tree.edges {
        let [from, to] = edge.nodes;
        if parents[to.index()].replace(from).is_some() {
            return Err(to);
        }
    }
    Ok(parents)
}
