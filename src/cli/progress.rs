//! Progress: bars on a terminal, lines for the program that waits for this one.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::log;
use super::stop::Stop;
use crate::progress::{Progress, Stage};

/// How programs are told of progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ProgressFormat {
    /// A line of JSON each time
    Json,
}

/// Whether bars are shown: on a terminal only, where nobody is told in another way.
pub fn shows_bars(quiet: bool, told: Option<ProgressFormat>) -> bool {
    !quiet && told.is_none() && std::io::stderr().is_terminal()
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

/// Lines such as `{"progress":{"done":3,"stage":"blocks","total":120}}` on standard error.
#[derive(Debug, Default)]
pub struct Lines {
    last: Mutex<Option<(&'static str, u64, Instant)>>,
    unheard: AtomicBool,
}

/// A line is written no more often than this, but for the first and the last of a stage.
const LINE_EVERY: Duration = Duration::from_millis(50);

impl Lines {
    /// Lines, if that is how progress is told.
    pub fn asked_for(told: Option<ProgressFormat>) -> Option<Self> {
        told.map(|ProgressFormat::Json| Self::default())
    }

    /// So much of a stage is done; 0 in all: not known.
    pub fn tell(&self, stage: &'static str, done: u64, total: u64) {
        let Ok(mut last) = self.last.lock() else { return };
        let is_over = done > 0 && done == total;
        match *last {
            // Threads may tell in another order than that in which they count.
            Some((at, before, when))
                if at == stage && (done <= before || !(is_over || when.elapsed() >= LINE_EVERY)) =>
            {
                return;
            }
            _ => *last = Some((stage, done, Instant::now())),
        }
        let line = serde_json::json!({ "progress": { "stage": stage, "done": done, "total": total } });
        if writeln!(std::io::stderr().lock(), "{line}").is_err() {
            self.unheard.store(true, Ordering::Relaxed);
        }
    }

    /// Whether the program that was told is gone: then nobody waits for this one, either.
    pub fn is_unheard(&self) -> bool {
        self.unheard.load(Ordering::Relaxed)
    }
}

/// One bar per stage on standard error, and notes as lines; without a terminal only the notes.
#[derive(Debug)]
pub struct Bars {
    shown: bool,
    quiet: bool,
    lines: Option<Lines>,
    current: Mutex<Option<(Stage, ProgressBar)>>,
    stop: Stop,
}

impl Bars {
    /// `quiet` suppresses the notes as well.
    pub fn new(quiet: bool, told: Option<ProgressFormat>, stop: Stop) -> Self {
        let lines = Lines::asked_for(told);
        Self { shown: shows_bars(quiet, told), quiet, lines, current: Mutex::new(None), stop }
    }

    fn current(&self) -> Option<ProgressBar> {
        self.current.lock().ok()?.as_ref().map(|(_, bar)| bar.clone())
    }
}

impl Progress for Bars {
    fn at(&self, stage: Stage, done: u64, total: u64) {
        if let Some(lines) = &self.lines {
            lines.tell(stage.name(), done, total);
        }
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
            Some(bar) => bar.suspend(|| log::note(message)),
            None => log::note(message),
        }
    }

    fn is_cancelled(&self) -> bool {
        self.stop.is_asked() || self.lines.as_ref().is_some_and(Lines::is_unheard)
    }
}
