//! Tests, the mutants that each of them reaches, and the tests that fail with a mutant.

use crate::build::Program;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Limit of the address space of a test in KiB. A mutant may allocate without end.
const ADDRESS_SPACE: u64 = 8 << 20;

/// Exit code of `timeout`.
const TIMED_OUT: i32 = 124;

/// One test.
#[derive(Clone, Debug)]
pub struct Test {
    /// Number of its program.
    pub program: usize,
    /// Name, with its modules.
    pub name: String,
    /// Wall time without a mutant.
    pub time: Duration,
    /// Numbers of the mutants that it reaches.
    pub reaches: BTreeSet<u32>,
}

/// Names of the tests of a program that are not ignored.
///
/// # Errors
///
/// The program cannot be run.
pub fn names(program: &Program) -> io::Result<Vec<String>> {
    let list = |more: &[&str]| -> io::Result<BTreeSet<String>> {
        let mut command = Command::new(&program.path);
        let output = command.args(["--list", "--format=terse"]).args(more).current_dir(&program.folder).output()?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        Ok(text.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect())
    };
    let ignored = list(&["--ignored"])?;
    Ok(list(&[])?.into_iter().filter(|name| !ignored.contains(name)).collect())
}

/// Runs a test without a mutant, and records which it reaches. `None` if it fails.
///
/// # Errors
///
/// The test cannot be run, or `log` cannot be read.
pub fn recorded(programs: &[Program], program: usize, name: &str, log: &Path) -> io::Result<Option<Test>> {
    let start = Instant::now();
    let status = run(&programs[program], name, "record", log, Duration::from_secs(300))?;
    let time = start.elapsed();
    let bytes = if log.exists() { fs::read(log)? } else { Vec::new() };
    let _ = fs::remove_file(log);
    let reaches = bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    Ok(status.success().then(|| Test { program, name: name.to_owned(), time, reaches }))
}

/// End of the tests of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A test failed.
    Caught,
    /// A test took too long.
    Timeout,
    /// All tests passed, or those that the budget of time allowed.
    Missed,
}

/// Tries a mutant with these tests, until one fails or their time without a mutant exceeds the budget.
///
/// # Errors
///
/// A test cannot be run.
pub fn tried(programs: &[Program], tests: &[&Test], mutant: u32, budget: Duration) -> io::Result<Outcome> {
    let mut spent = Duration::ZERO;
    for test in tests {
        if spent > budget {
            break;
        }
        spent += test.time;
        let limit = Duration::from_secs(10) + 5 * test.time;
        let status = run(&programs[test.program], &test.name, &mutant.to_string(), Path::new(""), limit)?;
        if status.code() == Some(TIMED_OUT) {
            return Ok(Outcome::Timeout);
        }
        if !status.success() {
            return Ok(Outcome::Caught);
        }
    }
    Ok(Outcome::Missed)
}

fn run(program: &Program, test: &str, mutant: &str, log: &Path, limit: Duration) -> io::Result<ExitStatus> {
    Command::new("timeout")
        .arg(format!("{}", limit.as_secs_f64()))
        .args(["sh", "-c", &format!("ulimit -v {ADDRESS_SPACE}; exec \"$@\""), "sh"])
        .arg(&program.path)
        .args(["--exact", test])
        .current_dir(&program.folder)
        .env("CARGO_MANIFEST_DIR", &program.folder)
        .env("INSTA_UPDATE", "no")
        .env("MUTANT", mutant)
        .env("MUTANTS_REACHED", log)
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
}
