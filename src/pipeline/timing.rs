//! Wall time per stage.

use std::time::Instant;

use super::observer::{Observer, Stage};
use super::report::StageTime;

/// Sums up the time that each stage takes.
#[derive(Debug, Default)]
pub struct Clock {
    spent: Vec<(Stage, f64)>,
}

impl Clock {
    /// Runs a stage, telling the observer of its begin and end.
    pub fn time<T>(&mut self, observer: &dyn Observer, stage: Stage, steps: u64, run: impl FnOnce() -> T) -> T {
        observer.begin(stage, steps);
        let start = Instant::now();
        let result = run();
        let seconds = start.elapsed().as_secs_f64();
        observer.end(stage);
        match self.spent.iter_mut().find(|(s, _)| *s == stage) {
            Some((_, sum)) => *sum += seconds,
            None => self.spent.push((stage, seconds)),
        }
        result
    }

    /// The stages in the order in which they began.
    pub fn stages(&self) -> Vec<StageTime> {
        self.spent.iter().map(|&(stage, seconds)| StageTime { stage: stage.name(), seconds }).collect()
    }
}
