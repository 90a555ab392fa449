//! Signals: the first Ctrl-C stops the run at the next safe point, the second ends the program.

use std::borrow::Cow;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
#[cfg(unix)]
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
#[cfg(unix)]
use signal_hook::low_level;

use super::bar;
use super::exit::{Exit, Failure};
use super::log;

/// Time until a run that writes no results is ended after a signal. Some stages do not check for it. Finished blocks survive
/// that: a work directory recovers from a kill at any time.
#[cfg(unix)]
const PATIENCE: Duration = Duration::from_secs(1);

/// Message on stopping a run without stored results.
pub const NOTHING_KEPT: &str = "stopped; nothing is kept, and no file was changed";

/// Stop request. Only commands that check it listen; in others the first Ctrl-C ends the program.
#[derive(Clone, Debug)]
pub struct Stop {
    asked: Arc<AtomicBool>,
    /// True if only the run itself can stop safely, as it writes results.
    keeps: Arc<AtomicBool>,
    /// Message if the run is ended.
    last_words: Arc<Mutex<Cow<'static, str>>>,
}

impl Stop {
    /// Installs the signal handlers. The run must not write results before it calls [`Stop::keep`]. Unless `quiet`, the
    /// first signal is acknowledged.
    pub fn listen(quiet: bool) -> Result<Self, Failure> {
        let stop = Self::deaf();
        // SIGHUP is not handled: a run under `nohup` continues when its terminal closes.
        for signal in [SIGINT, SIGTERM] {
            let listens = stop.listen_to(signal).and_then(|()| stop.answer(signal, quiet));
            listens.map_err(|e| Failure::stage(format!("signal handler cannot be installed: {e}")))?;
        }
        Ok(stop)
    }

    /// Request that is never set, for commands that the first Ctrl-C ends.
    pub fn deaf() -> Self {
        let last_words = Arc::new(Mutex::new(Cow::Borrowed(NOTHING_KEPT)));
        Self { asked: Arc::default(), keeps: Arc::default(), last_words }
    }

    /// Marks that the run writes results, and must stop on its own.
    pub fn keep(&self) {
        self.keeps.store(true, Ordering::SeqCst);
    }

    /// Sets the message if the run is ended.
    pub fn explain(&self, last_words: String) {
        *self.last_words.lock().unwrap_or_else(PoisonError::into_inner) = last_words.into();
    }

    /// True if a stop was requested.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// Registers the flag. In this order, the second signal sees the flag that the first one has set.
    fn listen_to(&self, signal: i32) -> io::Result<()> {
        flag::register_conditional_shutdown(signal, i32::from(Exit::Stopped.code()), Arc::clone(&self.asked))?;
        flag::register(signal, Arc::clone(&self.asked)).map(drop)
    }

    /// Acknowledges the signal, and ends a run without results that does not stop in time.
    #[cfg(unix)]
    fn answer(&self, signal: i32, quiet: bool) -> io::Result<()> {
        use std::io::Read;
        let (mut heard, told) = std::os::unix::net::UnixStream::pair()?;
        low_level::pipe::register(signal, told)?;
        let Self { asked, keeps, last_words } = self.clone();
        let wait = move || {
            // The signal may arrive before the thread starts.
            if !asked.load(Ordering::SeqCst) && heard.read_exact(&mut [0]).is_err() {
                return;
            }
            bar::clear();
            if !quiet {
                log::note("stopping; press Ctrl-C again to end immediately");
            }
            std::thread::sleep(PATIENCE);
            if !keeps.load(Ordering::SeqCst) {
                bar::clear();
                log::error(&last_words.lock().unwrap_or_else(PoisonError::into_inner));
                low_level::exit(Exit::Stopped.code().into());
            }
        };
        std::thread::Builder::new().spawn(wait).map(drop)
    }

    /// Without Unix signals, a second Ctrl-C ends the program.
    #[cfg(not(unix))]
    fn answer(&self, _: i32, _: bool) -> io::Result<()> {
        Ok(())
    }
}

/// Command line in a form that can be entered again.
pub fn command_line() -> String {
    let words = std::env::args_os().map(|word| quoted(&word.to_string_lossy()));
    words.collect::<Vec<_>>().join(" ")
}

/// Quotes a word for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_a_shell() {
        assert_eq!(quoted("a/b-1.vtp"), "a/b-1.vtp");
        assert_eq!(quoted("my tree"), "'my tree'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
