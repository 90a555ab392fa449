//! `anastomesh info`: what a network holds.

use super::exit::{Exit, Failure};
use super::network::NetworkArgs;
use crate::report::info::NetworkInfo;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Reads a network and prints what it holds.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let network = args.network.read()?;
    if !args.json {
        for remark in network.remarks() {
            eprintln!("{remark}");
        }
    }
    let info = NetworkInfo::of(&network.skeleton);
    super::print(args.json, &info, || info.text())?;
    Ok(Exit::Fine)
}
