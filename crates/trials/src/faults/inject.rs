//! System calls that fail on purpose, by fault injection of strace.

use super::jobs::{Job, LIMITS};
use super::trial::{Trial, finding, skipped};
use crate::judge::{Judged, Outcome};
use crate::process::{Ended, run_command};
use crate::random::Random;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

/// System calls on files with the errors to return.
const CALLS: [(&str, &[&str]); 22] = [
    ("write", &["ENOSPC", "EIO", "EINTR", "EDQUOT"]),
    ("writev", &["ENOSPC", "EIO", "EINTR"]),
    ("pwrite64", &["ENOSPC", "EIO", "EINTR"]),
    ("openat", &["EACCES", "EIO", "EINTR", "EMFILE", "ENOSPC"]),
    ("rename", &["EACCES", "EIO", "EXDEV", "ENOSPC"]),
    ("renameat", &["EACCES", "EIO", "EXDEV"]),
    ("renameat2", &["EACCES", "EIO", "EXDEV"]),
    ("fsync", &["EIO", "EINTR", "ENOSPC"]),
    ("fdatasync", &["EIO", "EINTR"]),
    ("syncfs", &["EIO", "ENOSPC"]),
    ("link", &["EACCES", "EPERM", "ENOSPC"]),
    ("linkat", &["EACCES", "EPERM", "ENOSPC"]),
    ("ftruncate", &["EIO", "EINTR", "ENOSPC"]),
    ("fallocate", &["EIO", "ENOSPC", "EOPNOTSUPP"]),
    ("unlink", &["EACCES", "EIO"]),
    ("mkdir", &["EACCES", "EIO", "ENOSPC"]),
    ("rmdir", &["EACCES", "EIO"]),
    ("flock", &["ENOLCK", "EINTR", "EAGAIN"]),
    ("read", &["EIO", "EINTR"]),
    ("pread64", &["EIO", "EINTR"]),
    ("lseek", &["EIO"]),
    ("copy_file_range", &["EIO", "ENOSPC"]),
];

/// A call of the undisturbed run: name, number among the calls of this name in its thread, and text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Call {
    pub name: String,
    pub number: u64,
    text: String,
}

/// Lets one call on a file of the run fail, and runs the job again.
pub fn judge(trial: &Trial, random: &mut Random) -> io::Result<Judged> {
    let calls = match calls(trial)? {
        Ok(calls) => calls,
        Err(skipped) => return Ok(skipped),
    };
    // Kinds of calls are drawn first: most calls are writes.
    let mut names: Vec<&str> = calls.iter().map(|call| call.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let name = random.pick(&names);
    let own: Vec<&Call> = calls.iter().filter(|call| call.name == name).collect();
    let call = random.pick(&own);
    let errors = CALLS.iter().find(|(known, _)| *known == name).map_or(&["EIO"][..], |(_, errors)| errors);
    let error = random.pick(errors);
    let log = trial.folder.with_extension("injected");
    let mut command = strace(trial, &log.to_string_lossy());
    command.args(["-e", &format!("inject={name}:error={error}:when={}", call.number)]);
    command.arg(trial.mesher).args(trial.job.arguments());
    let run = run_command(command, trial.folder, LIMITS)?;
    // After a success, folders are opened to list what is to be removed.
    let may_leave = |code| ["unlink", "rmdir"].contains(&name) || code == 0 && call.text.contains("O_DIRECTORY");
    let outcome = match run.ended {
        Ended::Code(code) => match trial.after_code(code, &run.stderr, may_leave(code))? {
            Outcome::Finding { sort, .. } if sort == "no message" && hits_stderr(&fs::read_to_string(&log)?) => {
                Outcome::Typed { code, message: "none: writing to stderr failed, too".into() }
            }
            // The fault met a call of the dynamic loader.
            Outcome::Finding { sort, .. }
                if sort == "exit code" && run.stderr.contains("error while loading shared libraries") =>
            {
                Outcome::Typed { code, message: "none: the program was not loaded".into() }
            }
            outcome => outcome,
        },
        _ => finding("signal", format!("{}: {:?} {}", trial.job.line(), run.ended, run.stderr.trim())),
    };
    let outcome = match trial.again(outcome)? {
        Outcome::Finding { sort, text } => {
            let call = without_folder(&call.text, &trial.folder.canonicalize()?);
            Outcome::Finding { sort, text: format!("{error} of {call}: {text}") }
        }
        other => other,
    };
    Ok(Judged { outcome, seconds: run.seconds, stderr: run.stderr })
}

/// True if strace is installed.
fn has_strace() -> bool {
    let status = Command::new("strace").arg("-V").stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

/// Text of a call with paths relative to the folder of the run. Findings are kept in the repository.
fn without_folder(text: &str, folder: &Path) -> String {
    let folder = folder.display().to_string();
    text.replace(&format!("{folder}/"), "").replace(&folder, ".")
}

/// True if a write to stderr failed. Calls are counted in each thread, so a fault may meet a second call.
fn hits_stderr(log: &str) -> bool {
    log.lines().any(|line| line.contains("write(2<") && line.contains("(INJECTED)"))
}

/// Command that records calls on files.
pub fn strace(trial: &Trial, log: &str) -> Command {
    let mut command = Command::new("strace");
    let names: Vec<&str> = CALLS.iter().map(|(name, _)| *name).collect();
    command.args(["-f", "-qq", "-y", "-s", "0", "-o", log, "-e", &format!("trace={}", names.join(","))]);
    command.current_dir(trial.folder);
    command
}

/// Calls of an undisturbed run on files of the output and work folders, which are then as before. An error where strace cannot
/// record them.
pub fn calls(trial: &Trial) -> io::Result<Result<Vec<Call>, Judged>> {
    if !has_strace() {
        return Ok(Err(skipped("strace is missing")));
    }
    let log = trial.folder.with_extension("strace");
    let mut command = strace(trial, &log.to_string_lossy());
    command.arg(trial.mesher).args(trial.job.arguments());
    run_command(command, trial.folder, LIMITS)?;
    let calls = parse(&fs::read_to_string(log)?);
    Job::prepare(trial.folder, trial.has_earlier.then_some(&trial.reference.earlier))?;
    Ok(if calls.is_empty() { Err(skipped("strace cannot trace")) } else { Ok(calls) })
}

/// Calls in a log of strace whose text names the output or work folder.
fn parse(log: &str) -> Vec<Call> {
    let mut counts: BTreeMap<(&str, &str), u64> = BTreeMap::new();
    let mut calls = Vec::new();
    for line in log.lines() {
        let Some((thread, text)) = line.split_once(' ') else { continue };
        let text = text.trim_start();
        let Some((name, _)) = text.split_once('(').filter(|(name, _)| !name.starts_with('<')) else { continue };
        let count = counts.entry((thread, name)).or_default();
        *count += 1;
        if ["out/", "work/", "/out>", "/work>"].iter().any(|part| text.contains(part)) {
            calls.push(Call { name: name.into(), number: *count, text: text.into() });
        }
    }
    calls
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_name_no_folder_of_a_machine() {
        let text = "openat(AT_FDCWD</x/case>, \"out/a\", O_DIRECTORY) = 8</x/case/out/a>";
        let expected = "openat(AT_FDCWD<.>, \"out/a\", O_DIRECTORY) = 8<out/a>";
        assert_eq!(without_folder(text, Path::new("/x/case")), expected);
    }

    #[test]
    fn calls_are_counted_by_thread() {
        let log = "7 openat(AT_FDCWD</x>, \"/lib/libc.so\") = 3\n\
                   7 openat(AT_FDCWD</x>, \"out/a.vtu\") = 3</x/out/a.vtu>\n\
                   8  write(3</x/out/a.vtu>, \"\", 5 <unfinished ...>\n\
                   8  <... write resumed>) = 5\n";
        let calls = parse(log);
        assert_eq!(calls.iter().map(|c| (&*c.name, c.number)).collect::<Vec<_>>(), [("openat", 2), ("write", 1)]);
    }
}
