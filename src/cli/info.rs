//! `anastomesh info`: properties of a network.

use super::common::print;
use super::exit::{Exit, Failure};
use super::hint;
use super::network::{NetworkArgs, PreparedNetwork};
use crate::report::info::NetworkInfo;
use crate::report::inlets;
use anastomesh_flow::Inlets;
use anastomesh_network::PrepareParams;
use anastomesh_skeleton::NodeId;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// Reads a network and prints its properties. Missing radii are filled as `mesh` does.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let PreparedNetwork { skeleton, names, roots, notes, report, .. } =
        args.network.prepared(&PrepareParams::as_is().radii(true))?;
    let inlets = Inlets::of(&skeleton, &names, &roots, &[]).map_err(|e| Failure::input(e.to_string()))?;
    let notes = notes.iter().map(hint::of_note).collect();
    let mut info = NetworkInfo::new(&skeleton, report.cleaned, notes);
    info.inlets.clone_from(&inlets.list);
    info.nodes_without_radius = report.radii.len();
    info.unit = args.network.units.map(|units| units.names()[1].to_owned());
    let name = |node| names.of(NodeId(skeleton.node(NodeId(node)).original));
    print(args.json, &info, || format!("{}{}", info.text(&name), inlets::remarks(&inlets).join("\n")))?;
    Ok(Exit::Fine)
}
