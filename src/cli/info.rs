//! `anastomesh info`: properties of a network.

use super::common::print;
use super::exit::{Exit, Failure};
use super::hint;
use super::network::NetworkArgs;
use crate::report::info::NetworkInfo;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// Reads a network and prints its properties.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let network = args.network.read()?;
    let inlets = network.inlets()?;
    let notes = network.notes.iter().map(hint::of_note).collect();
    let mut info = NetworkInfo::new(&network.skeleton, network.cleaned, notes);
    info.inlets.clone_from(&inlets.list);
    print(args.json, &info, || format!("{info}{}", inlets.remarks().join("\n")))?;
    Ok(Exit::Fine)
}
