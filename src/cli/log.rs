//! Messages: text lines, or JSON objects with `--log-format json`.

use std::ffi::OsString;
use std::io::{self, IsTerminal, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

use super::bar;
use super::colours::{self, painted};
use super::exit::Failure;
use super::wrap;

/// True if messages are JSON. Set before a command runs.
static AS_JSON: AtomicBool = AtomicBool::new(false);

/// Format of messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum LogFormat {
    /// Text
    #[default]
    Text,
    /// One JSON object per line with `level` (note, warning, result, error or progress) and `message` or the progress
    Json,
}

impl LogFormat {
    /// Selects this format.
    pub fn set(self) {
        AS_JSON.store(self == Self::Json, Ordering::Relaxed);
    }

    /// Format requested by command-line words. They may be invalid; errors about them use the format.
    pub fn of_words(words: &[OsString]) -> Self {
        let word = |i: usize| words.get(i).map(|word| word.to_string_lossy());
        let asks = |i: usize| match word(i).as_deref() {
            Some("--log-format") => word(i + 1).is_some_and(|format| format == "json"),
            Some(word) => word == "--log-format=json",
            None => false,
        };
        if (0..words.len()).any(asks) { Self::Json } else { Self::Text }
    }
}

/// True if messages are JSON.
pub fn is_json() -> bool {
    AS_JSON.load(Ordering::Relaxed)
}

/// Prints a note.
pub fn note(message: &str) {
    said("note", "", message);
}

/// Prints a warning.
pub fn warning(message: &str) {
    said("warning", "warning: ", message);
}

/// Prints a result.
pub fn result(message: &str) {
    said("result", "", message);
}

/// Prints the verdict of a run whose result is not what was asked for.
pub fn failure(message: &str) {
    said("failure", "", message);
}

/// Prints an error.
pub fn error(message: &str) {
    said("error", "anastomesh: ", message);
}

/// Prints a text result on standard output.
pub fn answer(message: &str) -> Result<(), Failure> {
    let line = line("result", "", message, io::stdout().is_terminal());
    print_bytes(format!("{line}\n").as_bytes())
}

/// Returns a progress line.
pub fn progress(stage: &str, done: u64, total: u64) -> String {
    let mut line = serde_json::json!({ "progress": { "stage": stage, "done": done, "total": total } });
    if is_json() {
        line["level"] = "progress".into();
    }
    line.to_string()
}

fn said(level: &str, before: &str, message: &str) {
    let line = line(level, before, message, io::stderr().is_terminal());
    // On a full disk a message may be lost. The exit code is not.
    bar::aside(|| drop(writeln!(io::stderr(), "{line}")));
}

fn line(level: &str, before: &str, message: &str, on_terminal: bool) -> String {
    let message = message.trim_end_matches('\n');
    if is_json() {
        let level = if level == "failure" { "error" } else { level };
        return serde_json::json!({ "level": level, "message": message }).to_string();
    }
    if !on_terminal {
        return format!("{before}{message}");
    }
    let whole = format!("{before}{message}");
    let whole = wrap::width().map_or_else(|| whole.clone(), |width| wrap::wrapped(&whole, width));
    match whole.strip_prefix(before) {
        Some(message) if colours::are_wanted() => painted(level, before, message),
        _ => whole,
    }
}

/// Writes to standard output. A closed pipe is the reader's decision, not an error.
pub fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::input(format!("standard output: {e}"))),
        _ => Ok(()),
    }
}
