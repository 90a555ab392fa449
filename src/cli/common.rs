//! The options of every verb that works for a while, and what several verbs do alike.

use super::exit::Failure;
use super::log;
use super::progress::ProgressFormat;
use crate::report::rows::Ended;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

/// When the program began.
static BEGIN: OnceLock<Instant> = OnceLock::new();

/// The program begins.
pub fn begin() {
    BEGIN.get_or_init(Instant::now);
}

/// How a verb works and what it says of it.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "General")]
pub struct Common {
    /// Number of threads (default: all cores); the output does not depend on it
    #[arg(short = 'j', long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Print the report as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Tell progress as lines of JSON on standard error, for programs: the stage, how much of it is done, and of how much (0:
    /// not known). A run whose lines nobody reads any more ends
    #[arg(long, value_name = "FORMAT")]
    pub progress: Option<ProgressFormat>,
    /// Print all there is to say: every retry, every line of the check
    #[arg(short, long, conflicts_with = "quiet")]
    pub verbose: bool,
}

/// What is left of a run: files and folders that are there, with their sizes; time and memory.
pub fn ended(paths: &[&Path]) -> Ended {
    let seconds = BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64();
    Ended { files: written(paths), seconds, memory: peak_memory() }
}

/// Files and folders that are there, with their sizes.
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

/// Most memory that the process has had in use, in bytes; none where the system does not tell.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024 * kilobytes)
}

/// As many threads as were asked for, or as there are cores.
pub fn thread_pool(threads: Option<NonZeroUsize>) -> Result<rayon::ThreadPool, Failure> {
    // 0 lets rayon take as many as there are cores.
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, Into::into));
    builder.build().map_err(|e| Failure::stage(format!("the threads cannot be started: {e}")))
}

/// Prints a result for people or, with `--json`, for programs.
pub fn print(json: bool, value: &impl serde::Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
    if !json {
        return log::answer(&text());
    }
    let out = serde_json::to_string_pretty(value).map_err(|e| Failure::stage(format!("cannot write JSON: {e}")))?;
    log::print_bytes(format!("{out}\n").as_bytes())
}
