//! Work directories: what keeps finished blocks between runs, and runs that share the work in one.

use std::path::{Path, PathBuf};

use super::common::print;
use super::exit::{Exit, Failure};
use super::hint;
use super::limits::BlockPlace;
use super::log;
use super::progress::Bars;
use crate::pipeline::{Manifest, MeshPlan, NoShard, Role, Shard, ShareReport, Store, StoreError};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::units::{grouped, seconds_of};

/// Where finished blocks are kept, and by how many runs.
#[derive(Debug, clap::Args)]
pub struct WorkArgs {
    /// Folder that keeps finished blocks: a run that was stopped goes on there when it is started again
    #[arg(long = "work-dir", help_heading = "Run", value_name = "DIR")]
    pub dir: Option<PathBuf>,
    /// Throw away what the work directory holds if it is of another network, other options or another version
    #[arg(long, help_heading = "Run", requires = "dir")]
    restart: bool,
    /// Make only the I-th of N shares of the blocks, counted from 1, and write no mesh: any number of these at a time, on any
    /// number of machines; then the same command without this finds all blocks
    #[arg(long, help_heading = "Run", value_name = "I/N", requires = "dir", conflicts_with = "restart", value_parser = Shard::two_numbers)]
    shard: Option<(u32, u32)>,
    /// Make what shards have left undone instead of refusing it
    #[arg(long, help_heading = "Run", requires = "dir", conflicts_with = "shard")]
    make_missing: bool,
}

/// A work directory in use.
pub struct WorkDir {
    pub place: BlockPlace,
    pub store: Store,
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Self::input(hint::of_store(&error))
    }
}

impl WorkArgs {
    /// The shard that this run is, if it is one.
    ///
    /// # Errors
    /// When there is no such shard, or joints are woven, as connectors then wait for clusters of other shards.
    pub fn shard(&self, plan: &MeshPlan) -> Result<Option<Shard>, Failure> {
        let Some((number, of)) = self.shard else { return Ok(None) };
        if plan.weaves_joints() {
            return Err(Failure::usage("--shard needs blocks that can be made in any order: give --joint disc"));
        }
        Shard::new(number, of).map(Some).map_err(|e: NoShard| Failure::input(e.to_string()))
    }

    /// Opens the work directory, if one is given; `manifest` says what it belongs to.
    pub fn open(&self, shard: Option<Shard>, manifest: impl FnOnce() -> Manifest) -> Result<Option<WorkDir>, Failure> {
        let Some(dir) = &self.dir else { return Ok(None) };
        let role = match shard {
            Some(shard) => Role::Shard(shard),
            None => Role::Alone { restart: self.restart, make_missing: self.make_missing },
        };
        let store = Store::in_folder_as(role, dir, &manifest())?;
        Ok(Some(WorkDir { place: BlockPlace::Folder(dir.clone()), store }))
    }
}

/// Says what a shard did.
pub fn told(shard: Shard, report: &ShareReport, json: bool, quiet: bool) -> Result<Exit, Failure> {
    if json {
        #[derive(serde::Serialize)]
        struct Output<'a> {
            program: &'static str,
            shard: String,
            #[serde(flatten)]
            report: &'a ShareReport,
        }
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
        print(true, &Output { program, shard: shard.to_string(), report }, String::new)?;
    } else if !quiet {
        let ShareReport { blocks, share, found, failed, seconds, .. } = report;
        let [blocks, share, found, failed] = [blocks, share, found, failed].map(|&n| grouped(n));
        let seconds = seconds_of(*seconds);
        log::result(&format!(
            "shard {shard}: {share} of {blocks} blocks in {seconds}, {found} were there before, {failed} fail and are left \
             to the run that joins the shards"
        ));
    }
    Ok(Exit::Fine)
}

/// What is said of a work directory in use: whoever kills the program cannot be told afterwards.
pub fn note(dir: &Path, bars: &Bars) {
    let dir = dir.display();
    bars.note(&format!("finished blocks are kept in {dir}: the same command goes on there if this run is stopped"));
}
