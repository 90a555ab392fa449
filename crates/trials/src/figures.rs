//! Figures of other programs in the state file: mutation tests, line coverage, fuzzing, and exact predicates.

use crate::state;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// Missed mutants of a part without a reason that are kept with their names.
const NAMES: usize = 40;

/// Reasons why mutants stay: lines `NAME: REASON`, where the name has no line and column.
const REASONS: &str = "crates/mutants/survivors.txt";

/// Reads the output of another program, and appends its figures to the state file. `None` if the words are no command.
pub fn add(words: &[&str], state: &Path) -> io::Result<Option<u8>> {
    let read = |file: &str| {
        let text = fs::read(file).map_err(|e| io::Error::other(format!("{file}: {e}; name a readable file")))?;
        Ok::<_, io::Error>(String::from_utf8_lossy(&text).into_owned())
    };
    let (file, figures) = match *words {
        ["mutants", part, file] => (file, mutants(part, &read(file)?, &read(REASONS)?).map(|figure| vec![figure])),
        ["coverage", file] => (file, coverage(&read(file)?).map(|figure| vec![figure])),
        ["fuzz", target, file] => (file, fuzz(target, &read(file)?).map(|figure| vec![figure])),
        ["predicates", file] => (file, Some(predicates(&read(file)?)).filter(|figures| !figures.is_empty())),
        _ => return Ok(None),
    };
    let problem = || io::Error::other(format!("{file}: no figures of {}; give the output of that program", words[0]));
    for mut figure in figures.ok_or_else(problem)? {
        figure["date"] = state::today().into();
        println!("{figure}");
        state::append_line(state, &figure.to_string())?;
    }
    Ok(Some(0))
}

/// Reads all figures.
pub fn read(state: &Path) -> io::Result<Vec<Value>> {
    match fs::read_to_string(state) {
        Ok(text) => Ok(merged(&text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(error),
    }
}

/// Figures of a state file, sorted by figure and part. The last line of a part counts; those of fuzzing are summed.
pub fn merged(text: &str) -> Vec<Value> {
    let mut figures: BTreeMap<(String, String), Value> = BTreeMap::new();
    for figure in text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok()) {
        let Some(name) = figure["figure"].as_str() else { continue };
        let key = (name.to_owned(), figure["part"].as_str().unwrap_or_default().to_owned());
        let sum = match figures.get(&key) {
            Some(earlier) if name == "fuzz" => sum_of_fuzzing(earlier, &figure),
            _ => figure,
        };
        figures.insert(key, sum);
    }
    figures.into_values().collect()
}

fn sum_of_fuzzing(earlier: &Value, later: &Value) -> Value {
    let mut sum = later.clone();
    for key in ["executions", "findings"] {
        sum[key] = (number(earlier, key) + number(later, key)).into();
    }
    sum["edges"] = number(earlier, "edges").max(number(later, "edges")).into();
    sum
}

/// Number of a figure; 0 if it has none of this name.
pub fn number(figure: &Value, key: &str) -> u64 {
    figure[key].as_u64().unwrap_or(0)
}

/// Figures of a file of anastomesh-mutants, which has outcomes as cargo-mutants writes them. `of` is the number of mutants
/// of which these are a sample.
fn mutants(part: &str, text: &str, reasons: &str) -> Option<Value> {
    let json: Value = serde_json::from_str(text).ok()?;
    let outcomes: Vec<(&str, &str)> = json["outcomes"]
        .as_array()?
        .iter()
        .filter_map(|o| Some((o["summary"].as_str()?, o["scenario"]["Mutant"]["name"].as_str()?)))
        .collect();
    let count = |summary: &str| outcomes.iter().filter(|(s, _)| *s == summary).count();
    let missed: Vec<&str> = outcomes.iter().filter(|(s, _)| *s == "MissedMutant").map(|(_, name)| *name).collect();
    let names: Vec<&str> = missed.iter().copied().filter(|name| !has_reason(name, reasons)).collect();
    (!outcomes.is_empty()).then(|| {
        json!({
            "figure": "mutants", "part": part, "tried": outcomes.len(), "of": json["of"],
            "caught": count("CaughtMutant"), "missed": missed.len(), "explained": missed.len() - names.len(),
            "timeouts": count("Timeout"), "unviable": count("Unviable"),
            "names": if names.len() <= NAMES { names } else { Vec::new() },
        })
    })
}

/// True if a line has the name without `:LINE:COLUMN`, then `: `.
fn has_reason(name: &str, reasons: &str) -> bool {
    let Some((place, change)) = name.split_once(": ") else { return false };
    let Some(file) = place.rsplitn(3, ':').last() else { return false };
    let short = format!("{file}: {change}: ");
    reasons.lines().any(|line| line.starts_with(&short))
}

/// Figures of `cargo llvm-cov report --json --summary-only`: lines and covered lines of each folder.
fn coverage(text: &str) -> Option<Value> {
    let json: Value = serde_json::from_str(text).ok()?;
    let mut folders: BTreeMap<String, [u64; 2]> = BTreeMap::new();
    for file in json["data"][0]["files"].as_array()? {
        let Some(folder) = folder_of(file["filename"].as_str()?) else { continue };
        let lines = &file["summary"]["lines"];
        let sums = folders.entry(folder).or_default();
        *sums = [sums[0] + lines["count"].as_u64()?, sums[1] + lines["covered"].as_u64()?];
    }
    (!folders.is_empty()).then(|| json!({"figure": "coverage", "folders": folders}))
}

/// Folder of a source file: the first below `src`, or `src` for a file directly in it.
fn folder_of(path: &str) -> Option<String> {
    let (before, inside) = path.rsplit_once("/src/")?;
    let source = match before.rsplit_once("crates/") {
        Some((_, name)) if !name.contains('/') => format!("crates/{name}/src"),
        _ => "src".to_owned(),
    };
    Some(inside.split_once('/').map_or_else(|| source.clone(), |(folder, _)| format!("{source}/{folder}")))
}

/// Figures of a log of libFuzzer, written with `-print_final_stats=1`.
fn fuzz(target: &str, log: &str) -> Option<Value> {
    let behind = |line: &str, name: &str| {
        let word = line.split_once(name)?.1.split_whitespace().next()?;
        word.parse::<u64>().ok()
    };
    let executions = log.lines().rev().find_map(|line| behind(line, "stat::number_of_executed_units:"))?;
    let edges = log.lines().rev().filter(|line| line.starts_with('#')).find_map(|line| behind(line, " cov: "));
    let found = log.contains("ERROR: libFuzzer") || log.contains("SUMMARY: libFuzzer");
    Some(json!({
        "figure": "fuzz", "part": target, "executions": executions, "edges": edges.unwrap_or(0),
        "findings": u64::from(found),
    }))
}

/// Figures of lines such as `orient3d: 1000 compared with exact integers, 0 differ, 12 zero`.
fn predicates(text: &str) -> Vec<Value> {
    let of_line = |line: &str| {
        let (name, rest) = line.split_once(": ")?;
        let words: Vec<&str> = rest.split([' ', ',']).collect();
        let before = |unit: &str| {
            let at = words.iter().position(|word| *word == unit)?;
            words.get(at.checked_sub(1)?)?.parse::<u64>().ok()
        };
        let (compared, differ, zero) = (before("compared")?, before("differ")?, before("zero")?);
        let part = name.trim();
        Some(json!({"figure": "predicates", "part": part, "compared": compared, "differ": differ, "zero": zero}))
    };
    text.lines().filter_map(of_line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_of_mutants_are_counted() {
        let outcome = |summary: &str, name: &str| json!({"scenario": {"Mutant": {"name": name}}, "summary": summary});
        let outcomes = [
            outcome("CaughtMutant", "src/a.rs:1:1: replace f with ()"),
            outcome("MissedMutant", "src/a.rs:2:1: replace < with <= in f"),
            outcome("MissedMutant", "src/a.rs:5:1: replace > with >= in f"),
            outcome("Timeout", "src/a.rs:3:1: replace += with -= in f"),
            outcome("Unviable", "src/a.rs:4:1: replace g with Default::default()"),
        ];
        let text = json!({"outcomes": outcomes, "of": 40}).to_string();
        let expected = json!({
            "figure": "mutants", "part": "verify", "tried": 5, "of": 40, "caught": 1, "missed": 2, "explained": 1,
            "timeouts": 1, "unviable": 1, "names": ["src/a.rs:2:1: replace < with <= in f"],
        });
        let reasons = "src/a.rs: replace > with >= in f: speed only\nsrc/b.rs: replace < with <= in f: equal\n";
        assert_eq!(mutants("verify", &text, reasons), Some(expected));
        let many: Vec<Value> = (0..=NAMES).map(|i| outcome("MissedMutant", &format!("{i}"))).collect();
        let many = mutants("verify", &json!({"outcomes": many, "of": 41}).to_string(), "").expect("a figure");
        assert_eq!((number(&many, "missed"), &many["names"]), (41, &json!([])));
        assert_eq!(mutants("verify", r#"{"outcomes": [], "of": 0}"#, ""), None);
    }

    #[test]
    fn lines_of_files_are_summed_by_folder() {
        let file = |name: &str, count: u64, covered: u64| json!({"filename": name, "summary": {"lines": {"count": count, "covered": covered}}});
        let files = [
            file("/usr/src/a/crates/mesh/src/check/a.rs", 10, 9),
            file("/usr/src/a/crates/mesh/src/check/deep/b.rs", 5, 5),
            file("/usr/src/a/crates/mesh/src/lib.rs", 2, 1),
            file("/usr/src/a/src/main.rs", 3, 0),
            file("/usr/src/a/src/block/mod.rs", 4, 4),
            file("build.rs", 7, 7),
        ];
        let text = json!({"data": [{"files": files}], "type": "llvm.coverage.json.export"}).to_string();
        let folders = json!({
            "crates/mesh/src": [2, 1], "crates/mesh/src/check": [15, 14], "src": [3, 0], "src/block": [4, 4],
        });
        assert_eq!(coverage(&text).map(|figure| figure["folders"].clone()), Some(folders));
        assert_eq!(coverage("{}"), None);
    }

    #[test]
    fn logs_of_a_fuzzer_add_up() {
        let log = "INFO: Seed: 1\n#2\tINITED cov: 90 ft: 91 corp: 1/1b\n#1024\tpulse  cov: 95 ft: 99 corp: 9/9b\n\
                   stat::number_of_executed_units: 1500\nstat::average_exec_per_sec:     500\n";
        let clean = fuzz("off", log).expect("a figure");
        let crashed = fuzz("off", &format!("{log}SUMMARY: libFuzzer: timeout\n")).expect("a figure");
        let other = fuzz("ply", log).expect("a figure");
        let sum = json!({"figure": "fuzz", "part": "off", "executions": 3000, "edges": 95, "findings": 1});
        assert_eq!(merged(&format!("{clean}\n{other}\n{{\"kind\":\"a\"}}\n{crashed}\n")), [sum, other]);
        assert_eq!(fuzz("off", "INFO: Seed: 1\n"), None);
    }

    #[test]
    fn comparisons_of_predicates_are_read_and_the_last_counts() {
        let text = "seed 1\norient3d: 1000000000 compared with exact integers, 0 differ, 123456 zero\n\
                    insphere: 2000 compared with exact integers, 1 differ, 3 zero\n";
        let figures = predicates(text);
        let expected = json!({"figure": "predicates", "part": "orient3d", "compared": 1_000_000_000, "differ": 0, "zero": 123_456});
        assert_eq!(figures[0], expected);
        let earlier = r#"{"figure":"predicates","part":"insphere","compared":5}"#;
        assert_eq!(
            merged(&format!("{earlier}\n{}\n{}", figures[1], figures[0])),
            [figures[1].clone(), figures[0].clone()]
        );
    }

    #[test]
    fn figures_are_appended_to_the_state_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let [state, file] = ["trust.jsonl", "out.txt"].map(|name| folder.path().join(name));
        fs::write(&file, "orient3d: 10 compared with exact integers, 0 differ, 1 zero\n").expect("written");
        let words = ["predicates", file.to_str().expect("a name")];
        assert_eq!(add(&words, &state).expect("added"), Some(0));
        assert_eq!(number(&read(&state).expect("read")[0], "compared"), 10);
        assert_eq!(add(&["none"], &state).expect("no command"), None);
        fs::write(&file, "").expect("written");
        assert!(add(&words, &state).expect_err("no figures").to_string().contains("no figures of predicates"));
    }
}
