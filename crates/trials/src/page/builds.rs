//! Builds of the program under trial.

use crate::format::{code_span, grouped};
use crate::state::Batch;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Builds of a version. A line that was put together later names several: `anastomesh 0.1.0 builds 2c7cfb6e, 6e31239b`.
pub fn builds(version: &str) -> Vec<String> {
    match version.split_once(" builds ") {
        Some((name, builds)) => builds.split(", ").map(|build| format!("{name} build {build}")).collect(),
        None => vec![version.to_owned()],
    }
}

/// Number of builds.
pub fn count(batches: &[Batch]) -> u64 {
    batches.iter().flat_map(|batch| builds(&batch.version)).collect::<BTreeSet<_>>().len() as u64
}

/// First and last day of batches.
pub fn days<'a>(batches: impl Iterator<Item = &'a Batch>) -> [&'a str; 2] {
    let days: BTreeSet<&str> =
        batches.flat_map(|batch| [batch.date.as_str(), batch.last_day()]).filter(|day| !day.is_empty()).collect();
    [days.first(), days.last()].map(|day| day.copied().unwrap_or("–"))
}

/// Section with a row for each build, the newest first.
pub fn section(batches: &[Batch]) -> String {
    let mut rows: BTreeMap<&str, (usize, Vec<&Batch>)> = BTreeMap::new();
    for (place, batch) in batches.iter().enumerate() {
        let row = rows.entry(&batch.version).or_default();
        row.0 = place;
        row.1.push(batch);
    }
    let mut rows: Vec<(&str, (usize, Vec<&Batch>))> = rows.into_iter().collect();
    rows.sort_by_key(|(_, (place, _))| std::cmp::Reverse(*place));
    let mut out = String::from(
        "\n## Builds\n\nA build is a version and a hash of the program's file. The newest one is the first. A row with several builds adds them up.\n\n\
         | build | first day | last day | cases | findings repeated |\n|---|---|---|---|---|\n",
    );
    for (version, (_, own)) in rows {
        let [first, last] = days(own.iter().copied());
        let [cases, repeated] =
            [false, true].map(|repeats| own.iter().filter(|b| b.repeats == repeats).map(|b| b.count).sum::<u64>());
        let _ =
            writeln!(out, "| {} | {first} | {last} | {} | {} |", code_span(version), grouped(cases), grouped(repeated));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn builds_have_days_and_cases() {
        let batch = |version: &str, date: &str, until: &str, count, repeats| Batch {
            version: version.into(),
            date: date.into(),
            until: until.into(),
            count,
            repeats,
            ..Batch::default()
        };
        let batches = [
            batch("v build 2", "2026-01-02", "2026-01-04", 1200, false),
            batch("v builds 1, 2", "2026-01-01", "", 7, false),
            batch("v build 2", "2026-01-05", "", 3, true),
        ];
        assert_eq!((count(&batches), days(batches.iter())), (2, ["2026-01-01", "2026-01-05"]));
        let rows = "| `v build 2` | 2026-01-02 | 2026-01-05 | 1,200 | 3 |\n| `v builds 1, 2` | 2026-01-01 | 2026-01-01 | 7 | 0 |\n";
        assert!(section(&batches).ends_with(rows), "{}", section(&batches));
    }
}
