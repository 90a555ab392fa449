//! State file: one JSON line per batch, so that a run continues where the last one ended. `compact.rs` merges batches.

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

/// Results of seeds of a kind.
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
    /// Sum of the processor seconds of the cases in `timed`.
    pub seconds: f64,
    /// Cases whose time is recorded. Lines of earlier versions have none.
    pub timed: u64,
    /// True if the batch repeats earlier findings with another build.
    pub repeats: bool,
    /// Version and build of the program.
    pub version: String,
    /// First day.
    pub date: String,
    /// Last day; empty if it is the first one.
    pub until: String,
    /// Seed after the last one, if seeds between the first and the last are in other batches. Otherwise 0.
    pub end: u64,
}

impl Batch {
    /// Seed after the last one.
    pub fn end(&self) -> u64 {
        self.end.max(self.first + self.count)
    }

    /// Last day.
    pub fn last_day(&self) -> &str {
        if self.until.is_empty() { &self.date } else { &self.until }
    }

    /// Line of the state file, without fields that are zero, false or empty.
    pub fn line(&self) -> String {
        let findings: Vec<Value> =
            self.findings.iter().map(|f| json!({"seed": f.seed, "sort": f.sort, "text": f.text})).collect();
        let mut line = json!({
            "kind": self.kind, "first": self.first, "count": self.count, "valid": self.valid,
            "valid_by_one": self.valid_by_one, "typed": self.typed, "findings": findings,
            // Fewer digits than a parser may change.
            "worst_s": (self.worst * 1e3).round() / 1e3, "sum_s": (self.seconds * 1e3).round() / 1e3,
            "timed": self.timed, "worst_seed": self.worst_seed, "repeats": self.repeats, "version": self.version, "date": self.date,
            "until": self.until, "end": if self.end > self.first + self.count { self.end } else { 0 },
        });
        if let Some(fields) = line.as_object_mut() {
            fields.retain(|_, value| !is_default(value));
        }
        line.to_string()
    }

    /// Batch of a line; `None` if the line is cut or is not a batch.
    pub fn of_line(line: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(line).ok()?;
        let number = |key: &str| value[key].as_u64().unwrap_or(0);
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let typed = value["typed"].as_object().into_iter().flatten();
        let findings = value["findings"].as_array().into_iter().flatten();
        Some(Self {
            kind: value["kind"].as_str()?.to_owned(),
            first: number("first"),
            count: number("count"),
            valid: number("valid"),
            valid_by_one: number("valid_by_one"),
            typed: typed.map(|(message, count)| Some((message.clone(), count.as_u64()?))).collect::<Option<_>>()?,
            findings: findings
                .map(|f| Some(Finding { seed: f["seed"].as_u64()?, sort: text(&f["sort"]), text: text(&f["text"]) }))
                .collect::<Option<_>>()?,
            worst: value["worst_s"].as_f64().unwrap_or(0.0),
            worst_seed: number("worst_seed"),
            seconds: value["sum_s"].as_f64().unwrap_or(0.0),
            timed: number("timed"),
            repeats: value["repeats"].as_bool().unwrap_or(false),
            version: text(&value["version"]),
            date: text(&value["date"]),
            until: text(&value["until"]),
            end: number("end"),
        })
    }
}

/// True for zero, false, and empty text, lists and objects.
fn is_default(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Bool(value) => !value,
        Value::Number(value) => value.as_f64() == Some(0.0),
        Value::String(value) => value.is_empty(),
        Value::Array(value) => value.is_empty(),
        Value::Object(value) => value.is_empty(),
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
    append_line(path, &batch.line())
}

/// Appends a line.
pub fn append_line(path: &Path, line: &str) -> io::Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder)?;
    }
    let mut file = OpenOptions::new().create(true).append(true).open(path)?;
    // The line break before the text ends a line that a killed run has cut.
    let before = if file.metadata()?.len() == 0 { "" } else { "\n" };
    file.write_all(format!("{before}{line}").as_bytes())
}

/// First seed that no batch of a kind has tried.
pub fn next_seed(batches: &[Batch], kind: &str) -> u64 {
    batches.iter().filter(|batch| batch.kind == kind && !batch.repeats).map(Batch::end).max().unwrap_or(0)
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
    fn lines_of_earlier_versions_are_read() {
        let line = r#"{"kind":"a/b","first":0,"count":2,"valid":1,"valid_by_one":0,"typed":{"3: no":1},"findings":[],
            "worst_s":0.12345,"worst_seed":1,"repeats":false,"version":"v","date":"2026-01-31"}"#;
        let batch = Batch::of_line(line).expect("a batch");
        assert_eq!((batch.count, batch.typed["3: no"], batch.last_day(), batch.end()), (2, 1, "2026-01-31", 2));
        let short = r#"{"count":2,"date":"2026-01-31","kind":"a/b","typed":{"3: no":1},"valid":1,"version":"v","worst_s":0.123,"worst_seed":1}"#;
        assert_eq!(batch.line(), short);
        assert_eq!(Batch::of_line(short), Some(Batch { worst: 0.123, ..batch }));
        assert_eq!(Batch::of_line(r#"{"figure":"fuzz"}"#), None);
    }

    #[test]
    fn batches_survive_a_cut_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("state/trials.jsonl");
        let mut batch =
            Batch { kind: "a/b".into(), first: 5, count: 3, worst: 0.25, seconds: 0.5, timed: 3, ..Batch::default() };
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
