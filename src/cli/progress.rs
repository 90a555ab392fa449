//! Progress bars, on a terminal only.

use std::io::IsTerminal;
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::stop::Stop;
use crate::progress::{Progress, Stage};

/// Whether bars are shown: on a terminal only.
pub fn shows_bars(quiet: bool) -> bool {
    !quiet && std::io::stderr().is_terminal()
}

/// The bar of a stage; 0 steps: their number is not known.
pub fn stage_bar(stage: &'static str, steps: u64) -> ProgressBar {
    let (length, template) = match steps {
        0 => (None, "{prefix:>10} {spinner} {elapsed}"),
        n => (Some(n), "{prefix:>10} {wide_bar} {percent} % {human_pos}/{human_len} {per_sec} {eta}"),
    };
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr_with_hz(10));
    bar.set_style(style);
    bar.set_prefix(stage);
    bar
}

/// One bar per stage on standard error, and notes as lines; without a terminal only the notes.
#[derive(Debug)]
pub struct Bars {
    shown: bool,
    quiet: bool,
    current: Mutex<Option<(Stage, ProgressBar)>>,
    stop: Stop,
}

impl Bars {
    /// `quiet` suppresses the notes as well.
    pub fn new(quiet: bool, stop: Stop) -> Self {
        Self { shown: shows_bars(quiet), quiet, current: Mutex::new(None), stop }
    }

    fn current(&self) -> Option<ProgressBar> {
        self.current.lock().ok()?.as_ref().map(|(_, bar)| bar.clone())
    }
}

impl Progress for Bars {
    fn at(&self, stage: Stage, done: u64, total: u64) {
        let Ok(mut current) = self.current.lock() else { return };
        let is_over = done > 0 && done == total;
        if !self.shown || (is_over && current.is_none()) {
            return;
        }
        if current.as_ref().is_none_or(|(at, _)| *at != stage) {
            *current = Some((stage, stage_bar(stage.name(), total)));
        }
        if let Some((_, bar)) = current.as_ref() {
            // Threads may tell in another order than that in which they count.
            bar.set_position(done.max(bar.position()));
        }
        if is_over && let Some((_, bar)) = current.take() {
            bar.finish_and_clear();
        }
    }

    fn note(&self, message: &str) {
        if self.quiet {
            return;
        }
        match self.current() {
            Some(bar) => bar.suspend(|| eprintln!("{message}")),
            None => eprintln!("{message}"),
        }
    }

    fn is_cancelled(&self) -> bool {
        self.stop.is_asked()
    }
}
