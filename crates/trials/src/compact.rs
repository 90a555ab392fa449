//! Compact state file: one line per kind and build, one per repeated finding, and one per figure.

use crate::figures;
use crate::state::Batch;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// Messages of a line. Rarer ones are counted together, so that the file stays small.
const MESSAGES: usize = 12;

/// Name of messages that are counted together.
pub const OTHER: &str = "other messages";

/// Kind, build, and seed of a repetition.
type Key = (String, String, Option<u64>);

/// Rewrites the state file in its compact form. A killed program leaves the earlier file.
pub fn rewrite(path: &Path) -> io::Result<()> {
    let text = match fs::read_to_string(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        read => read?,
    };
    let temporary = path.with_extension("jsonl.new");
    fs::write(&temporary, compacted(&text))?;
    fs::rename(&temporary, path)
}

/// Compact text of a state file. Lines keep the order in which they last changed, so that the newest build stays the last.
fn compacted(text: &str) -> String {
    let mut merged: BTreeMap<Key, (usize, Batch)> = BTreeMap::new();
    for (place, batch) in text.lines().filter_map(Batch::of_line).enumerate() {
        let key = (batch.kind.clone(), batch.version.clone(), batch.repeats.then_some(batch.first));
        let earlier = merged.remove(&key).map(|(_, earlier)| earlier);
        let batch = earlier.map_or_else(|| batch.clone(), |earlier| merge(earlier, &batch));
        merged.insert(key, (place, batch));
    }
    let mut batches: Vec<(usize, Batch)> = merged.into_values().collect();
    batches.sort_by_key(|(place, _)| *place);
    let lines = batches.iter_mut().map(|(_, batch)| {
        limit_messages(&mut batch.typed);
        batch.line()
    });
    lines.chain(figures::merged(text).iter().map(ToString::to_string)).map(|line| line + "\n").collect()
}

/// Sum of two batches of a kind and build. Of repetitions, the last one.
fn merge(mut sum: Batch, batch: &Batch) -> Batch {
    if batch.repeats {
        return batch.clone();
    }
    let days = [sum.last_day().max(batch.last_day()).to_owned(), sum.date.min(batch.date.clone())];
    [sum.until, sum.date] = days;
    if sum.until == sum.date {
        sum.until.clear();
    }
    sum.end = sum.end.max(sum.first + sum.count).max(batch.end());
    sum.first = sum.first.min(batch.first);
    sum.count += batch.count;
    sum.valid += batch.valid;
    sum.valid_by_one += batch.valid_by_one;
    (sum.seconds, sum.timed) = (sum.seconds + batch.seconds, sum.timed + batch.timed);
    batch.typed.iter().for_each(|(message, count)| *sum.typed.entry(message.clone()).or_default() += count);
    sum.findings.extend(batch.findings.iter().cloned());
    sum.findings.sort_by(|a, b| (a.seed, &a.sort).cmp(&(b.seed, &b.sort)));
    if batch.worst > sum.worst {
        (sum.worst, sum.worst_seed) = (batch.worst, batch.worst_seed);
    }
    sum
}

/// Merges the rarest messages into one entry per exit code.
fn limit_messages(typed: &mut BTreeMap<String, u64>) {
    let mut own: Vec<(String, u64)> = typed
        .iter()
        .filter(|(message, _)| !is_other(message))
        .map(|(message, count)| (message.clone(), *count))
        .collect();
    own.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    for (message, count) in own.iter().skip(MESSAGES) {
        typed.remove(message);
        *typed.entry(other(message)).or_default() += count;
    }
}

/// True for an entry that counts several messages.
pub fn is_other(message: &str) -> bool {
    message.ends_with(&format!(": {OTHER}"))
}

/// Entry for a rare message. The page classifies messages of exit code 1 by their first words.
fn other(message: &str) -> String {
    let code = message.split(": ").next().unwrap_or_default();
    let verdict = if message.starts_with("1: NOT valid") { "NOT valid: " } else { "" };
    format!("{code}: {verdict}{OTHER}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::{Finding, next_seed, read};

    fn batch(version: &str, first: u64, count: u64) -> Batch {
        let date = format!("2026-01-{:02}", 10 + first);
        Batch { kind: "a/b".into(), version: version.into(), first, count, date, ..Batch::default() }
    }

    fn lines(batches: &[Batch]) -> String {
        batches.iter().map(|batch| batch.line() + "\n").collect()
    }

    #[test]
    fn batches_of_a_build_are_summed() {
        let mut first = Batch { valid: 1, valid_by_one: 1, worst: 0.5, worst_seed: 1, ..batch("1", 0, 3) };
        first.findings.push(Finding { seed: 2, sort: "panic".into(), text: "at x".into() });
        let mut last = Batch { valid: 2, worst: 0.75, worst_seed: 6, seconds: 1.25, timed: 3, ..batch("1", 5, 3) };
        last.typed.insert("3: no".into(), 1);
        let text = lines(&[first, Batch { valid: 2, ..batch("2", 3, 2) }, last]);
        let expected = r#"{"count":2,"date":"2026-01-13","first":3,"kind":"a/b","valid":2,"version":"2"}
{"count":6,"date":"2026-01-10","end":8,"findings":[{"seed":2,"sort":"panic","text":"at x"}],"kind":"a/b","sum_s":1.25,"timed":3,"typed":{"3: no":1},"until":"2026-01-15","valid":3,"valid_by_one":1,"version":"1","worst_s":0.75,"worst_seed":6}
"#;
        assert_eq!(compacted(&text), expected);
        assert_eq!(compacted(expected), expected);
    }

    #[test]
    fn the_last_repetition_of_a_finding_stays() {
        let found = Finding { seed: 4, sort: "hang".into(), text: String::new() };
        let repeat = |seed, findings: &[&Finding]| {
            let findings = findings.iter().map(|f| (*f).clone()).collect();
            Batch { repeats: true, findings, ..batch("1", seed, 1) }
        };
        let text = lines(&[repeat(4, &[&found]), repeat(6, &[]), repeat(4, &[])]);
        assert_eq!(compacted(&text), lines(&[repeat(6, &[]), repeat(4, &[])]));
    }

    #[test]
    fn rare_messages_are_counted_by_exit_code() {
        let mut typed: BTreeMap<String, u64> = (0..12).map(|i| (format!("3: common {i:02}"), 9)).collect();
        for (message, count) in [("1: NOT valid: a", 1), ("1: NOT valid: b", 2), ("1: far", 3), ("3: x: y", 4)] {
            typed.insert(message.into(), count);
        }
        typed.insert("3: other messages".into(), 5);
        limit_messages(&mut typed);
        assert_eq!(typed.len(), 12 + 3);
        let counts = ["1: NOT valid: other messages", "1: other messages", "3: other messages"].map(|m| typed[m]);
        assert_eq!(counts, [3, 3, 9]);
        let again = typed.clone();
        limit_messages(&mut typed);
        assert_eq!(typed, again);
    }

    #[test]
    fn a_file_is_rewritten_and_continued() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("trust.jsonl");
        rewrite(&path).expect("no file is no error");
        fs::write(&path, lines(&[batch("1", 0, 3), batch("2", 3, 2), batch("1", 5, 3)]) + "{\"kind\": \"a/")
            .expect("written");
        rewrite(&path).expect("rewritten");
        let once = fs::read(&path).expect("a file");
        rewrite(&path).expect("rewritten");
        assert_eq!(fs::read(&path).expect("a file"), once);
        let batches = read(&path).expect("read");
        assert_eq!((batches.len(), next_seed(&batches, "a/b")), (2, 8));
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }
}
