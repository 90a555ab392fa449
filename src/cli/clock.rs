//! Time since the start of the program.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Start time of the program.
static BEGIN: OnceLock<Instant> = OnceLock::new();

/// Records the start time.
pub fn begin() {
    BEGIN.get_or_init(Instant::now);
}

/// Time since the start of the program.
pub fn elapsed() -> Duration {
    BEGIN.get_or_init(Instant::now).elapsed()
}
