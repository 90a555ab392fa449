//! `anastomesh replay`: repeats a failed block from its dump.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::common::{Common, ended};
use super::exit::{Exit, Failure};
use super::hint;
use super::limits::size;
use super::log;
use super::progress::Bars;
use super::stop::{NOTHING_KEPT, Stop};
use crate::block::{BlockDump, BlockError, Finished};
use crate::pipeline::{Estimate, TooLarge, replay};
use crate::report::rows::row;
use anastomesh_io::volume::{MeshNotes, ensure_writable, write_mesh};
use anastomesh_mesh::quality::TetQuality;
use anastomesh_mesh::units::{counted, tetrahedra};
use anastomesh_tet::parts::Watch;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Dump of a failed block: a file of the folder MESH.failed, which `mesh` writes
    #[arg(value_name = "DUMP.json")]
    dump: PathBuf,
    /// Output file for the mesh of the block: .vtu, .pvtu, .msh, .msh2, .mesh, or .ele
    #[arg(short, long, value_name = "MESH")]
    output: Option<PathBuf>,
    /// Memory limit, such as 2GiB or 500MB
    #[arg(long, value_name = "SIZE", default_value = "2GiB", value_parser = size)]
    memory: u64,
    #[command(flatten)]
    common: Common,
}

/// Output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    /// Program that wrote the dump.
    written_by: &'a str,
    block: String,
    nodes: &'a [u32],
    /// Failure; `None` if the block was meshed.
    failed: Option<Failed>,
    mesh: Option<ReplayedMesh>,
}

/// Stage and reason of the failure.
#[derive(Serialize)]
struct Failed {
    stage: &'static str,
    reason: String,
}

/// Mesh of the block.
#[derive(Serialize)]
struct ReplayedMesh {
    points: usize,
    tets: usize,
    quality: TetQuality,
    file: Option<String>,
}

/// Repeats the block.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let path = args.dump.display();
    let refused = |why: &dyn std::fmt::Display| Failure::input(format!("{path}: {why}"));
    if let Some(output) = &args.output {
        ensure_writable(output).map_err(|e| Failure::input(e.to_string()))?;
    }
    let text = std::fs::read(&args.dump).map_err(|e| refused(&format!("cannot be read: {e}")))?;
    let dump = BlockDump::from_json(&text).map_err(|e| refused(&e))?;
    let estimate = Estimate::of_dump(&dump);
    if estimate.largest_block_bytes > args.memory {
        return Err(refused(&hint::of_size(&TooLarge::Block { estimate, memory: args.memory })));
    }
    let pool = super::common::thread_pool(args.common.threads)?;
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(true, args.common.progress, stop.clone());
    match pool.install(|| replay(&dump, &Watch::asking(&bars))) {
        Err(error) if error.is_cancelled() => Err(Failure::stopped(NOTHING_KEPT)),
        Err(error) => args.fails_again(&dump, &error),
        Ok(block) => {
            stop.keep();
            args.comes_out(&dump, block)
        }
    }
}

impl Args {
    fn fails_again(&self, dump: &BlockDump, error: &BlockError) -> Result<Exit, Failure> {
        let (stage, reason) = (error.stage(), error.to_string());
        if self.common.json {
            self.print(dump, Some(Failed { stage, reason }), None)?;
            return Ok(Exit::StageFailed);
        }
        let (block, nodes) = (dump.name(), &dump.nodes);
        Err(Failure::stage(format!("{block} (nodes {nodes:?}) failed at the stage '{stage}': {reason}")))
    }

    fn comes_out(&self, dump: &BlockDump, block: Finished) -> Result<Exit, Failure> {
        let volume = block.into_volume();
        let mesh = &volume.mesh;
        let file = self.output.as_ref().map(|path| path.display().to_string());
        let made =
            ReplayedMesh { points: mesh.points.len(), tets: mesh.tets.len(), quality: TetQuality::of(mesh), file };
        if let Some(path) = &self.output {
            let notes = MeshNotes {
                expectation: None,
                generator: concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into(),
                options: format!("replay of {}", dump.name()),
                regions: Vec::new(),
                flow: None,
            };
            write_mesh(path, &volume, &notes).map_err(|e| Failure::input(e.to_string()))?;
        }
        if !self.common.quiet || self.common.json {
            self.print(dump, None, Some(made))?;
        }
        Ok(Exit::Fine)
    }

    fn print(&self, dump: &BlockDump, failed: Option<Failed>, mesh: Option<ReplayedMesh>) -> Result<(), Failure> {
        if self.common.json {
            let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
            let (written_by, block, nodes) = (dump.program.as_str(), dump.name(), dump.nodes.as_slice());
            return super::common::print(
                true,
                &Output { program, written_by, block, nodes, failed, mesh },
                String::new,
            );
        }
        if let Some(ReplayedMesh { points, tets, .. }) = mesh {
            let (block, nodes) = (dump.name(), &dump.nodes);
            let hint = if self.output.is_none() { " (-o MESH writes it)" } else { "" };
            let files: Vec<&Path> = self.output.iter().map(PathBuf::as_path).collect();
            log::result(&format!(
                "{block} (nodes {nodes:?}) was meshed{hint}\n{}{}",
                row("mesh", &format!("{}, {}", tetrahedra(tets), counted(points, "point"))),
                ended(&files).rows(&[])
            ));
        }
        Ok(())
    }
}
