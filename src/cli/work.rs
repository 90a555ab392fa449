//! Work directories, which store finished blocks between runs, and shards.

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

/// Options of work directories and shards.
#[derive(Debug, clap::Args)]
pub struct WorkArgs {
    /// Folder for finished blocks; a stopped run continues from it
    #[arg(long = "work-dir", help_heading = "Run", value_name = "DIR")]
    pub dir: Option<PathBuf>,
    /// Delete the contents of the work directory if network, options or version differ
    #[arg(long, help_heading = "Run", requires = "dir")]
    restart: bool,
    /// Make only shard I of N (from 1) and write no mesh. Shards can run at the same time on several machines; the same
    /// command without this option then joins them
    #[arg(long, help_heading = "Run", value_name = "I/N", requires = "dir", conflicts_with = "restart", value_parser = Shard::two_numbers)]
    shard: Option<(u32, u32)>,
    /// Make blocks that shards have not finished, instead of failing
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
    /// Shard of this run, if any.
    ///
    /// # Errors
    /// The shard does not exist, or joints are woven: connectors would need clusters of other shards.
    pub fn shard(&self, plan: &MeshPlan) -> Result<Option<Shard>, Failure> {
        let Some((number, of)) = self.shard else { return Ok(None) };
        if plan.weaves_joints() {
            return Err(Failure::usage("--shard needs independent blocks: give --joint disc"));
        }
        Shard::new(number, of).map(Some).map_err(|e: NoShard| Failure::input(e.to_string()))
    }

    /// Opens the work directory, if given; `manifest` describes the run.
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

/// Reports the result of a shard.
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
            "shard {shard}: {share} of {blocks} blocks in {seconds}, {found} reused, {failed} failed (retried by the run that \
             joins the shards)"
        ));
    }
    Ok(Exit::Fine)
}

/// Prints a note on the work directory, before the run can be killed.
pub fn note(dir: &Path, bars: &Bars) {
    let dir = dir.display();
    bars.note(&format!("finished blocks are kept in {dir}: if this run is stopped, the same command continues"));
}
