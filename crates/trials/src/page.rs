//! Page of results, from the state file.

use crate::compact::{OTHER, is_other};
use crate::format::{code_span, grouped, percent};
use crate::state::{self, Batch};
use crate::{figures, sections};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;

/// Families with their headings, in the order of the page.
const FAMILIES: [(&str, &str, &str); 7] = [
    ("networks", "Networks", "Each network is meshed without options."),
    ("refined", "Networks with `--refine`", "The kinds are those above, with the option `--refine`."),
    ("surfaces", "Surfaces", "Each surface is valid by construction, so a refusal is a finding."),
    ("soups", "Faulty input", "The input is faulty by construction, so a mesh is a finding."),
    (
        "complexes",
        "Complexes with regions",
        "Complexes are valid by construction, except those with dangling triangles.",
    ),
    ("options", "Options at random", "Moderate input with options drawn at random."),
    (
        "faults",
        "Kills and faults",
        "Valid means: complete files. Refused means: earlier files are intact. In both cases a second run gives the bytes of an undisturbed one.",
    ),
];

/// Messages of a kind on the page. The state file has more.
const MESSAGES: usize = 4;

/// Minimum number of a kind's last cases. Whole builds are counted, from the newest on.
const LAST: u64 = 30;

/// Sum of the batches of a kind.
#[derive(Clone, Debug, Default)]
struct Sum {
    /// Numbers of the last cases, and of the valid ones among them with those beyond a limit.
    last: [u64; 2],
    count: u64,
    valid: u64,
    valid_by_one: u64,
    typed: BTreeMap<String, u64>,
    findings: BTreeMap<(u64, String), String>,
    worst: f64,
    worst_seed: u64,
}

impl Sum {
    /// Sum of the batches of a kind, the newest first.
    fn of(batches: &[&Batch]) -> Self {
        let mut sum = Self::default();
        for batch in batches {
            sum.add(batch);
            if sum.last[0] < LAST {
                sum.last = [sum.count, sum.valid + sum.valid_by_one + sum.not_faithful()];
            }
        }
        sum
    }

    fn add(&mut self, batch: &Batch) {
        self.count += batch.count;
        self.valid += batch.valid;
        self.valid_by_one += batch.valid_by_one;
        batch.typed.iter().for_each(|(message, count)| *self.typed.entry(message.clone()).or_default() += count);
        let findings = batch.findings.iter().map(|f| ((f.seed, f.sort.clone()), batch.version.clone()));
        self.findings.extend(findings);
        if batch.worst > self.worst {
            (self.worst, self.worst_seed) = (batch.worst, batch.worst_seed);
        }
    }

    /// Cases without a mesh at the output.
    fn refused(&self) -> u64 {
        self.typed.values().sum::<u64>() - self.not_faithful() - self.not_valid()
    }

    /// Meshes that the program and both checkers call not valid.
    fn not_valid(&self) -> u64 {
        self.with(|message| message.starts_with("1: NOT valid"))
    }

    /// Valid meshes beyond a limit, such as that on the distance from the network.
    fn not_faithful(&self) -> u64 {
        self.with(|message| message.starts_with("1: ") && !message.starts_with("1: NOT valid"))
    }

    /// Cases whose message satisfies a condition.
    fn with(&self, condition: impl Fn(&str) -> bool) -> u64 {
        self.typed.iter().filter(|(message, _)| condition(message)).map(|(_, count)| count).sum()
    }

    /// Cases that were called valid, and are not by at least one checker.
    fn wrong(&self) -> usize {
        self.findings.keys().filter(|(_, sort)| ["called valid", "checkers disagree"].contains(&&**sort)).count()
    }
}

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
    let mut kinds: BTreeMap<&str, Vec<&Batch>> = BTreeMap::new();
    for batch in batches.iter().filter(|batch| !batch.repeats).rev() {
        kinds.entry(&batch.kind).or_default().push(batch);
    }
    let kinds: BTreeMap<&str, Sum> = kinds.into_iter().map(|(kind, batches)| (kind, Sum::of(&batches))).collect();
    let mut out = head(batches);
    out += &families(&kinds);
    for (family, title, note) in FAMILIES {
        let own: Vec<(&str, &Sum)> = of_family(&kinds, family).collect();
        if !own.is_empty() {
            out += &table(family, title, note, &own);
        }
    }
    out + &findings(&kinds, batches) + &sections::text(figures)
}

fn of_family<'a>(kinds: &'a BTreeMap<&str, Sum>, family: &str) -> impl Iterator<Item = (&'a str, &'a Sum)> {
    let start = format!("{family}/");
    kinds.iter().filter_map(move |(kind, sum)| Some((kind.strip_prefix(&start)?, sum)))
}

fn head(batches: &[Batch]) -> String {
    let dates: BTreeSet<&str> = batches.iter().flat_map(|batch| [batch.date.as_str(), batch.last_day()]).collect();
    let versions: BTreeSet<String> = batches.iter().flat_map(|batch| builds(&batch.version)).collect();
    let (first, last) = (dates.first().unwrap_or(&""), dates.last().unwrap_or(&""));
    format!(
        "# Trials

`anastomesh-trials` makes difficult input from seeds, and runs the program on each case in a process of its own. `anastomesh check` and
`anastomesh-verify` check each mesh. This page is its output. It is not edited by hand.

<!-- shown: these commands run for as long as they are told -->
```sh
cargo build --release -p anastomesh -p anastomesh-verify -p anastomesh-trials
target/release/anastomesh-trials run --minutes 60                      # continues after the seeds of the last run
target/release/anastomesh-trials run --minutes 5 --only surfaces/      # the kinds of one table
target/release/anastomesh-trials case 'surfaces/nested cubes' 3        # one case of one kind
target/release/anastomesh-trials repeat                                # all findings again
target/release/anastomesh-trials page                                  # this page
```

`.ci/long 60` repeats the findings, runs all kinds for an hour, and compares them with earlier builds. A kind that was tried n times has
the seeds 0 to n - 1, and `--state FILE` with a new file begins again at 0. Results are kept in [trust.jsonl](trust.jsonl), with a line for
each kind and build.

Runs from {first} to {last}. Builds: {}.

Each case ends in one of five ways:

- **Valid**: exit code 0, and both checkers accept the mesh. In brackets: cases with cells that the second checker does not read, such as
  those of second order.
- **Beyond a limit**: a valid mesh that differs from the input by more than a limit, such as the distance from the network. The exit code
  is 1, and the message names the limit.
- **Called not valid**: exit code 1, and both checkers agree that the mesh is not valid. `--refine` helps in most cases.
- **Refused**: a documented exit code with a message, and no file at the output.
- **Finding**: anything else. Examples are a panic, a run of more than 60 s of processor time, more than 3 GiB of memory, and checkers that disagree.
  The limit of time grows in proportion for inputs of more than 2,000 edges, triangles or lines, that of memory up to fourfold.

All columns but one add up all builds. *Of the last, %* is the share that is valid or beyond a limit with the newest builds of a kind. They
are as many as {LAST} cases need, whose number is in brackets.

A mesh is wrong and called valid if the checkers disagree, or if the exit code is 0 and one of them rejects it. N is the number of valid
meshes that both checkers read. If none is wrong, the share of wrong ones is below 3/N with 95 % confidence, for input like that of the
trials. Times are processor times of a run with one thread. In messages, N stands for a number.

",
        versions.iter().map(|v| format!("`{v}`")).collect::<Vec<_>>().join(", ")
    )
}

/// Builds of a version. A line that was put together later names several: `anastomesh 0.1.0 builds 2c7cfb6e, 6e31239b`.
fn builds(version: &str) -> Vec<String> {
    match version.split_once(" builds ") {
        Some((name, builds)) => builds.split(", ").map(|build| format!("{name} build {build}")).collect(),
        None => vec![version.to_owned()],
    }
}

fn families(kinds: &BTreeMap<&str, Sum>) -> String {
    let mut out = String::from(
        "## Summary\n\n| family | tried | valid | valid, % | beyond a limit | valid or beyond, % | of the last, % | called not valid | refused | findings | wrong, called valid | bound 3/N | worst time, s |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (family, title, _) in FAMILIES {
        let own: Vec<&Sum> = of_family(kinds, family).map(|(_, sum)| sum).collect();
        if own.is_empty() {
            continue;
        }
        let sum = |of: &dyn Fn(&Sum) -> u64| own.iter().map(|s| of(s)).sum::<u64>();
        let (count, valid) = (sum(&|s| s.count), sum(&|s| s.valid + s.valid_by_one));
        let (beyond, wrong) = (sum(&|s| s.not_faithful()), sum(&|s| s.wrong() as u64));
        let worst = own.iter().map(|s| s.worst).fold(0.0, f64::max);
        let _ = writeln!(
            out,
            "| {title} | {} | {} | {:.1} | {} | {:.1} | {} | {} | {} | {} | {wrong} | {} | {worst:.1} |",
            grouped(count),
            grouped(valid),
            percent(valid, count),
            grouped(beyond),
            percent(valid + beyond, count),
            share([0, 1].map(|i| sum(&|s| s.last[i]))),
            grouped(sum(&|s| s.not_valid())),
            grouped(sum(&|s| s.refused())),
            sum(&|s| s.findings.len() as u64),
            bound(family, wrong, sum(&|s| s.valid)),
        );
    }
    out + "\n"
}

fn table(family: &str, title: &str, note: &str, own: &[(&str, &Sum)]) -> String {
    let mut out = format!(
        "## {title}\n\n{note}\n\nCommand: `target/release/anastomesh-trials run --minutes 5 --only {family}/`\n\n\
         | kind | tried | valid | valid, % | beyond a limit | valid or beyond, % | of the last, % | called not valid | refused | findings | bound 3/N | worst time, s (seed) |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|\n"
    );
    for (kind, sum) in own {
        let valid = sum.valid + sum.valid_by_one;
        let by_one = if sum.valid_by_one > 0 { format!(" ({})", grouped(sum.valid_by_one)) } else { String::new() };
        let _ = writeln!(
            out,
            "| {kind} | {} | {}{by_one} | {:.1} | {} | {:.1} | {} | {} | {} | {} | {} | {:.1} ({}) |",
            grouped(sum.count),
            grouped(valid),
            percent(valid, sum.count),
            grouped(sum.not_faithful()),
            percent(valid + sum.not_faithful(), sum.count),
            share(sum.last),
            grouped(sum.not_valid()),
            grouped(sum.refused()),
            sum.findings.len(),
            bound(family, sum.wrong() as u64, sum.valid),
            sum.worst,
            sum.worst_seed
        );
    }
    out += "\n| kind | exit code | message | cases |\n|---|---|---|---|\n";
    out.extend(own.iter().map(|(kind, sum)| messages(kind, sum)));
    out + "\n"
}

/// Share of valid cases and of those beyond a limit among the last ones, with the number of these.
fn share([count, good]: [u64; 2]) -> String {
    format!("{:.1} ({})", percent(good, count), grouped(count))
}

/// Rows of the most frequent messages of a kind, and of the others together.
fn messages(kind: &str, sum: &Sum) -> String {
    let mut frequent: Vec<(&String, &u64)> = sum.typed.iter().filter(|(message, _)| !is_other(message)).collect();
    frequent.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
    frequent.truncate(MESSAGES);
    let mut out = String::new();
    for (message, count) in &frequent {
        let (code, message) = message.split_once(": ").unwrap_or(("", message));
        let _ = writeln!(out, "| {kind} | {code} | {} | {} |", code_span(message), grouped(**count));
    }
    let others = sum.typed.values().sum::<u64>() - frequent.iter().map(|(_, count)| **count).sum::<u64>();
    if others > 0 {
        let _ = writeln!(out, "| {kind} | | {OTHER} | {} |", grouped(others));
    }
    out
}

/// Table of findings. A finding is fixed if the last repetition of its case had none.
fn findings(kinds: &BTreeMap<&str, Sum>, batches: &[Batch]) -> String {
    let mut out = String::from("## Findings\n\n");
    if kinds.values().all(|sum| sum.findings.is_empty()) {
        return out + "No findings.\n";
    }
    out += "`anastomesh-trials repeat` runs each finding again with the present build. A partial file is an incomplete one at the output path. \
            Mixed\nfiles are some of this run beside some of an earlier one.\n\n\
            | kind | seed | finding | found with | last repetition |\n|---|---|---|---|---|\n";
    for (kind, sum) in kinds {
        for ((seed, sort), version) in &sum.findings {
            let repeated = batches.iter().rfind(|b| b.repeats && b.kind == *kind && b.first == *seed);
            let status = match repeated.map(|batch| (batch.findings.first(), &batch.version)) {
                None => "not run again".to_owned(),
                Some((None, version)) => format!("passes with {}", code_span(version)),
                Some((Some(found), version)) => format!("{} with {}", found.sort, code_span(version)),
            };
            let _ = writeln!(out, "| {kind} | {seed} | {sort} | {} | {status} |", code_span(version));
        }
    }
    out
}

/// Bound on the share of wrong meshes. Kills and faults are tests of files, not of meshes.
fn bound(family: &str, wrong: u64, valid: u64) -> String {
    if family == "faults" || wrong > 0 || valid <= 3 { "–".into() } else { format!("{:.1e}", 3.0 / valid as f64) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::Finding;

    #[test]
    fn a_page_has_counts_messages_and_findings() {
        let mut batch = Batch { kind: "networks/star".into(), count: 1200, valid: 1190, ..Batch::default() };
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
        assert!(page.contains("| star | 3 | `it\\|is 'open'` | 9 |"), "{page}");
        assert!(page.contains("| networks/star | 7 | panic | `` | passes with `next` |\n\n## Fuzzing\n"), "{page}");
    }

    #[test]
    fn messages_counted_together_keep_the_totals() {
        let mut batch = Batch {
            kind: "networks/star".into(),
            count: 40,
            version: "program builds a, b".into(),
            ..Batch::default()
        };
        let counts =
            [("3: x", 9), ("1: NOT valid: other messages", 5), (": other messages", 4), ("1: other messages", 2)];
        batch.typed.extend(counts.map(|(message, count)| (message.to_owned(), count)));
        let page = text(&[Batch { version: "program build b".into(), count: 0, ..batch.clone() }, batch], &[]);
        assert!(page.contains("| star | 40 | 0 | 0.0 | 4 | 10.0 | 5.0 (40) | 10 | 26 | 0 | – | 0.0 (0) |"), "{page}");
        assert!(page.contains("| star | 3 | `x` | 18 |\n| star | | other messages | 22 |\n\n"), "{page}");
        assert!(page.contains("Builds: `program build a`, `program build b`."), "{page}");
    }
}
