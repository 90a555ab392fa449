//! What is said while a verb runs: lines for people, or with `--log-format json` an object on each line.

use std::ffi::OsString;
use std::io::{self, IsTerminal, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

use super::colours::{self, painted};
use super::exit::Failure;

/// Whether programs listen: known before any verb runs, and the same until the end.
static AS_JSON: AtomicBool = AtomicBool::new(false);

/// How lines are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum LogFormat {
    /// For people
    #[default]
    Text,
    /// A JSON object on each line: `level` (note, warning, result, error or progress) and `message`, or what is done
    Json,
}

impl LogFormat {
    /// Writes so from now on.
    pub fn set(self) {
        AS_JSON.store(self == Self::Json, Ordering::Relaxed);
    }

    /// What words ask for that may not be a command line at all: what is wrong with them has to be said, too.
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

/// Whether programs listen.
pub fn is_json() -> bool {
    AS_JSON.load(Ordering::Relaxed)
}

/// Something that a person may want to know.
pub fn note(message: &str) {
    said("note", "", message);
}

/// Something odd about the input, or that goes another way than asked for.
pub fn warning(message: &str) {
    said("warning", "warning: ", message);
}

/// What was done.
pub fn result(message: &str) {
    said("result", "", message);
}

/// Why it ends.
pub fn error(message: &str) {
    said("error", "anastomesh: ", message);
}

/// What was asked for, on standard output: an answer that is not the report of `--json`.
pub fn answer(message: &str) -> Result<(), Failure> {
    let line = line("result", "", message, io::stdout().is_terminal());
    print_bytes(format!("{line}\n").as_bytes())
}

/// A line of progress.
pub fn progress(stage: &str, done: u64, total: u64) -> String {
    let mut line = serde_json::json!({ "progress": { "stage": stage, "done": done, "total": total } });
    if is_json() {
        line["level"] = "progress".into();
    }
    line.to_string()
}

fn said(level: &str, before: &str, message: &str) {
    eprintln!("{}", line(level, before, message, io::stderr().is_terminal()));
}

fn line(level: &str, before: &str, message: &str, on_terminal: bool) -> String {
    let message = message.trim_end_matches('\n');
    match is_json() {
        true => serde_json::json!({ "level": level, "message": message }).to_string(),
        false if on_terminal && colours::are_wanted() => painted(level, before, message),
        false => format!("{before}{message}"),
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
