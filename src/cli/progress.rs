//! Progress: bars on a terminal, or JSON lines for a calling program.

use std::fmt;
use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::clock::elapsed;
use super::stop::Stop;
use super::{bar, colours, log};
use crate::pipeline::StageTime;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::units::{grouped, seconds_of};

/// Format of progress for programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ProgressFormat {
    /// JSON lines
    Json,
}

/// True if bars are shown: on a terminal, without another form of progress.
pub fn shows_bars(quiet: bool, told: Option<ProgressFormat>) -> bool {
    !quiet && told.is_none() && !log::is_json() && std::io::stderr().is_terminal()
}

/// Progress bar of a stage; 0 steps mean an unknown number.
pub fn stage_bar(stage: &'static str, steps: u64) -> ProgressBar {
    let (length, template) = match (steps, colours::are_wanted()) {
        (0, true) => (None, "{prefix:>10.cyan} {spinner:.green} {elapsed}"),
        (0, false) => (None, "{prefix:>10} {spinner} {elapsed}"),
        (n, true) => (Some(n), "{prefix:>10.cyan} {wide_bar:.green/dim} {percent:>3} %  {count}{msg}{left}"),
        (n, false) => (Some(n), "{prefix:>10} {wide_bar} {percent:>3} %  {count}{msg}{left}"),
    };
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr_with_hz(10));
    bar.set_style(style.with_key("count", write_count).with_key("left", write_left));
    bar.set_prefix(stage);
    bar.set_message(counted_in(stage));
    if length.is_none() {
        // Without steps, a timer moves the spinner.
        bar.enable_steady_tick(ALIVE);
    }
    super::bar::show(&bar);
    bar
}

/// Unit of the steps of a stage.
fn counted_in(stage: &str) -> &'static str {
    match stage {
        "blocks" | "clusters" | "connectors" => " tetrahedra",
        "move" => " iterations",
        _ => "",
    }
}

/// Interval of the spinner.
const ALIVE: Duration = Duration::from_millis(200);
/// Minimum running time of a stage before the remaining time is shown.
const KNOWN_AFTER: Duration = Duration::from_secs(1);

/// Writes the number of steps done and in total.
fn write_count(state: &ProgressState, out: &mut dyn fmt::Write) {
    let [done, all] = [state.pos(), state.len().unwrap_or(0)].map(|n| short(n as f64));
    // A write error of the terminal cannot be reported.
    let _ = write!(out, "{done} of {all}");
}

/// Writes the estimated remaining time.
fn write_left(state: &ProgressState, out: &mut dyn fmt::Write) {
    if state.elapsed() >= KNOWN_AFTER && state.pos() > 0 {
        let _ = write!(out, ", {} left", seconds_of(state.eta().as_secs_f64().max(1.0).round()));
    }
}

/// Formats a count with few digits.
fn short(count: f64) -> String {
    match count {
        n if n >= 1e7 => format!("{:.0} million", n / 1e6),
        n if n >= 1e6 => format!("{:.1} million", n / 1e6),
        n => grouped(n as usize),
    }
}

/// Lines such as `{"progress":{"done":3,"stage":"blocks","total":120}}` on standard error.
#[derive(Debug, Default)]
pub struct Lines {
    last: Mutex<Option<(&'static str, u64, Instant)>>,
    unheard: AtomicBool,
}

/// Minimum interval between lines, except for the first and last line of a stage.
const LINE_EVERY: Duration = Duration::from_millis(50);

impl Lines {
    /// Progress lines, if requested or if all messages are JSON.
    pub fn asked_for(quiet: bool, told: Option<ProgressFormat>) -> Option<Self> {
        (told.is_some() || (log::is_json() && !quiet)).then(Self::default)
    }

    /// Reports the steps done of a stage; a total of 0 means unknown.
    pub fn tell(&self, stage: &'static str, done: u64, total: u64) {
        let Ok(mut last) = self.last.lock() else { return };
        let is_over = done > 0 && done == total;
        match *last {
            // Threads may report out of order.
            Some((at, before, when))
                if at == stage && (done <= before || !(is_over || when.elapsed() >= LINE_EVERY)) =>
            {
                return;
            }
            _ => *last = Some((stage, done, Instant::now())),
        }
        if writeln!(std::io::stderr().lock(), "{}", log::progress(stage, done, total)).is_err() {
            self.unheard.store(true, Ordering::Relaxed);
        }
    }

    /// True if the pipe is closed: the calling program has ended.
    pub fn is_unheard(&self) -> bool {
        self.unheard.load(Ordering::Relaxed)
    }
}

/// One bar per stage on standard error, and notes as lines. Without a terminal, only notes.
#[derive(Debug)]
pub struct Bars {
    shown: bool,
    quiet: bool,
    lines: Option<Lines>,
    current: Mutex<Option<(Stage, ProgressBar)>>,
    times: Mutex<Times>,
    stop: Stop,
}

/// Wall time of the stages of all passes.
#[derive(Debug, Default)]
struct Times {
    spent: Vec<(Stage, Duration)>,
    current: Option<(Stage, Instant)>,
}

impl Times {
    fn add(&mut self, stage: Stage, time: Duration) {
        match self.spent.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, sum)) => *sum += time,
            None => self.spent.push((stage, time)),
        }
    }

    /// Records a progress report: a stage lasts until its end or the begin of another.
    fn at(&mut self, stage: Stage, is_over: bool) {
        if let Some((at, since)) = self.current
            && (at != stage || is_over)
        {
            self.add(at, since.elapsed());
            self.current = None;
        }
        if self.current.is_none() && !is_over {
            self.current = Some((stage, Instant::now()));
        }
    }
}

impl Bars {
    /// Creates the bars; `quiet` also suppresses notes.
    pub fn new(quiet: bool, told: Option<ProgressFormat>, stop: Stop) -> Self {
        let lines = Lines::asked_for(quiet, told);
        let mut times = Times::default();
        // Reading and repairs come before the bars.
        times.add(Stage::Read, elapsed());
        let (current, times) = (Mutex::new(None), Mutex::new(times));
        Self { shown: shows_bars(quiet, told), quiet, lines, current, times, stop }
    }

    /// Marks that the run writes results from here on, and stops on its own.
    pub fn keep(&self) {
        self.stop.keep();
    }

    /// Runs a stage without steps.
    pub fn during<T>(&self, stage: Stage, run: impl FnOnce() -> T) -> T {
        self.at(stage, 0, 0);
        let result = run();
        self.at(stage, 1, 1);
        result
    }

    /// Wall time of each stage so far, over all passes.
    pub fn stages(&self) -> Vec<StageTime> {
        let Ok(times) = self.times.lock() else { return Vec::new() };
        let time = |&(stage, time): &(Stage, Duration)| StageTime { stage: stage.name(), seconds: time.as_secs_f64() };
        times.spent.iter().map(time).collect()
    }
}

impl Progress for Bars {
    fn at(&self, stage: Stage, done: u64, total: u64) {
        if let Some(lines) = &self.lines {
            lines.tell(stage.name(), done, total);
        }
        let is_over = done > 0 && done == total;
        if let Ok(mut times) = self.times.lock() {
            times.at(stage, is_over);
        }
        let Ok(mut current) = self.current.lock() else { return };
        if self.stop.is_asked() {
            // The bar of a run that stops stays cleared.
            if current.take().is_some() {
                bar::clear();
            }
            return;
        }
        if !self.shown || (is_over && current.is_none()) {
            return;
        }
        if current.as_ref().is_none_or(|(at, _)| *at != stage) {
            *current = Some((stage, stage_bar(stage.name(), total)));
        }
        if let Some((_, bar)) = current.as_ref() {
            // Threads may report out of order.
            bar.set_position(done.max(bar.position()));
        }
        if is_over && current.take().is_some() {
            bar::clear();
        }
    }

    fn note(&self, message: &str) {
        if self.quiet {
            return;
        }
        log::note(message);
    }

    fn is_cancelled(&self) -> bool {
        self.stop.is_asked() || self.lines.as_ref().is_some_and(Lines::is_unheard)
    }
}
