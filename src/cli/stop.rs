//! Ctrl-C, and what asks a program to end: the first time a run ends where it may, the second time the program does.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

use super::exit::{Exit, Failure};

/// Whether the run is to end. Only verbs that ask listen: elsewhere the first Ctrl-C ends the program, as everywhere.
#[derive(Clone, Debug)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Begins to listen; unless `quiet`, the first time is answered at once.
    pub fn listen(quiet: bool) -> Result<Self, Failure> {
        let asked = Arc::new(AtomicBool::new(false));
        // SIGHUP stays as it is: a run under `nohup` goes on when its terminal is closed.
        for signal in [SIGINT, SIGTERM] {
            listen_to(signal, &asked, quiet).map_err(|e| Failure::stage(format!("Ctrl-C cannot be heard: {e}")))?;
        }
        Ok(Self(asked))
    }

    /// Whether the run is to end.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// In this order: the second signal finds the flag that the first one has set.
fn listen_to(signal: i32, asked: &Arc<AtomicBool>, quiet: bool) -> io::Result<()> {
    flag::register_conditional_shutdown(signal, i32::from(Exit::Stopped.code()), Arc::clone(asked))?;
    if !quiet {
        answer(signal)?;
    }
    flag::register(signal, Arc::clone(asked)).map(drop)
}

/// Says that the signal was heard: what is being done may take a moment to end.
#[cfg(unix)]
fn answer(signal: i32) -> io::Result<()> {
    use std::io::Read;
    let (mut heard, told) = std::os::unix::net::UnixStream::pair()?;
    low_level::pipe::register(signal, told)?;
    let wait = move || {
        if heard.read_exact(&mut [0]).is_ok() {
            eprintln!("anastomesh: stopping; Ctrl-C again ends at once");
        }
    };
    std::thread::Builder::new().spawn(wait).map(drop)
}

/// There is nothing here that a thread could wait for.
#[cfg(not(unix))]
fn answer(_: i32) -> io::Result<()> {
    Ok(())
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
