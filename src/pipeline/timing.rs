//! Wall time per stage and per block.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use anastomesh_mesh::progress::{Progress, Stage};
use serde::Serialize;

/// Seconds of wall time per stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageTime {
    /// Name of the stage.
    pub stage: &'static str,
    /// Wall time, seconds.
    pub seconds: f64,
}

/// Sums up the time that each stage takes.
#[derive(Debug, Default)]
pub struct Clock {
    spent: Vec<(Stage, f64)>,
}

impl Clock {
    /// Runs a stage, and tells that it begins and ends.
    pub fn time<T>(&mut self, progress: &dyn Progress, stage: Stage, steps: u64, run: impl FnOnce() -> T) -> T {
        progress.at(stage, 0, steps);
        let start = Instant::now();
        let result = run();
        let seconds = start.elapsed().as_secs_f64();
        progress.at(stage, steps.max(1), steps.max(1));
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

/// Histogram of the times of blocks.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BlockTimes {
    /// Seconds of all clusters together.
    pub clusters: f64,
    /// Seconds of all connectors together.
    pub connectors: f64,
    /// The longest one: `cluster 12` or `connector 7`.
    pub longest: String,
    /// Seconds of the longest one.
    pub longest_seconds: f64,
    /// Number of blocks per bin: the first holds those below 2^-10 s, each further one those below twice as much.
    pub histogram: Vec<u64>,
}

impl BlockTimes {
    /// Adds the seconds of a block. Connectors are numbered after the clusters.
    fn add(&mut self, block: usize, clusters: usize, seconds: f64) {
        let connector = block.checked_sub(clusters);
        *(if connector.is_some() { &mut self.connectors } else { &mut self.clusters }) += seconds;
        if seconds > self.longest_seconds {
            self.longest_seconds = seconds;
            self.longest = connector.map_or_else(|| format!("cluster {block}"), |k| format!("connector {k}"));
        }
        let bin = (libm::log2(seconds) + 11.0).clamp(0.0, 63.0) as usize;
        self.histogram.resize(self.histogram.len().max(bin + 1), 0);
        self.histogram[bin] += 1;
    }
}

/// Takes the time of blocks that are made on all threads.
#[derive(Debug)]
pub struct Stopwatch {
    times: Mutex<BlockTimes>,
    clusters: usize,
}

impl Stopwatch {
    /// Stopwatch for the blocks of a partition with this number of clusters. `before`: times of earlier rounds.
    pub fn new(before: BlockTimes, clusters: usize) -> Self {
        Self { times: Mutex::new(before), clusters }
    }

    /// Does something for a block.
    pub fn time<T>(&self, block: usize, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let made = work();
        let seconds = start.elapsed().as_secs_f64();
        self.times.lock().unwrap_or_else(PoisonError::into_inner).add(block, self.clusters, seconds);
        made
    }

    pub fn times(self) -> BlockTimes {
        self.times.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_counted_by_powers_of_two() {
        let mut times = BlockTimes::default();
        for (block, seconds) in [0.0, 0.0015, 0.3, 0.001].into_iter().enumerate() {
            times.add(block, 2, seconds);
        }
        assert_eq!(times.histogram, [1, 2, 0, 0, 0, 0, 0, 0, 0, 1]);
        assert_eq!((times.longest.as_str(), times.longest_seconds), ("connector 0", 0.3));
        assert!((times.clusters - 0.0015).abs() < 1e-12 && (times.connectors - 0.301).abs() < 1e-12);
    }
}
