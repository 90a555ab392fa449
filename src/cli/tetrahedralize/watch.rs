//! Progress and time per stage.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use indicatif::ProgressBar;

use crate::cli::bar;
use crate::cli::progress::{Lines, ProgressFormat, shows_bars, stage_bar};
use crate::cli::stop::Stop;
use crate::pipeline::StageTime;
use anastomesh_mesh::progress::{Progress, Stage};

/// Progress listener: one bar per stage on a terminal, and the time of each stage.
#[derive(Debug)]
pub struct Watch {
    shown: bool,
    lines: Option<Lines>,
    state: Mutex<WatchState>,
}

#[derive(Debug, Default)]
struct WatchState {
    spent: Vec<StageTime>,
    current: Option<(&'static str, Instant)>,
    bar: Option<ProgressBar>,
}

impl Watch {
    /// Creates the listener. No bars are shown if `quiet` or without a terminal.
    pub fn new(quiet: bool, told: Option<ProgressFormat>) -> Self {
        Self { shown: shows_bars(quiet, told), lines: Lines::asked_for(quiet, told), state: Mutex::default() }
    }

    /// Runs a stage and records its time.
    pub fn time<T>(&self, stage: &'static str, run: impl FnOnce() -> T) -> T {
        self.enter(stage, 0, 0);
        let result = run();
        self.leave();
        result
    }

    /// Begins a stage unless it is the current one, and ends the previous one.
    fn enter(&self, stage: &'static str, done: u64, total: u64) {
        if let Some(lines) = &self.lines {
            lines.tell(stage, done, total);
        }
        let Ok(mut state) = self.state.lock() else { return };
        if state.current.is_some_and(|(name, _)| name == stage) {
            if let Some(bar) = state.bar.as_ref().filter(|_| total > 1) {
                bar.set_length(total);
            }
            return;
        }
        state.close();
        state.current = Some((stage, Instant::now()));
        if self.shown {
            // A stage of one step shows a spinner.
            state.bar = Some(stage_bar(stage, if total > 1 { total } else { 0 }));
        }
    }

    /// Ends the current stage.
    pub fn leave(&self) {
        if let Ok(mut state) = self.state.lock() {
            state.close();
        }
    }

    /// Stages in order of their start.
    pub fn stages(&self) -> Vec<StageTime> {
        self.state.lock().map(|state| state.spent.clone()).unwrap_or_default()
    }
}

impl WatchState {
    fn close(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        let Some((stage, start)) = self.current.take() else { return };
        let seconds = start.elapsed().as_secs_f64();
        match self.spent.iter_mut().find(|entry| entry.stage == stage) {
            Some(entry) => entry.seconds += seconds,
            None => self.spent.push(StageTime { stage, seconds }),
        }
    }
}

/// Listener of the tetrahedralizer: forwards progress to a watch, and stop requests from a signal.
#[derive(Clone)]
pub struct Listener(pub Arc<Watch>, pub Stop);

impl Progress for Listener {
    fn at(&self, stage: Stage, done: u64, total: u64) {
        let Self(watch, stop) = self;
        if stop.is_asked() {
            // The bar of a run that stops stays cleared.
            bar::clear();
            return;
        }
        watch.enter(stage.name(), done, total);
        if let Ok(state) = watch.state.lock()
            && let Some(bar) = &state.bar
        {
            bar.set_position(done);
        }
    }

    fn is_cancelled(&self) -> bool {
        let Self(watch, stop) = self;
        stop.is_asked() || watch.lines.as_ref().is_some_and(Lines::is_unheard)
    }
}
