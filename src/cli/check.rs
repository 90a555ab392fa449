//! `anastomesh check`: a volume mesh verified line by line.

use std::path::PathBuf;

use super::exit::{Exit, Failure};
use crate::io::mesh_file::read_mesh;
use crate::mesh::check::{Verdict, check_tets, check_volume};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The mesh: VTU, MSH 4.1, Medit .mesh, or TetGen's .ele
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Checks a mesh file and prints the result of every line.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let file = read_mesh(&args.mesh).map_err(|e| Failure::input(e.to_string()))?;
    let expectation = file.notes.expectation.as_ref();
    let report = if file.labelled {
        check_volume(&file.volume, expectation)
    } else {
        check_tets(&file.volume.mesh, expectation)
    };
    super::print(args.json, &report, || crate::report::check::text(&report))?;
    Ok(if report.verdict == Verdict::Invalid { Exit::GateNotMet } else { Exit::Fine })
}
