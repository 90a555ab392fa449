//! Disks that are full or read-only, and limits on files.

use super::jobs::{Files, LIMITS, write_files};
use super::trial::{Trial, finding, skipped};
use crate::judge::{Judged, Outcome};
use crate::process::{Ended, Run, run_command};
use crate::random::Random;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

/// Runs a quiet command; true on success.
fn succeeds(program: &str, arguments: &[&str]) -> bool {
    let status = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

/// Unmounts the folders of a trial that a fault has mounted.
pub fn unmount(folder: &Path) {
    for name in ["out", "work"] {
        let place = folder.join(name);
        let mounts = std::fs::read_to_string("/proc/mounts").unwrap_or_default();
        if mounts.lines().any(|line| line.split(' ').nth(1) == place.to_str()) {
            succeeds("umount", &[&place.to_string_lossy()]);
        }
    }
}

/// Mounts a file system in memory with this size.
fn mount(place: &Path, bytes: u64) -> bool {
    let _ = std::fs::create_dir_all(place);
    succeeds("mount", &["-t", "tmpfs", "-o", &format!("size={bytes}"), "tmpfs", &place.to_string_lossy()])
}

fn size(files: &Files) -> u64 {
    // Each file and folder takes whole pages.
    files.values().map(|bytes| (bytes.len() as u64).div_ceil(4096) * 4096 + 4096).sum()
}

/// Output folder, or work folder, on a file system with little space.
pub fn full(trial: &Trial, random: &mut Random) -> io::Result<Judged> {
    let has_work = trial.job.line().contains("--work-dir");
    let name = if has_work && random.chance(0.5) { "work" } else { "out" };
    let place = trial.folder.join(name);
    let before = if name == "out" { size(&trial.earlier()) } else { 0 };
    let room = 8192 + (random.unit() * 1.1 * size(&trial.reference.new) as f64) as u64;
    if !mount(&place, before + room) {
        return Ok(skipped("no file system can be mounted"));
    }
    if name == "out" {
        write_files(&place, &trial.earlier())?;
    }
    let run = run_command(command(trial), trial.folder, LIMITS)?;
    let outcome = outcome(trial, &run)?;
    let outcome = if succeeds("mount", &["-o", "remount,size=1g", &place.to_string_lossy()]) {
        trial.again(outcome)?
    } else {
        outcome
    };
    Ok(Judged { outcome, seconds: run.seconds, stderr: run.stderr })
}

/// Output folder on a read-only file system.
pub fn read_only(trial: &Trial) -> io::Result<Judged> {
    let place = trial.folder.join("out");
    if !mount(&place, 1 << 28) {
        return Ok(skipped("no file system can be mounted"));
    }
    write_files(&place, &trial.earlier())?;
    if !succeeds("mount", &["-o", "remount,ro", &place.to_string_lossy()]) {
        return Ok(skipped("no file system can be made read-only"));
    }
    let run = run_command(command(trial), trial.folder, LIMITS)?;
    let mut outcome = outcome(trial, &run)?;
    if matches!(outcome, Outcome::Valid { .. }) {
        outcome = finding("incomplete success", format!("{}: success on a read-only disk", trial.job.line()));
    }
    Ok(Judged { outcome, seconds: run.seconds, stderr: run.stderr })
}

/// Limit on the size of each file. The signal is ignored, so that writes fail after a short one.
pub fn file_size(trial: &Trial, random: &mut Random) -> io::Result<Judged> {
    let largest = trial.reference.new.values().map(Vec::len).max().unwrap_or(0);
    // Messages have a file, too, and need some room.
    let blocks = 8 + (random.unit() * 1.1 * largest as f64 / 512.0) as u64;
    let mut command = Command::new("sh");
    command.args(["-c", "trap '' XFSZ; ulimit -f \"$0\"; exec \"$@\"", &blocks.to_string()]);
    command.arg(trial.mesher).args(trial.job.arguments());
    let run = run_command(command, trial.folder, LIMITS)?;
    let outcome = trial.again(outcome(trial, &run)?)?;
    Ok(Judged { outcome, seconds: run.seconds, stderr: run.stderr })
}

fn command(trial: &Trial) -> Command {
    let mut command = Command::new(trial.mesher);
    command.args(trial.job.arguments());
    command
}

/// Outcome of a run on a faulty disk.
pub fn outcome(trial: &Trial, run: &Run) -> io::Result<Outcome> {
    match run.ended {
        Ended::Code(code) => trial.after_code(code, &run.stderr, false),
        _ => Ok(finding("signal", format!("{}: {:?} {}", trial.job.line(), run.ended, run.stderr.trim()))),
    }
}
