//! The options of every verb that works for a while, and what several verbs do alike.

use super::exit::Failure;
use super::progress::ProgressFormat;
use std::io::Write as _;
use std::num::NonZeroUsize;

/// How a verb works and what it says of it.
#[derive(Debug, clap::Args)]
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
}

/// As many threads as were asked for, or as there are cores.
pub fn thread_pool(threads: Option<NonZeroUsize>) -> Result<rayon::ThreadPool, Failure> {
    // 0 lets rayon take as many as there are cores.
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, Into::into));
    builder.build().map_err(|e| Failure::stage(format!("the threads cannot be started: {e}")))
}

/// Prints a result for people or, with `--json`, for programs.
pub fn print(json: bool, value: &impl serde::Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
    let out = if json {
        serde_json::to_string_pretty(value).map_err(|e| Failure::stage(format!("cannot write JSON: {e}")))?
    } else {
        text()
    };
    print_bytes(format!("{}\n", out.trim_end()).as_bytes())
}

/// Writes to standard output. A closed pipe is the reader's decision, not an error.
pub fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::input(format!("standard output: {e}"))),
        _ => Ok(()),
    }
}
