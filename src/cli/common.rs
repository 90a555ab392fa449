//! The options of every verb that works for a while.

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
}
