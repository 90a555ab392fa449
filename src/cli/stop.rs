//! Ctrl-C, and what asks a program to end: the first time a run ends where it may, the second time the program does.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(unix)]
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
#[cfg(unix)]
use signal_hook::low_level;

use super::exit::{Exit, Failure};
use super::log;

/// How long a run that keeps nothing may take to end by itself: some stages are long and do not ask.
#[cfg(unix)]
const PATIENCE: Duration = Duration::from_secs(1);

/// What is said of a run that keeps nothing.
pub const NOTHING_KEPT: &str = "stopped; nothing is kept, and no file is touched";

/// Whether the run is to end. Only verbs that ask listen: elsewhere the first Ctrl-C ends the program, as everywhere.
#[derive(Clone, Debug)]
pub struct Stop {
    asked: Arc<AtomicBool>,
    /// Whether there is something that only the run itself can end well.
    keeps: Arc<AtomicBool>,
}

impl Stop {
    /// Begins to listen, for a run that leaves nothing before it calls [`Stop::keep`]. Unless `quiet`, the first signal is
    /// answered at once.
    pub fn listen(quiet: bool) -> Result<Self, Failure> {
        let stop = Self::deaf();
        // SIGHUP stays as it is: a run under `nohup` goes on when its terminal is closed.
        for signal in [SIGINT, SIGTERM] {
            let listens = stop.listen_to(signal).and_then(|()| stop.answer(signal, quiet));
            listens.map_err(|e| Failure::stage(format!("Ctrl-C cannot be heard: {e}")))?;
        }
        Ok(stop)
    }

    /// One that is never asked: for verbs that the first Ctrl-C ends.
    pub fn deaf() -> Self {
        Self { asked: Arc::default(), keeps: Arc::default() }
    }

    /// From here on the run ends by itself alone: it writes, or keeps what it has done.
    pub fn keep(&self) {
        self.keeps.store(true, Ordering::SeqCst);
    }

    /// Whether the run is to end.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// In this order: the second signal finds the flag that the first one has set.
    fn listen_to(&self, signal: i32) -> io::Result<()> {
        flag::register_conditional_shutdown(signal, i32::from(Exit::Stopped.code()), Arc::clone(&self.asked))?;
        flag::register(signal, Arc::clone(&self.asked)).map(drop)
    }

    /// Says that the signal was heard, and ends a run that keeps nothing when it takes too long to end by itself.
    #[cfg(unix)]
    fn answer(&self, signal: i32, quiet: bool) -> io::Result<()> {
        use std::io::Read;
        let (mut heard, told) = std::os::unix::net::UnixStream::pair()?;
        low_level::pipe::register(signal, told)?;
        let Self { asked, keeps } = self.clone();
        let wait = move || {
            // A signal may have come before the thread.
            if !asked.load(Ordering::SeqCst) && heard.read_exact(&mut [0]).is_err() {
                return;
            }
            if !quiet {
                log::note("anastomesh: stopping; Ctrl-C again ends at once");
            }
            std::thread::sleep(PATIENCE);
            if !keeps.load(Ordering::SeqCst) {
                log::error(NOTHING_KEPT);
                low_level::exit(Exit::Stopped.code().into());
            }
        };
        std::thread::Builder::new().spawn(wait).map(drop)
    }

    /// There is nothing here that a thread could wait for: a second Ctrl-C ends what does not ask.
    #[cfg(not(unix))]
    fn answer(&self, _: i32, _: bool) -> io::Result<()> {
        Ok(())
    }
}

/// What was typed, to be typed again.
pub fn command_line() -> String {
    let words = std::env::args_os().map(|word| quoted(&word.to_string_lossy()));
    words.collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it.
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
