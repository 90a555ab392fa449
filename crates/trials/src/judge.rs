//! Classification of runs: valid, typed error, or finding.

use crate::case::{Case, Expect, Input};
use crate::process::{Ended, Limits, Run, run};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Programs under trial.
#[derive(Clone, Debug)]
pub struct Programs {
    /// `anastomesh`.
    pub mesher: PathBuf,
    /// `anastomesh-verify`.
    pub verifier: PathBuf,
}

/// Outcome of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Valid by both checkers, or by `check` alone where the second checker does not read the cells.
    Valid {
        /// True if both checkers have read the mesh.
        by_both: bool,
    },
    /// Typed error: exit code and message without numbers and names.
    Typed {
        /// Exit code.
        code: i32,
        /// Message.
        message: String,
    },
    /// Finding.
    Finding {
        /// Sort of finding; shrinking keeps it.
        sort: &'static str,
        /// Details.
        text: String,
    },
}

/// Outcome with its cost.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Outcome.
    pub outcome: Outcome,
    /// Processor seconds of the mesher.
    pub seconds: f64,
    /// Messages of the mesher.
    pub stderr: String,
}

/// Memory limit of small cases in bytes: the default of `--memory` (2 GiB) and half of it for the rest.
const MEMORY: u64 = 3 << 30;

/// Processor seconds of a small case.
const SECONDS: f64 = 60.0;

/// Size of the input from which the limits grow in proportion.
const SMALL: usize = 2000;

impl Case {
    /// Limits of the case.
    pub fn limits(&self) -> Limits {
        let factor = (self.size() as f64 / SMALL as f64).max(1.0);
        Limits { seconds: SECONDS * factor, bytes: (MEMORY as f64 * factor.min(4.0)) as u64 }
    }
}

/// Runs a case in a folder, which is emptied first, and classifies the outcome.
pub fn judge(case: &Case, programs: &Programs, folder: &Path) -> io::Result<Judged> {
    clear(folder)?;
    fs::write(folder.join(case.file()), case.text())?;
    let made = run(&programs.mesher, &case.arguments(), folder, case.limits())?;
    let outcome = match classify(case, &made, &names(folder)?) {
        Stage::Done(outcome) => outcome,
        Stage::Mesh(code) => check(case, &made, code, programs, folder)?,
    };
    Ok(Judged { outcome: demanded(case, outcome), seconds: made.seconds, stderr: made.stderr })
}

fn clear(folder: &Path) -> io::Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder)?;
    }
    fs::create_dir_all(folder)
}

/// Sorted names in a folder.
pub fn names(folder: &Path) -> io::Result<Vec<String>> {
    let mut names: Vec<String> =
        fs::read_dir(folder)?.map(|e| Ok(e?.file_name().to_string_lossy().into_owned())).collect::<io::Result<_>>()?;
    names.sort();
    Ok(names)
}

/// Result of a look at the run alone.
#[derive(Debug, PartialEq, Eq)]
enum Stage {
    Done(Outcome),
    /// A mesh was written: its exit code.
    Mesh(i32),
}

fn finding(sort: &'static str, text: impl Into<String>) -> Outcome {
    Outcome::Finding { sort, text: text.into() }
}

fn classify(case: &Case, run: &Run, files: &[String]) -> Stage {
    let last = run.stderr.lines().last().unwrap_or_default();
    let code = match run.ended {
        _ if run.stderr.contains("panicked at") => return Stage::Done(finding("panic", panic_line(&run.stderr))),
        Ended::TooLong => return Stage::Done(finding("hang", format!("more than {} s", case.limits().seconds))),
        Ended::TooMuchMemory => {
            return Stage::Done(finding("memory", format!("{} MiB; {last}", run.bytes >> 20)));
        }
        Ended::Signal(signal) => return Stage::Done(finding("signal", format!("signal {signal}; {last}"))),
        Ended::Code(code) => code,
    };
    if !(0..=4).contains(&code) {
        return Stage::Done(finding("exit code", format!("exit code {code}; {last}")));
    }
    let has_mesh = files.iter().any(|name| name == case.output);
    match code {
        0 if !has_mesh => Stage::Done(finding("no output", "exit code 0, and no file")),
        0 => Stage::Mesh(code),
        1 if has_mesh => Stage::Mesh(code),
        4 if has_mesh && case.has("--keep-going") => Stage::Mesh(code),
        _ => Stage::Done(failed(case, code, &run.stderr, files)),
    }
}

fn panic_line(stderr: &str) -> String {
    let line = stderr.lines().position(|line| line.contains("panicked at")).unwrap_or(0);
    stderr.lines().skip(line).take(2).collect::<Vec<_>>().join(" ")
}

/// Outcome of a run that wrote no mesh.
fn failed(case: &Case, code: i32, stderr: &str, files: &[String]) -> Outcome {
    let dump = format!("{}.failed", case.output);
    let left: Vec<&String> = files.iter().filter(|name| **name != case.file() && **name != dump).collect();
    if !left.is_empty() {
        return finding("files left", format!("exit code {code} left {left:?}"));
    }
    match error_line(code, stderr) {
        Some(line) => Outcome::Typed { code, message: template(line) },
        None => finding("no message", format!("exit code {code}: {stderr}")),
    }
}

/// Line with the error.
fn error_line(code: i32, stderr: &str) -> Option<&str> {
    let start = if code == 2 { "error: " } else { "anastomesh: " };
    stderr.lines().find_map(|line| line.strip_prefix(start).or_else(|| line.strip_prefix("anastomesh: ")))
}

/// Checks a written mesh with both programs.
fn check(case: &Case, made: &Run, code: i32, programs: &Programs, folder: &Path) -> io::Result<Outcome> {
    let own = ["check", case.output, "-q", "-j", "1"].map(str::to_owned);
    let first = run(&programs.mesher, &own, folder, case.limits())?;
    let mut second_arguments = vec![case.output.to_owned()];
    if keeps_triangles(case) {
        second_arguments.extend(["--surface".to_owned(), case.file().to_owned()]);
    }
    let second =
        if is_readable(case) { Some(run(&programs.verifier, &second_arguments, folder, case.limits())?) } else { None };
    Ok(verdict(code, made, &first, second.as_ref()))
}

/// True if the second checker reads the cells and the format.
fn is_readable(case: &Case) -> bool {
    let known = [".vtu", ".msh", ".ele"].iter().any(|end| case.output.ends_with(end));
    known && !["--order", "--prisms", "--parts"].iter().any(|option| case.has(option))
}

/// True if each triangle of the input is a face of the mesh.
fn keeps_triangles(case: &Case) -> bool {
    let changes = ["--split", "--remesh-surface", "--layers", "--repair", "--plc", "--tetgen"];
    matches!(case.input, Input::Surface(_)) && !changes.iter().any(|option| case.has(option))
}

fn verdict(code: i32, made: &Run, first: &Run, second: Option<&Run>) -> Outcome {
    let text = |run: &Run| {
        let said = if run.stdout.trim().is_empty() { &run.stderr } else { &run.stdout };
        format!("{:?} {}", run.ended, said.trim().chars().take(300).collect::<String>())
    };
    let both = || {
        let second = second.map_or("not run".into(), text);
        format!("mesh: exit code {code} {}; check: {}; verify: {second}", made.stderr.trim(), text(first))
    };
    for run in [Some(first), second].into_iter().flatten() {
        match run.ended {
            Ended::Code(0 | 1) if !run.stderr.contains("panicked at") => {}
            _ => return finding("check failed", both()),
        }
    }
    let is_valid = |run: &Run| run.ended == Ended::Code(0);
    let agree = second.is_none_or(|second| is_valid(second) == is_valid(first));
    if code == 0 && !is_valid(first) {
        return finding("called valid", both());
    }
    if !agree {
        return finding("checkers disagree", both());
    }
    match code {
        0 => Outcome::Valid { by_both: second.is_some() },
        1 if is_valid(first) == made.stderr.contains("NOT valid") => finding("wrong verdict", both()),
        _ => match error_line(code, &made.stderr) {
            Some(line) => Outcome::Typed { code, message: template(line) },
            None => Outcome::Typed { code, message: template(made.stderr.lines().last().unwrap_or("no message")) },
        },
    }
}

/// Compares an outcome with the demand of its kind.
fn demanded(case: &Case, outcome: Outcome) -> Outcome {
    match (case.expect, outcome) {
        (Expect::Valid, Outcome::Typed { code, message }) => {
            finding("valid input refused", format!("exit code {code}: {message}"))
        }
        (Expect::Refused, Outcome::Valid { .. }) => finding("accepted", "the input is not valid, and was meshed"),
        (_, outcome) => outcome,
    }
}

/// Longest message, in characters, that groups outcomes.
const MESSAGE: usize = 110;

/// Message with numbers replaced by `N`, without the name of the file.
pub fn template(message: &str) -> String {
    let message = match message.split_once(": ") {
        Some((start, rest)) if start.starts_with("in.") || start.starts_with("out.") => rest,
        _ => message,
    };
    numbers_removed(message)
}

fn numbers_removed(message: &str) -> String {
    let mut out = String::new();
    let mut in_number = false;
    for c in message.chars() {
        let goes_on = in_number && (c.is_ascii_digit() || ".,e-+".contains(c));
        if c.is_ascii_digit() || goes_on {
            if !in_number {
                out.push('N');
            }
            in_number = true;
        } else {
            in_number = false;
            out.push(c);
        }
        if out.chars().count() >= MESSAGE {
            break;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::cuboid;

    fn case() -> Case {
        Case::new(Input::Surface(cuboid([0.0; 3], [1.0; 3])), Expect::Any)
    }

    fn run(ended: Ended, stderr: &str) -> Run {
        Run { ended, stderr: stderr.into(), stdout: String::new(), seconds: 0.0, bytes: 0 }
    }

    fn sort(stage: &Stage) -> &str {
        match stage {
            Stage::Done(Outcome::Finding { sort, .. }) => sort,
            Stage::Done(Outcome::Typed { .. }) => "typed",
            Stage::Done(Outcome::Valid { .. }) => "valid",
            Stage::Mesh(_) => "mesh",
        }
    }

    #[test]
    fn ends_are_classified() {
        let files = |list: &[&str]| list.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let error = "anastomesh: in.off: open: 3 edges\n";
        let ends = [
            (Ended::Code(70), "thread panicked at src/a.rs:1", &["in.off"][..], "panic"),
            (Ended::TooLong, "", &["in.off"], "hang"),
            (Ended::TooMuchMemory, "", &["in.off"], "memory"),
            (Ended::Signal(11), "", &["in.off"], "signal"),
            (Ended::Code(17), "", &["in.off"], "exit code"),
            (Ended::Code(0), "", &["in.off"], "no output"),
            (Ended::Code(0), "", &["in.off", "out.vtu"], "mesh"),
            (Ended::Code(1), "", &["in.off", "out.vtu"], "mesh"),
            (Ended::Code(3), error, &["in.off"], "typed"),
            (Ended::Code(3), error, &["in.off", "out.vtu"], "files left"),
            (Ended::Code(4), error, &["in.off", "out.vtu.failed"], "typed"),
            (Ended::Code(3), "", &["in.off"], "no message"),
        ];
        for (ended, stderr, list, expected) in ends {
            assert_eq!(sort(&classify(&case(), &run(ended.clone(), stderr), &files(list))), expected, "{ended:?}");
        }
    }

    #[test]
    fn verdicts_are_compared() {
        let [yes, no] = [0, 1].map(|code| run(Ended::Code(code), ""));
        let sort = |outcome| sort(&Stage::Done(outcome)).to_owned();
        assert_eq!(sort(verdict(0, &yes, &yes, Some(&yes))), "valid");
        assert_eq!(sort(verdict(0, &yes, &yes, Some(&no))), "checkers disagree");
        assert_eq!(sort(verdict(0, &yes, &no, Some(&no))), "called valid");
        let not_valid = run(Ended::Code(1), "anastomesh: out.vtu: NOT valid: open");
        assert_eq!(sort(verdict(1, &not_valid, &no, Some(&no))), "typed");
        assert_eq!(sort(verdict(1, &no, &no, Some(&no))), "wrong verdict");
        assert_eq!(sort(verdict(1, &not_valid, &yes, Some(&yes))), "wrong verdict");
        assert_eq!(sort(verdict(1, &no, &no, Some(&yes))), "checkers disagree");
        assert_eq!(sort(verdict(0, &yes, &run(Ended::Code(70), ""), None)), "check failed");
    }

    #[test]
    fn demands_are_compared() {
        let typed = Outcome::Typed { code: 3, message: String::new() };
        let sort = |expect, outcome| sort(&Stage::Done(demanded(&Case { expect, ..case() }, outcome))).to_owned();
        assert_eq!(sort(Expect::Valid, typed.clone()), "valid input refused");
        assert_eq!(sort(Expect::Refused, typed.clone()), "typed");
        assert_eq!(sort(Expect::Refused, Outcome::Valid { by_both: true }), "accepted");
    }

    #[test]
    fn messages_are_grouped() {
        assert_eq!(template("in.off: 12 triangles at 1.5e-3, 7"), "N triangles at N N");
        assert_eq!(template("2 blocks of 30 failed"), "N blocks of N failed");
    }
}
