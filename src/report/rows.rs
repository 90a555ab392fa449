//! Rows of what the terminal shows in the end: a word and what there is to say of it; files, time and memory of every verb.

use crate::pipeline::StageTime;
use anastomesh_mesh::units::{bytes_of, seconds_of};

/// Stages that took a smaller share of the time are not mentioned.
const MENTIONED: f64 = 0.05;
/// Nor are those that took less than so many seconds.
const NOTICED: f64 = 0.05;
/// Stages that are mentioned.
const STAGES: usize = 3;

/// A row.
pub fn row(what: &str, text: &str) -> String {
    format!("{what:<8} {text}\n")
}

/// What a verb leaves behind: files and their sizes in bytes, seconds that it took, and the most bytes of memory that were in use,
/// where the system tells.
#[derive(Clone, Debug, Default)]
pub struct Ended {
    pub files: Vec<(String, u64)>,
    pub seconds: f64,
    pub memory: Option<u64>,
}

impl Ended {
    /// A row for each file, and one for time and memory with the longest stages.
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
        // Reading, refining, and meshes that were made before this one.
        let staged: f64 = longest.iter().map(|stage| stage.seconds).sum();
        if !longest.is_empty() {
            longest.push(StageTime { stage: "beforehand", seconds: self.seconds - staged });
        }
        longest.retain(|stage| stage.seconds >= NOTICED.max(MENTIONED * self.seconds));
        longest.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        let told: Vec<String> =
            longest.iter().take(STAGES).map(|s| format!("{} {}", s.stage, seconds_of(s.seconds))).collect();
        let stages = if told.is_empty() { String::new() } else { format!(" ({})", told.join(", ")) };
        let memory = self.memory.map_or_else(String::new, |bytes| format!("; {} of memory at most", bytes_of(bytes)));
        format!("{}{stages}{memory}", seconds_of(self.seconds))
    }
}
