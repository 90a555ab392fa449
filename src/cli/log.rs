//! What is said while a verb runs: lines for people, or with `--log-format json` an object on each line.

use std::sync::atomic::{AtomicBool, Ordering};

/// Whether programs listen: known before any verb runs, and the same until the end.
static AS_JSON: AtomicBool = AtomicBool::new(false);

/// How lines are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum LogFormat {
    /// For people
    #[default]
    Text,
    /// A JSON object on each line: `level` (note, result or error) and `message`
    Json,
}

impl LogFormat {
    /// Writes so from now on.
    pub fn set(self) {
        AS_JSON.store(self == Self::Json, Ordering::Relaxed);
    }
}

/// Something that a person may want to know.
pub fn note(message: &str) {
    write("note", message, "");
}

/// What was done.
pub fn result(message: &str) {
    write("result", message, "");
}

/// Why it ends.
pub fn error(message: &str) {
    write("error", message, "anastomesh: ");
}

fn write(level: &str, message: &str, before: &str) {
    let message = message.trim_end_matches('\n');
    if AS_JSON.load(Ordering::Relaxed) {
        eprintln!("{}", serde_json::json!({ "level": level, "message": message }));
    } else {
        eprintln!("{before}{message}");
    }
}
