//! Sections of the page for figures of other programs.

use crate::figures::number;
use crate::format::{code_span, grouped, percent};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Quantile of the normal distribution for intervals of 95 %.
const QUANTILE: f64 = 1.96;

/// Writer of a section.
type Section = fn(&[&Value]) -> String;

/// Text of all sections. A section without figures is left out.
pub fn text(figures: &[Value]) -> String {
    let sections: [(&str, Section); 4] =
        [("mutants", mutation), ("coverage", coverage), ("fuzz", fuzzing), ("predicates", predicates)];
    let mut out = String::new();
    for (name, section) in sections {
        let own: Vec<&Value> = figures.iter().filter(|figure| figure["figure"] == name).collect();
        if !own.is_empty() {
            out = out + "\n" + &section(&own);
        }
    }
    out
}

/// Name of the part.
pub fn part(figure: &Value) -> &str {
    figure["part"].as_str().unwrap_or_default()
}

fn day(figure: &Value) -> &str {
    figure["date"].as_str().unwrap_or_default()
}

fn mutation(figures: &[&Value]) -> String {
    let mut out = String::from(
        "## Mutation\n\n\
         Each mutant is a small change of the sources. The tests should fail with it. The score is the share of compiled mutants that make a \
         test fail\nor time out. A score of a sample has an interval of 95 % confidence. Not tried: deleted fields of structures, and \
         constants for functions that\nreturn `impl Trait`. The table in `.ci/long` has the files of each part.\n\
         `anastomesh-mutants` tries each mutant with the tests that reach it, without those that run the program. Mutants that cannot be\n\
         caught, or are not worth a test, have a reason in [survivors.txt](../crates/mutants/survivors.txt). They count as missed.\n\n\
         Command: `.ci/long mutants`, or `PARTS=\"check store\" .ci/long mutants` for some parts\n\n\
         | part | tried | of | caught | timeouts | missed | missed, explained | unviable | score, % | day |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for figure in figures {
        let numbers =
            ["tried", "of", "caught", "timeouts", "missed", "explained", "unviable"].map(|key| number(figure, key));
        let cells = numbers.map(grouped).join(" | ");
        let _ = writeln!(out, "| {} | {cells} | {} | {} |", code_span(part(figure)), score(numbers), day(figure));
    }
    for figure in figures.iter().filter(|figure| number(figure, "missed") > number(figure, "explained")) {
        out += &missed(figure);
    }
    out
}

/// Part with the lowest score, and this score in percent.
pub fn lowest_score<'a>(figures: &[&'a Value]) -> Option<(&'a Value, f64)> {
    let score = |figure: &'a Value| {
        let [caught, timeouts, missed] = ["caught", "timeouts", "missed"].map(|key| number(figure, key));
        let whole = caught + timeouts + missed;
        (whole > 0).then(|| (figure, percent(caught + timeouts, whole)))
    };
    figures.iter().copied().filter_map(score).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Score in percent, with its interval if the mutants are a sample.
fn score([tried, of, caught, timeouts, missed, ..]: [u64; 7]) -> String {
    let (part, whole) = (caught + timeouts, caught + timeouts + missed);
    if whole == 0 {
        return "–".into();
    }
    let score = format!("{:.1}", percent(part, whole));
    // Kinds that are not tried are no random sample.
    if 10 * tried >= 8 * of {
        return score;
    }
    let [low, high] = wilson(part, whole);
    format!("{score} ({:.1} to {:.1})", 100.0 * low, 100.0 * high)
}

/// Score interval of a share (Wilson 1927).
fn wilson(part: u64, whole: u64) -> [f64; 2] {
    let (n, z2) = (whole as f64, QUANTILE * QUANTILE);
    let p = part as f64 / n;
    let centre = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = QUANTILE / (1.0 + z2 / n) * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
    [(centre - half).max(0.0), (centre + half).min(1.0)]
}

fn missed(figure: &Value) -> String {
    let names = figure["names"].as_array().map_or(&[][..], Vec::as_slice);
    let title = format!("\nMissed mutants of {} without a reason", code_span(part(figure)));
    if names.is_empty() {
        return format!("{title}: {}\n", grouped(number(figure, "missed") - number(figure, "explained")));
    }
    let lines = names.iter().filter_map(Value::as_str).map(|name| format!("- `{}`\n", name.replace('`', "'")));
    format!("{title}:\n\n{}", lines.collect::<String>())
}

fn coverage(figures: &[&Value]) -> String {
    let folders: BTreeMap<&str, [u64; 2]> = figures
        .iter()
        .filter_map(|figure| figure["folders"].as_object())
        .flatten()
        .map(|(folder, lines)| (folder.as_str(), [0, 1].map(|i| lines[i].as_u64().unwrap_or(0))))
        .collect();
    // Sums of crates have no folder, so that they are first.
    let mut rows: BTreeMap<(String, &str), [u64; 2]> = BTreeMap::new();
    for (folder, lines) in &folders {
        for row in [("all crates".to_owned(), ""), (crate_of(folder), ""), (crate_of(folder), *folder)] {
            let sum = rows.entry(row).or_default();
            *sum = [sum[0] + lines[0], sum[1] + lines[1]];
        }
    }
    let days: Vec<&str> = figures.iter().map(|figure| day(figure)).collect();
    let mut out = format!(
        "## Coverage\n\nLines that the tests of the crates in the table run, on {}. A row in bold is a crate. The row of its folder `src` \
         has the files\ndirectly in it.\n\nCommand: `.ci/long coverage`\n\n| part | lines | covered | % |\n|---|---|---|---|\n",
        days.join(", ")
    );
    for ((name, folder), [lines, covered]) in rows {
        let name = if folder.is_empty() { format!("**{name}**") } else { code_span(folder) };
        let share = percent(covered, lines);
        let _ = writeln!(out, "| {name} | {} | {} | {share:.1} |", grouped(lines), grouped(covered));
    }
    out
}

/// Crate of a folder; that of the program has the folder `src`.
fn crate_of(folder: &str) -> String {
    let name = folder.strip_prefix("crates/").and_then(|rest| rest.split('/').next());
    name.map_or_else(|| "anastomesh".to_owned(), |name| format!("anastomesh-{name}"))
}

fn fuzzing(figures: &[&Value]) -> String {
    let mut out = String::from(
        "## Fuzzing\n\nExecutions of all recorded runs of libFuzzer: each run adds to them. A finding is a run that ended with a crash, or beyond a limit of \
         time or memory.\n\nCommand: `TARGETS=delaunay .ci/long 60 fuzz`, or all targets without `TARGETS`\n\n\
         | target | executions | edges covered | findings | last run |\n|---|---|---|---|---|\n",
    );
    for figure in figures {
        let cells = ["executions", "edges", "findings"].map(|key| grouped(number(figure, key))).join(" | ");
        let _ = writeln!(out, "| {} | {cells} | {} |", part(figure), day(figure));
    }
    out
}

fn predicates(figures: &[&Value]) -> String {
    let mut out = String::from(
        "## Predicates\n\nSigns of geometric predicates, compared with exact integers. Degenerate cases have the sign 0.\n\n\
         Command: `COUNT=260000000 .ci/long predicates`\n\n\
         | predicate | compared | differ | degenerate | day |\n|---|---|---|---|---|\n",
    );
    for figure in figures {
        let cells = ["compared", "differ", "zero"].map(|key| grouped(number(figure, key))).join(" | ");
        let _ = writeln!(out, "| {} | {cells} | {} |", part(figure), day(figure));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn each_figure_has_a_row() {
        assert_eq!(text(&[]), "");
        let figures = [
            json!({"figure": "mutants", "part": "a", "tried": 100, "of": 1000, "caught": 79, "missed": 10, "explained": 9, "timeouts": 1, "unviable": 10, "names": ["f | g"], "date": "d"}),
            json!({"figure": "mutants", "part": "b", "tried": 3, "of": 3, "caught": 2, "missed": 1, "names": [], "date": "d"}),
            json!({"figure": "coverage", "folders": {"crates/tet/src": [10, 5], "crates/tet/src/refine": [30, 30], "src": [10, 1]}}),
            json!({"figure": "fuzz", "part": "off", "executions": 1_200_000, "edges": 500, "findings": 0, "date": "d"}),
            json!({"figure": "predicates", "part": "orient3d", "compared": 1000, "differ": 0, "zero": 7, "date": "d"}),
        ];
        let page = text(&figures);
        for row in [
            "| `a` | 100 | 1,000 | 79 | 1 | 10 | 9 | 10 | 88.9 (80.7 to 93.9) | d |",
            "Missed mutants of `a` without a reason:\n\n- `f | g`\n",
            "| `b` | 3 | 3 | 2 | 0 | 1 | 0 | 0 | 66.7 | d |",
            "Missed mutants of `b` without a reason: 1\n",
            "| **all crates** | 50 | 36 | 72.0 |\n| **anastomesh** | 10 | 1 | 10.0 |\n| `src` | 10 | 1 | 10.0 |\n| **anastomesh-tet** | 40 | 35 | 87.5 |\n| `crates/tet/src` | 10 | 5 | 50.0 |\n",
            "| off | 1,200,000 | 500 | 0 | d |",
            "| orient3d | 1,000 | 0 | 7 | d |",
        ] {
            assert!(page.contains(row), "{row}\n{page}");
        }
    }

    #[test]
    fn intervals_stay_within_bounds() {
        assert_eq!(wilson(10, 10)[1], 1.0);
        assert_eq!(wilson(0, 10)[0], 0.0);
        // 5 of 10: 0.2366 to 0.7634.
        let [low, high] = wilson(5, 10);
        assert!((low - 0.2366).abs() < 1e-4 && (high - 0.7634).abs() < 1e-4, "{low} {high}");
    }
}
