//! Progress and time per stage.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use indicatif::ProgressBar;

use crate::cli::progress::{Lines, ProgressFormat, shows_bars, stage_bar};
use crate::cli::stop::Stop;
use crate::pipeline::StageTime;
use anastomesh_mesh::progress::{Progress, Stage};

/// Listens to a run: a bar per stage on a terminal, and the time that each takes.
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
    /// No bars when `quiet`, nor without a terminal.
    pub fn new(quiet: bool, told: Option<ProgressFormat>) -> Self {
        Self { shown: shows_bars(quiet, told), lines: Lines::asked_for(quiet, told), state: Mutex::default() }
    }

    /// Runs a stage of the program's own.
    pub fn time<T>(&self, stage: &'static str, run: impl FnOnce() -> T) -> T {
        self.enter(stage, 0, 0);
        let result = run();
        self.leave();
        result
    }

    /// A stage begins, where it is not the current one; the one before it ends.
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
            // What is done in one step has nothing to show but that it goes on.
            state.bar = Some(stage_bar(stage, if total > 1 { total } else { 0 }));
        }
    }

    /// The current stage ends.
    pub fn leave(&self) {
        if let Ok(mut state) = self.state.lock() {
            state.close();
        }
    }

    /// The stages in the order in which they began.
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

/// What the tetrahedralizer tells goes to a watch, what it asks to a signal.
#[derive(Clone)]
pub struct Listener(pub Arc<Watch>, pub Stop);

impl Progress for Listener {
    fn at(&self, stage: Stage, done: u64, total: u64) {
        let Self(watch, _) = self;
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
