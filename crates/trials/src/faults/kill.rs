//! Signals at random times.

use super::jobs::Job;
use super::trial::{Place, Trial, finding, place};
use crate::judge::{Judged, Outcome};
use crate::process::{Ended, ended};
use crate::random::Random;
use std::fs::{self, File};
use std::io;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Sends a signal at a random time of the run, and runs the job again.
pub fn judge(trial: &Trial, signal: &str, random: &mut Random) -> io::Result<Judged> {
    let errors = trial.folder.with_extension("stderr");
    let mut command = Command::new(trial.mesher);
    command.args(trial.job.arguments()).current_dir(trial.folder).stdout(Stdio::null()).stderr(File::create(&errors)?);
    // Half of the signals come in the last third, when files are written.
    let share = if random.chance(0.5) { random.between(0.66, 1.05) } else { random.unit() };
    let start = Instant::now();
    let mut child = command.spawn()?;
    let wait = Duration::from_secs_f64(share * trial.reference.seconds);
    while start.elapsed() < wait && child.try_wait()?.is_none() {
        std::thread::sleep(Duration::from_micros(200));
    }
    if child.try_wait()?.is_none() {
        Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status()?;
    }
    let end = ended(child.wait()?);
    let stderr = fs::read_to_string(errors)?;
    let outcome = match end {
        Ended::Code(code) => trial.after_code(code, &stderr, false)?,
        _ => after_signal(trial, &format!("{signal} {end:?}"))?,
    };
    let outcome = trial.again(outcome)?;
    Ok(Judged { outcome, seconds: start.elapsed().as_secs_f64(), stderr })
}

/// Outcome of a run that a signal has ended: it may leave temporary files, but no partial file at the output.
fn after_signal(trial: &Trial, end: &str) -> io::Result<Outcome> {
    let found = Job::output(trial.folder)?;
    let what = format!("{}, {end}", trial.job.line());
    Ok(match place(&found, &trial.earlier(), &trial.reference.new) {
        Place::Broken(text) => finding("partial file", format!("{what}: {text}")),
        Place::Mixed(text) => finding("mixed files", format!("{what}: {text}")),
        Place::New => Outcome::Valid { by_both: true },
        Place::Earlier => Outcome::Typed { code: 130, message: "ended by the signal, earlier files intact".into() },
    })
}
