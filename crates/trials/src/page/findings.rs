//! Findings with the outcome of their last repetition.

use super::builds::builds;
use super::sum::Kinds;
use crate::format::code_span;
use crate::state::Batch;
use std::fmt::Write as _;

/// Outcome of the last repetition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status<'a> {
    /// The case passes with another build.
    Mended(&'a str),
    /// The case passes with the build that has the finding.
    Unsteady(&'a str),
    /// Sort of the finding, and the build.
    Again(&'a str, &'a str),
    NotRun,
}

/// Finding of the page.
#[derive(Debug)]
pub struct Found<'a> {
    pub kind: &'a str,
    pub seed: u64,
    pub sort: &'a str,
    /// Build that has it.
    pub version: &'a str,
    pub status: Status<'a>,
}

impl Found<'_> {
    /// True unless a later build passes.
    pub fn is_open(&self) -> bool {
        !matches!(self.status, Status::Mended(_))
    }
}

/// All findings, by kind and seed.
pub fn all<'a>(kinds: &'a Kinds, batches: &'a [Batch]) -> Vec<Found<'a>> {
    let mut out = Vec::new();
    for (kind, sum) in &kinds.0 {
        for ((seed, sort), version) in &sum.findings {
            let repeated = batches.iter().rfind(|b| b.repeats && b.kind == *kind && b.first == *seed);
            out.push(Found { kind, seed: *seed, sort, version, status: status(version, repeated) });
        }
    }
    out
}

fn status<'a>(version: &str, repeated: Option<&'a Batch>) -> Status<'a> {
    let Some(batch) = repeated else { return Status::NotRun };
    match batch.findings.first() {
        Some(found) => Status::Again(&found.sort, &batch.version),
        None if builds(version).contains(&batch.version) => Status::Unsteady(&batch.version),
        None => Status::Mended(&batch.version),
    }
}

/// Section of findings.
pub fn section(findings: &[Found]) -> String {
    let mut out = String::from("## Findings\n\n");
    if findings.is_empty() {
        return out + "No findings.\n";
    }
    out += "`anastomesh-trials repeat` runs each finding again with the present build. A finding is mended if a later build passes. A partial \
            file\nis an incomplete one at the output path. Mixed files are some of this run beside some of an earlier one.\n\n\
            | kind | seed | finding | found with | last repetition |\n|---|---|---|---|---|\n";
    for Found { kind, seed, sort, version, status } in findings {
        let status = match status {
            Status::Mended(build) => format!("passes with {}", code_span(build)),
            Status::Unsteady(_) => "passes with the same build".to_owned(),
            Status::Again(sort, build) => format!("{sort} with {}", code_span(build)),
            Status::NotRun => "not run again".to_owned(),
        };
        let _ = writeln!(out, "| {kind} | {seed} | {sort} | {} | {status} |", code_span(version));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::Finding;

    #[test]
    fn a_finding_is_mended_if_another_build_passes() {
        let finding = |seed| Finding { seed, sort: "hang".into(), text: String::new() };
        let first = Batch {
            kind: "a/b".into(),
            count: 9,
            version: "v builds 1, 2".into(),
            findings: (1..5).map(finding).collect(),
            ..Batch::default()
        };
        let repeat = |seed, version: &str, findings: Vec<Finding>| Batch {
            kind: "a/b".into(),
            first: seed,
            count: 1,
            repeats: true,
            version: version.into(),
            findings,
            ..Batch::default()
        };
        let batches = [
            first,
            repeat(1, "v build 3", Vec::new()),
            repeat(2, "v build 2", Vec::new()),
            repeat(3, "v build 3", vec![finding(3)]),
        ];
        let kinds = Kinds::of(&batches);
        let found = all(&kinds, &batches);
        assert_eq!(found.iter().map(Found::is_open).collect::<Vec<_>>(), [false, true, true, true]);
        let page = section(&found);
        for status in
            ["passes with `v build 3`", "passes with the same build", "hang with `v build 3`", "not run again"]
        {
            assert!(page.contains(&format!("| `v builds 1, 2` | {status} |\n")), "{status}\n{page}");
        }
        assert!(section(&[]).ends_with("No findings.\n"));
    }
}
