//! Options and functions shared by commands.

use super::exit::Failure;
use super::log;
use super::progress::ProgressFormat;
use crate::report::rows::Ended;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

/// Start time of the program.
static BEGIN: OnceLock<Instant> = OnceLock::new();

/// Records the start time.
pub fn begin() {
    BEGIN.get_or_init(Instant::now);
}

/// General options.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "General")]
pub struct Common {
    /// Number of threads (default: all cores); the result does not depend on it
    #[arg(short = 'j', long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Print the report as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Print errors only
    #[arg(short, long)]
    pub quiet: bool,
    /// Report progress as JSON lines on standard error: stage, steps done, total steps (0 if unknown). The run stops when
    /// the pipe is closed
    #[arg(long, value_name = "FORMAT")]
    pub progress: Option<ProgressFormat>,
    /// Print every detail, such as all retries and all conditions of the check
    #[arg(short, long, conflicts_with = "quiet")]
    pub verbose: bool,
}

/// Outcome of a run: existing output files with their sizes, time and memory.
pub fn ended(paths: &[&Path]) -> Ended {
    let seconds = BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64();
    Ended { files: written(paths), seconds, memory: peak_memory() }
}

/// Existing files and folders with their sizes, in bytes.
fn written(paths: &[&Path]) -> Vec<(String, u64)> {
    let size = |path: &Path| match path.metadata() {
        Ok(data) if data.is_dir() => {
            let inside = std::fs::read_dir(path).into_iter().flatten().flatten();
            Some(inside.filter_map(|entry| entry.metadata().ok()).map(|data| data.len()).sum())
        }
        data => data.ok().map(|data| data.len()),
    };
    paths.iter().filter_map(|path| Some((path.display().to_string(), size(path)?))).collect()
}

/// Peak memory of the process in bytes; `None` if the system does not report it.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024 * kilobytes)
}

/// Thread pool of the requested size, or with one thread per core.
pub fn thread_pool(threads: Option<NonZeroUsize>) -> Result<rayon::ThreadPool, Failure> {
    // For rayon, 0 means one thread per core.
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, Into::into));
    builder.build().map_err(|e| Failure::stage(format!("threads cannot be started: {e}")))
}

/// Prints a result as text or, with `--json`, as JSON.
pub fn print(json: bool, value: &impl serde::Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
    if !json {
        return log::answer(&text());
    }
    let out = serde_json::to_string_pretty(value).map_err(|e| Failure::stage(format!("cannot write JSON: {e}")))?;
    log::print_bytes(format!("{out}\n").as_bytes())
}
