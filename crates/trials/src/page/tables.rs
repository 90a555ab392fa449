//! Tables of the page: the summary of families, and one table for each family.

use super::family::{Demand, FAMILIES, Family};
use super::sum::{Kinds, Sum};
use crate::compact::{OTHER, is_other};
use crate::format::{code_span, grouped, percent};
use std::fmt::Write as _;

/// Messages of a kind on the page. The state file has more.
const MESSAGES: usize = 4;

/// Heading of a column, and its cell for a kind or a family.
type Column = (&'static str, fn(&Sum) -> String);

const TRIED: Column = ("tried", |sum| grouped(sum.tried()));
const FINDINGS: Column = ("findings", |sum| grouped(sum.found));
const BOUND: Column = ("bound 3/N", bound);
const WORST: Column = ("worst time, s", |sum| format!("{:.1}", sum.worst));
const WORST_WITH_SEED: Column = ("worst time, s (seed)", |sum| format!("{:.1} ({})", sum.worst, sum.worst_seed));
const MINUTES: Column = ("processor time, min", minutes);

/// Columns of families of meshes.
const MESHES: [Column; 9] = [
    TRIED,
    ("valid", valid),
    ("valid, %", |sum| format!("{:.1}", percent(sum.all_valid(), sum.count))),
    ("beyond a limit", |sum| grouped(sum.not_faithful())),
    ("valid or beyond, %", |sum| format!("{:.1}", percent(sum.all_valid() + sum.not_faithful(), sum.count))),
    ("of the last, %", |sum| format!("{:.1} ({})", percent(sum.last[1], sum.last[0]), grouped(sum.last[0]))),
    ("called not valid", |sum| grouped(sum.not_valid())),
    ("refused", |sum| grouped(sum.refused())),
    FINDINGS,
];

/// Columns of faulty input.
const REFUSALS: [Column; 3] = [TRIED, ("refused as expected", |sum| grouped(sum.ended())), FINDINGS];

/// Columns of kills and faults.
const FILES: [Column; 4] = [
    TRIED,
    ("nothing lost, run completed", |sum| grouped(sum.all_valid())),
    ("nothing lost, run stopped", |sum| grouped(sum.ended())),
    FINDINGS,
];

/// Summary: a table of meshes, and a table of runs that should be refused or stopped.
pub fn summary(kinds: &Kinds) -> String {
    let meshes = [&MESHES[..], &[("wrong, called valid", |sum| grouped(sum.wrong)), BOUND, MINUTES, WORST]].concat();
    let others = [TRIED, ("as expected", |sum| grouped(as_expected(sum))), FINDINGS, MINUTES, WORST];
    let mut out =
        String::from("## Summary\n\nThe prefix selects a family in commands, such as `run --only surfaces/`.\n\n");
    out += &families(kinds, |demand| demand == Demand::Mesh, &meshes);
    let rest = families(kinds, |demand| demand != Demand::Mesh, &others);
    if !rest.is_empty() {
        out += "As expected: faulty input is refused, and nothing is lost after kills and faults.\n\n";
        out += &rest;
    }
    out
}

/// Cases of faulty input that are refused, and those of faults after which nothing is lost.
pub fn as_expected(sum: &Sum) -> u64 {
    sum.all_valid() + sum.ended()
}

/// Rows of families; empty without cases.
fn families(kinds: &Kinds, condition: impl Fn(Demand) -> bool, columns: &[Column]) -> String {
    let own = FAMILIES.iter().filter(|family| condition(family.demand));
    let rows: String = own
        .filter_map(|family| Some((family, kinds.total(family)?)))
        .map(|(family, sum)| row(&format!("{} | `{}`", family.title, family.prefix), &sum, columns))
        .collect();
    if rows.is_empty() { rows } else { heading("family | prefix", columns) + &rows + "\n" }
}

/// Section of a family; empty without cases.
pub fn section(family: &Family, kinds: &Kinds) -> String {
    let own: Vec<(&str, &Sum)> = kinds.of_family(family).collect();
    if own.is_empty() {
        return String::new();
    }
    let columns = match family.demand {
        Demand::Mesh => [&MESHES[..], &[BOUND, WORST_WITH_SEED]].concat(),
        Demand::Refusal => [&REFUSALS[..], &[WORST_WITH_SEED]].concat(),
        Demand::Files => [&FILES[..], &[WORST_WITH_SEED]].concat(),
    };
    let Family { prefix, title, note, .. } = family;
    let mut out = format!(
        "## {title}\n\n{note}\n\nCommand: `target/release/anastomesh-trials run --minutes 5 --only {prefix}`\n\n{}",
        heading("kind", &columns)
    );
    out.extend(own.iter().map(|(kind, sum)| row(kind, sum, &columns)));
    out += "\n| kind | exit code | message | cases |\n|---|---|---|---|\n";
    out.extend(own.iter().map(|(kind, sum)| messages(kind, sum)));
    out + "\n"
}

fn heading(first: &str, columns: &[Column]) -> String {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let count = first.split(" | ").count() + columns.len();
    format!("| {first} | {} |\n|{}\n", names.join(" | "), "---|".repeat(count))
}

fn row(first: &str, sum: &Sum, columns: &[Column]) -> String {
    let cells: Vec<String> = columns.iter().map(|(_, cell)| cell(sum)).collect();
    format!("| {first} | {} |\n", cells.join(" | "))
}

fn valid(sum: &Sum) -> String {
    let by_one = if sum.valid_by_one > 0 { format!(" ({})", grouped(sum.valid_by_one)) } else { String::new() };
    grouped(sum.all_valid()) + &by_one
}

/// Bound on the share of wrong meshes.
fn bound(sum: &Sum) -> String {
    if sum.wrong > 0 || sum.valid <= 3 { "–".into() } else { format!("{:.1e}", 3.0 / sum.valid as f64) }
}

/// Minutes of the cases whose time is recorded, with their number if others have none.
fn minutes(sum: &Sum) -> String {
    let minutes = format!("{:.1}", sum.seconds / 60.0);
    match sum.timed {
        0 => "–".into(),
        timed if timed < sum.count => format!("{minutes} ({})", grouped(timed)),
        _ => minutes,
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::{Batch, Finding};

    fn batch(kind: &str, count: u64, valid: u64, messages: &[(&str, u64)]) -> Batch {
        let mut batch = Batch { kind: kind.into(), count, valid, ..Batch::default() };
        batch.typed.extend(messages.iter().map(|(message, count)| ((*message).to_owned(), *count)));
        batch
    }

    fn sections(batches: &[Batch]) -> String {
        let kinds = Kinds::of(batches);
        summary(&kinds) + &FAMILIES.iter().map(|family| section(family, &kinds)).collect::<String>()
    }

    #[test]
    fn meshes_have_shares_and_a_prefix() {
        let star = batch("networks/star", 1200, 1190, &[("3: it|is `open`", 7), ("1: not faithful: far", 3)]);
        let page = sections(&[star]);
        let cells = "1,200 | 1,190 | 99.2 | 3 | 99.4 | 99.4 (1,200) | 0 | 7 | 0";
        assert!(page.contains(&format!("| Networks | `networks/` | {cells} | 0 | 2.5e-3 | – | 0.0 |")), "{page}");
        assert!(page.contains(&format!("| star | {cells} | 2.5e-3 | 0.0 (0) |")), "{page}");
        assert!(page.contains("| star | 3 | `it\\|is 'open'` | 7 |"), "{page}");
        assert!(!page.contains("As expected"), "{page}");
    }

    #[test]
    fn faulty_input_and_faults_have_their_own_columns() {
        let soup = batch("soups/fin", 8, 0, &[("3: open", 8)]);
        let mut kill = batch("faults/kill", 9, 5, &[("130: killed", 3)]);
        kill.findings.push(Finding { seed: 4, sort: "mixed files".into(), text: String::new() });
        let page = sections(&[soup, kill]);
        for rows in [
            "| family | prefix | tried | as expected | findings | processor time, min | worst time, s |\n|---|---|---|---|---|---|---|\n",
            "| Faulty input | `soups/` | 8 | 8 | 0 | – | 0.0 |\n| Kills and faults | `faults/` | 9 | 8 | 1 | – | 0.0 |\n",
            "| kind | tried | refused as expected | findings | worst time, s (seed) |\n|---|---|---|---|---|\n| fin | 8 | 8 | 0 | 0.0 (0) |\n",
            "| kind | tried | nothing lost, run completed | nothing lost, run stopped | findings | worst time, s (seed) |\n",
            "| kill | 9 | 5 | 3 | 1 | 0.0 (0) |\n",
        ] {
            assert!(page.contains(rows), "{rows}\n{page}");
        }
        assert!(!page.contains("valid, %"), "{page}");
    }

    #[test]
    fn minutes_name_the_cases_that_have_them() {
        let sum = |timed| Sum { seconds: 90.0, timed, count: 8, ..Sum::default() };
        assert_eq!([0, 5, 8].map(|timed| minutes(&sum(timed))), ["–", "1.5 (5)", "1.5"]);
    }

    #[test]
    fn messages_counted_together_keep_the_totals() {
        let counts =
            [("3: x", 9), ("1: NOT valid: other messages", 5), (": other messages", 4), ("1: other messages", 2)];
        let star = batch("networks/star", 40, 0, &counts);
        let page = sections(&[Batch { count: 0, ..star.clone() }, star]);
        assert!(page.contains("| star | 40 | 0 | 0.0 | 4 | 10.0 | 5.0 (40) | 10 | 26 | 0 | – | 0.0 (0) |"), "{page}");
        assert!(page.contains("| star | 3 | `x` | 18 |\n| star | | other messages | 22 |\n\n"), "{page}");
    }
}
