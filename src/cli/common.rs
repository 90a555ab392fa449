//! Options and functions shared by commands.

use super::clock::elapsed;
use super::exit::Failure;
use super::log;
use super::progress::ProgressFormat;
use crate::report::rows::Ended;
use std::num::NonZeroUsize;
use std::path::Path;

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
    Ended { files: written(paths), seconds: elapsed().as_secs_f64(), memory: peak_memory() }
}

/// Existing files and folders with the sizes of their contents, in bytes.
fn written(paths: &[&Path]) -> Vec<(String, u64)> {
    let written = |path: &&&Path| path.exists();
    paths.iter().filter(written).map(|path| (path.display().to_string(), size_of(path))).collect()
}

/// Size of a file, or of all files in a folder.
fn size_of(path: &Path) -> u64 {
    let Ok(data) = path.symlink_metadata() else { return 0 };
    if !data.is_dir() {
        return data.len();
    }
    let inside = std::fs::read_dir(path).into_iter().flatten().flatten();
    inside.map(|entry| size_of(&entry.path())).sum()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_of_a_folder_is_that_of_its_contents() {
        let folder = tempfile::tempdir().unwrap();
        let case = folder.path().join("tree.foam/constant/polyMesh");
        std::fs::create_dir_all(&case).unwrap();
        std::fs::write(case.join("points"), [0; 1000]).unwrap();
        std::fs::write(folder.path().join("tree.foam/case.foam"), [0; 10]).unwrap();
        assert_eq!(size_of(&folder.path().join("tree.foam")), 1010);
        assert_eq!(written(&[&folder.path().join("absent")]), []);
    }
}
