//! `anastomesh dual`: a second tree that shares the terminals of the first.

use std::path::PathBuf;

use serde::Serialize;

use super::common::{ended, print};
use super::exit::{Exit, Failure};
use super::log;
use super::network::NetworkArgs;
use crate::report::rows::row;
use anastomesh_io::network::{NetworkArray, ensure_network_writable, write_network};
use anastomesh_mesh::units::counted;
use anastomesh_network::dual;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Output file with both trees: .vtp with the arrays `OriginalNode` and `Tree` (0 first tree, 1 second tree, 2 shared
    /// terminals)
    #[arg(short, long, value_name = "NETWORK")]
    output: PathBuf,
    /// Print the report as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Report of the growth.
#[derive(Serialize)]
struct GrownDual {
    nodes: usize,
    edges: usize,
    shared_terminals: usize,
    /// Roots of the second tree: indices of the points in the output.
    roots: Vec<u32>,
}

/// Grows the second tree and writes both.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    ensure_network_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    let network = args.network.read()?;
    if !args.quiet {
        for remark in network.remarks() {
            log::note(&remark);
        }
    }
    let both = dual(&network.skeleton);
    let grown = GrownDual {
        nodes: both.skeleton.nodes.len(),
        edges: both.skeleton.edges.len(),
        shared_terminals: both.tree.iter().filter(|t| **t == 2).count(),
        roots: both.roots.iter().map(|n| n.0).collect(),
    };
    let originals = both.skeleton.nodes.iter().map(|n| n.original).collect();
    let arrays = [NetworkArray::NodeInts("OriginalNode", originals), NetworkArray::NodeInts("Tree", both.tree)];
    write_network(&args.output, &both.skeleton, &arrays).map_err(|e| Failure::input(e.to_string()))?;
    if args.json {
        print(true, &grown, String::new)?;
    } else if !args.quiet {
        let counts = [(grown.nodes, "node"), (grown.edges, "edge"), (grown.shared_terminals, "shared terminal")];
        let network = row("network", &counts.map(|(count, what)| counted(count, what)).join(", "));
        let ended = ended(&[&args.output]).rows(&[]);
        log::result(&format!("{network}{ended}the two trees overlap: `anastomesh refine` moves them apart"));
    }
    Ok(Exit::Fine)
}
