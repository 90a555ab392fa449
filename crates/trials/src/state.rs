//! State file: one JSON line per batch, so that a run continues where the last one ended.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Finding of a batch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Seed of the case.
    pub seed: u64,
    /// Sort.
    pub sort: String,
    /// Details.
    pub text: String,
}

/// Results of consecutive seeds of a kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    /// Family and name of the kind.
    pub kind: String,
    /// First seed.
    pub first: u64,
    /// Number of seeds.
    pub count: u64,
    /// Cases that are valid by both checkers. Of faults, cases whose files are complete.
    pub valid: u64,
    /// Cases that are valid by `check` and have cells that the second checker does not read.
    pub valid_by_one: u64,
    /// Typed errors: exit code and message, with their number.
    pub typed: BTreeMap<String, u64>,
    /// Findings.
    pub findings: Vec<Finding>,
    /// Longest time of a case, in processor seconds.
    pub worst: f64,
    /// Seed of the longest case.
    pub worst_seed: u64,
    /// True if the batch repeats earlier findings with another build.
    pub repeats: bool,
    /// Version and build of the program.
    pub version: String,
    /// Day.
    pub date: String,
}

impl Batch {
    /// Line of the state file.
    pub fn line(&self) -> String {
        let findings: Vec<Value> =
            self.findings.iter().map(|f| json!({"seed": f.seed, "sort": f.sort, "text": f.text})).collect();
        json!({
            "kind": self.kind, "first": self.first, "count": self.count, "valid": self.valid,
            "valid_by_one": self.valid_by_one, "typed": self.typed, "findings": findings, "worst_s": self.worst,
            "worst_seed": self.worst_seed, "repeats": self.repeats, "version": self.version, "date": self.date,
        })
        .to_string()
    }

    /// Batch of a line; `None` if the line is cut or of another program.
    pub fn of_line(line: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(line).ok()?;
        let number = |key: &str| value[key].as_u64();
        let text = |value: &Value| value.as_str().map(str::to_owned);
        let typed = value["typed"].as_object()?.iter().map(|(message, count)| Some((message.clone(), count.as_u64()?)));
        let findings = value["findings"]
            .as_array()?
            .iter()
            .map(|f| Some(Finding { seed: f["seed"].as_u64()?, sort: text(&f["sort"])?, text: text(&f["text"])? }));
        Some(Self {
            kind: text(&value["kind"])?,
            first: number("first")?,
            count: number("count")?,
            valid: number("valid")?,
            valid_by_one: number("valid_by_one")?,
            typed: typed.collect::<Option<_>>()?,
            findings: findings.collect::<Option<_>>()?,
            worst: value["worst_s"].as_f64()?,
            worst_seed: number("worst_seed")?,
            repeats: value["repeats"].as_bool()?,
            version: text(&value["version"])?,
            date: text(&value["date"])?,
        })
    }
}

/// Reads all batches. A line that was cut by a killed run is skipped.
pub fn read(path: &Path) -> io::Result<Vec<Batch>> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(text.lines().filter_map(Batch::of_line).collect()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(error),
    }
}

/// Appends a batch.
pub fn append(path: &Path, batch: &Batch) -> io::Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder)?;
    }
    let mut file = OpenOptions::new().create(true).append(true).open(path)?;
    // The line break before the text ends a line that a killed run has cut.
    let starts = file.metadata()?.len() == 0;
    let text = if starts { batch.line() } else { format!("\n{}", batch.line()) };
    file.write_all(text.as_bytes())
}

/// First seed that no batch of a kind has tried.
pub fn next_seed(batches: &[Batch], kind: &str) -> u64 {
    batches.iter().filter(|batch| batch.kind == kind && !batch.repeats).map(|b| b.first + b.count).max().unwrap_or(0)
}

/// Day in the form 2026-01-31, in UTC (Hinnant's `civil_from_days`).
pub fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let days = (seconds / 86_400) as i64 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let (day, month) = (day_of_year - (153 * shifted + 2) / 5 + 1, (shifted + 2) % 12 + 1);
    let year = year_of_era + 400 * era + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_survive_a_cut_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("state/trials.jsonl");
        let mut batch = Batch { kind: "a/b".into(), first: 5, count: 3, worst: 0.25, ..Batch::default() };
        batch.typed.insert("3: no".into(), 2);
        batch.findings.push(Finding { seed: 6, sort: "panic".into(), text: "at \"x\"".into() });
        append(&path, &batch).expect("written");
        let mut file = OpenOptions::new().append(true).open(&path).expect("a file");
        file.write_all(b"\n{\"kind\": \"a/").expect("written");
        append(&path, &Batch { first: 8, ..batch.clone() }).expect("written");
        let read = read(&path).expect("read");
        assert_eq!(read.len(), 2);
        assert_eq!(read[0], batch);
        assert_eq!(next_seed(&read, "a/b"), 11);
        assert_eq!(next_seed(&read, "c"), 0);
        assert_eq!(today().len(), 10);
    }
}
