//! Page of results, from the state file.

mod builds;
mod family;
mod findings;
mod head;
mod result;
mod sum;
mod tables;

use crate::state::{self, Batch};
use crate::{figures, sections};
use serde_json::Value;
use std::fs;
use std::io;
use std::path::Path;

/// Writes the page.
pub fn write(state: &Path, page: &Path) -> io::Result<()> {
    let (batches, figures) = (state::read(state)?, figures::read(state)?);
    if batches.is_empty() && figures.is_empty() {
        return Err(io::Error::other(format!("{}: no results; `anastomesh-trials run` makes them", state.display())));
    }
    fs::write(page, text(&batches, &figures))
}

/// Text of the page.
fn text(batches: &[Batch], figures: &[Value]) -> String {
    let kinds = sum::Kinds::of(batches);
    let found = findings::all(&kinds, batches);
    let families = family::FAMILIES.map(|family| tables::section(family, &kinds)).concat();
    [
        head::start(batches),
        result::text(&kinds, &found, figures),
        head::terms(),
        tables::summary(&kinds),
        families,
        findings::section(&found),
        sections::text(figures),
        builds::section(batches),
    ]
    .concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::Finding;

    #[test]
    fn a_page_has_counts_messages_and_findings() {
        let mut batch =
            Batch { kind: "networks/star".into(), count: 1200, valid: 1190, version: "v 1".into(), ..Batch::default() };
        batch.typed.insert("3: it|is `open`".into(), 9);
        batch.typed.insert("1: not faithful: far".into(), 3);
        batch.findings.push(Finding { seed: 7, sort: "panic".into(), text: String::new() });
        let gone = Batch { first: 7, count: 1, valid: 1, repeats: true, version: "next".into(), ..batch.clone() };
        let gone = Batch { findings: Vec::new(), ..gone };
        let fuzz = serde_json::json!({"figure": "fuzz", "part": "off", "executions": 7});
        let page = text(&[batch, gone], &[fuzz]);
        assert!(
            page.contains("| star | 1,200 | 1,190 | 99.2 | 3 | 99.4 | 99.4 (1,200) | 0 | 9 | 1 | 2.5e-3 | 0.0 (0) |"),
            "{page}"
        );
        assert!(page.contains("| networks/star | 7 | panic | `v 1` | passes with `next` |\n\n## Fuzzing\n"), "{page}");
        let titles: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("## ")).collect();
        let expected = ["Result", "Commands", "Terms", "Summary", "Networks", "Findings", "Fuzzing", "Builds"];
        assert_eq!(titles, expected);
    }
}
