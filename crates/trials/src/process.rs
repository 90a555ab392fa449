//! Runs programs with limits of time and memory.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Limits of a run.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Processor time in seconds. Other programs on the machine do not count.
    pub seconds: f64,
    /// Resident memory in bytes.
    pub bytes: u64,
}

/// End of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// Exit code.
    Code(i32),
    /// Signal that ended the program.
    Signal(i32),
    /// Killed at the limit of time.
    TooLong,
    /// Killed at the limit of memory, or an allocation failed.
    TooMuchMemory,
}

/// End, messages and cost of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// End.
    pub ended: Ended,
    /// Standard error.
    pub stderr: String,
    /// Standard output.
    pub stdout: String,
    /// Processor time in seconds, at least.
    pub seconds: f64,
    /// Largest resident memory seen, in bytes.
    pub bytes: u64,
}

/// Wall time of a run relative to its limit of processor time, after which it counts as hanging.
const WALL_FACTOR: f64 = 5.0;

/// Runs a program in a folder. Its output goes to files beside the folder, so that no pipe fills.
pub fn run(program: &Path, arguments: &[String], folder: &Path, limits: Limits) -> io::Result<Run> {
    let mut command = Command::new(program);
    command.args(arguments);
    run_command(command, folder, limits)
}

/// Runs a prepared command in a folder.
pub fn run_command(mut command: Command, folder: &Path, limits: Limits) -> io::Result<Run> {
    let [out, err] = ["stdout", "stderr"].map(|name| folder.with_extension(name));
    command.current_dir(folder).stdin(Stdio::null()).stdout(File::create(&out)?).stderr(File::create(&err)?);
    let mut child = command.spawn()?;
    let (status, usage) = watch(&mut child, limits)?;
    let [stdout, stderr] =
        [out, err].map(|path| fs::read(path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()));
    let (stdout, stderr) = (stdout?, stderr?);
    let ended = match usage.over {
        Some(over) => over,
        None if stderr.contains("memory allocation of") => Ended::TooMuchMemory,
        None => ended(status),
    };
    Ok(Run { ended, stderr, stdout, seconds: usage.seconds, bytes: usage.bytes })
}

/// Exit code or signal.
pub fn ended(status: ExitStatus) -> Ended {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return Ended::Signal(signal);
    }
    Ended::Code(status.code().unwrap_or(-1))
}

#[derive(Default)]
struct Usage {
    seconds: f64,
    bytes: u64,
    over: Option<Ended>,
}

fn watch(child: &mut Child, limits: Limits) -> io::Result<(ExitStatus, Usage)> {
    let (start, mut usage, mut pause) = (Instant::now(), Usage::default(), Duration::from_micros(500));
    loop {
        let (seconds, bytes) = used(child.id());
        usage.seconds = usage.seconds.max(seconds);
        usage.bytes = usage.bytes.max(bytes);
        if let Some(status) = child.try_wait()? {
            // Short runs end before the clock of the system ticks.
            usage.seconds = usage.seconds.max(start.elapsed().as_secs_f64().min(0.05));
            return Ok((status, usage));
        }
        let is_late = start.elapsed().as_secs_f64() > WALL_FACTOR * limits.seconds;
        if usage.seconds > limits.seconds || is_late {
            usage.over = Some(Ended::TooLong);
        } else if usage.bytes > limits.bytes {
            usage.over = Some(Ended::TooMuchMemory);
        }
        if usage.over.is_some() {
            child.kill()?;
            return Ok((child.wait()?, usage));
        }
        std::thread::sleep(pause);
        pause = (pause * 5 / 4).min(Duration::from_millis(10));
    }
}

/// Processor seconds and peak resident bytes of a process, from `/proc`; zeros elsewhere.
fn used(id: u32) -> (f64, u64) {
    let stat = fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
    // The second field is the name in parentheses, which may have spaces.
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks: u64 = [11, 12].iter().filter_map(|i| fields.get(*i)?.parse::<u64>().ok()).sum();
    let status = fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse().ok());
    // Linux counts 100 ticks a second on all processors.
    (ticks as f64 / 100.0, peak.unwrap_or(0_u64) * 1024)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    fn shell(text: &str, limits: Limits) -> Run {
        let folder = tempfile::tempdir().expect("a folder");
        let inner = folder.path().join("case");
        fs::create_dir(&inner).expect("a folder");
        run(Path::new("sh"), &["-c".into(), text.into()], &inner, limits).expect("a run")
    }

    #[test]
    fn ends_are_told() {
        let limits = Limits { seconds: 5.0, bytes: 1 << 30 };
        let run = shell("echo no >&2; exit 3", limits);
        assert_eq!((run.ended, &*run.stderr), (Ended::Code(3), "no\n"));
        assert_eq!(shell("kill -9 $$", limits).ended, Ended::Signal(9));
        assert_eq!(
            shell("echo memory allocation of 9 bytes failed >&2; kill -6 $$", limits).ended,
            Ended::TooMuchMemory
        );
    }

    #[test]
    fn limits_are_kept() {
        let busy = Limits { seconds: 0.3, bytes: 1 << 30 };
        assert_eq!(shell("while :; do :; done", busy).ended, Ended::TooLong);
        let idle = Limits { seconds: 0.05, bytes: 1 << 30 };
        assert_eq!(shell("exec sleep 20", idle).ended, Ended::TooLong);
        let small = Limits { seconds: 5.0, bytes: 1 << 12 };
        assert_eq!(shell("while :; do :; done", small).ended, Ended::TooMuchMemory);
    }
}
