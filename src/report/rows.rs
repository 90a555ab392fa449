//! Rows of the terminal summary: a label and a text, with files, time and memory of every command.

use crate::pipeline::StageTime;
use anastomesh_mesh::units::{bytes_of, seconds_of};

/// Minimum fraction of the total time for a stage to be listed.
const MENTIONED: f64 = 0.05;
/// Minimum time for a stage to be listed, in seconds.
const NOTICED: f64 = 0.05;
/// Maximum number of listed stages.
const STAGES: usize = 3;

/// Formats a row.
pub fn row(what: &str, text: &str) -> String {
    format!("{what:<8} {text}\n")
}

/// Outcome of a command: files with their sizes in bytes, time in seconds, and peak memory in bytes if known.
#[derive(Clone, Debug, Default)]
pub struct Ended {
    pub files: Vec<(String, u64)>,
    pub seconds: f64,
    pub memory: Option<u64>,
}

impl Ended {
    /// One row per file, and one for time and memory with the longest stages.
    pub fn rows(&self, stages: &[StageTime]) -> String {
        let file = |(name, bytes): &(String, u64)| row("file", &format!("{name} ({})", bytes_of(*bytes)));
        let files: String = self.files.iter().map(file).collect();
        files + &row("time", &self.time(stages))
    }

    fn time(&self, stages: &[StageTime]) -> String {
        let mut longest: Vec<StageTime> = Vec::new();
        for stage in stages {
            match longest.iter_mut().find(|known| known.stage == stage.stage) {
                Some(known) => known.seconds += stage.seconds,
                None => longest.push(stage.clone()),
            }
        }
        longest.retain(|stage| stage.seconds >= NOTICED.max(MENTIONED * self.seconds));
        longest.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        let told: Vec<String> =
            longest.iter().take(STAGES).map(|s| format!("{} {}", s.stage, seconds_of(s.seconds))).collect();
        let stages = if told.is_empty() { String::new() } else { format!(" ({})", told.join(", ")) };
        let memory = self.memory.map_or_else(String::new, |bytes| format!("; max memory {}", bytes_of(bytes)));
        format!("{}{stages}{memory}", seconds_of(self.seconds))
    }
}
