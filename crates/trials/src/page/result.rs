//! Result at the top of the page, computed from the records.

use super::family::{COMPLEXES, Demand, FAMILIES, FAULTS, FAULTY, Family, NETWORKS, REFINED, SURFACES};
use super::findings::{Found, Status};
use super::sum::{Kinds, Sum, is_wrong};
use super::tables::as_expected;
use crate::figures::number;
use crate::format::{code_span, counted, grouped, percent};
use crate::sections::{lowest_score, part};
use serde_json::Value;

/// Fuzz targets of the volume mesher. Others test readers, checks and the preparation of networks.
const CORE: [&str; 3] = ["delaunay", "plc", "tetrahedralize"];

/// List of results. A result without records is left out.
pub fn text(kinds: &Kinds, findings: &[Found], figures: &[Value]) -> String {
    let items = [
        meshes(kinds, findings),
        open(kinds, findings),
        networks(kinds),
        refused(kinds),
        expected(kinds),
        mutation(figures),
        fuzzing(figures),
    ];
    let items: String = items.into_iter().flatten().map(|item| format!("- {item}\n")).collect();
    format!(
        "## Result\n\nThis list is computed from the records of all builds. [Terms](#terms) are explained below.\n\n{items}\n"
    )
}

fn meshes(kinds: &Kinds, findings: &[Found]) -> Option<String> {
    let own = FAMILIES.into_iter().filter(|family| family.demand == Demand::Mesh);
    let sums: Vec<Sum> = own.filter_map(|family| kinds.total(family)).collect();
    let accepted: u64 = sums.iter().map(|sum| sum.valid).sum();
    let wrong: u64 = sums.iter().map(|sum| sum.wrong).sum();
    let open = findings.iter().filter(|found| is_wrong(found.sort) && found.is_open()).count() as u64;
    let verdict = match wrong {
        0 => "Wrong and called valid: 0.".to_owned(),
        _ => format!("Wrong and called valid: {} ({} mended, {open} open).", grouped(wrong), wrong - open),
    };
    (!sums.is_empty()).then(|| {
        format!(
            "**[Meshes](#summary)**: both checkers accept N = {}. {verdict} {}.",
            grouped(accepted),
            bound(wrong, accepted)
        )
    })
}

/// Bound on the share of wrong meshes: 3/N if none is wrong, more otherwise.
fn bound(wrong: u64, accepted: u64) -> String {
    let limit = upper_limit(wrong);
    let numerator = if wrong == 0 { "3".to_owned() } else { format!("{limit:.1}") };
    if accepted as f64 <= limit {
        return "They are too few for a bound on the share of wrong ones".into();
    }
    format!("The share of wrong ones is below {numerator}/N = {:.1e} with 95 % confidence", limit / accepted as f64)
}

/// Upper limit of the mean of a Poisson distribution after a count, with 95 % confidence (Garwood 1936).
pub fn upper_limit(count: u64) -> f64 {
    let probability = |mean: f64| {
        let mut term = (-mean).exp();
        let mut sum = term;
        for i in 1..=count {
            term *= mean / i as f64;
            sum += term;
        }
        sum
    };
    // Counts beyond some hundreds would underflow, and need no exact limit.
    let (mut low, mut high) = (count as f64, 2.0 * count as f64 + 10.0);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if probability(middle) > 0.05 { low = middle } else { high = middle }
    }
    high
}

fn open(kinds: &Kinds, findings: &[Found]) -> Option<String> {
    let cases: u64 = kinds.0.values().map(Sum::tried).sum();
    let open: Vec<&Found> = findings.iter().filter(|found| found.is_open()).collect();
    let [total, count] = [findings.len(), open.len()];
    let mended = if total > 0 { format!(" ({} mended, {count} open)", total - count) } else { String::new() };
    let sorts = if count > 0 { sorts(&open) } else { String::new() };
    (cases > 0).then(|| format!("**[Findings](#findings)** in {}: {total}{mended}.{sorts}", counted(cases, "case")))
}

/// Sorts of open findings.
fn sorts(open: &[&Found]) -> String {
    let of = |condition: &dyn Fn(&Found) -> bool| open.iter().filter(|found| condition(found)).count() as u64;
    let [panics, hangs] = ["panic", "hang"].map(|sort| of(&|found| found.sort == sort));
    format!(
        " Open: {}, {} and {}. Not run again: {}.",
        counted(panics, "panic"),
        counted(hangs, "hang"),
        counted(open.len() as u64 - panics - hangs, "other"),
        of(&|found| found.status == Status::NotRun)
    )
}

fn networks(kinds: &Kinds) -> Option<String> {
    let share = |family: &Family| {
        let sum = kinds.total(family)?;
        let share = percent(sum.all_valid() + sum.not_faithful(), sum.count);
        Some(format!("{share:.1} % of {}", grouped(sum.count)))
    };
    let refined = share(&REFINED).map_or_else(String::new, |share| format!(" With `--refine`, {share} do."));
    share(&NETWORKS).map(|share| {
        format!("**[Networks](#networks)**: {share} give a valid mesh, some of them beyond a limit.{refined}")
    })
}

fn refused(kinds: &Kinds) -> Option<String> {
    let count = |family: &Family| {
        let own = kinds.of_family(family).map(|(_, sum)| sum);
        let refused = own.map(|sum| sum.ended() + sum.with_finding("valid input refused")).sum::<u64>();
        Some(format!("{} of {}", grouped(refused), grouped(kinds.total(family)?.count)))
    };
    let complexes = count(&COMPLEXES).map_or_else(String::new, |count| {
        format!(" [Complexes with regions](#complexes-with-regions) refused: {count}.")
    });
    count(&SURFACES).map(|count| format!("**[Valid surfaces](#surfaces) refused**: {count}.{complexes}"))
}

fn expected(kinds: &Kinds) -> Option<String> {
    let count = |family: &Family| {
        let sum = kinds.total(family)?;
        Some(format!("{} of {}", grouped(as_expected(&sum)), grouped(sum.tried())))
    };
    let faulty = count(&FAULTY).map(|count| format!("**[Faulty input](#faulty-input) refused**: {count}."));
    let faults =
        count(&FAULTS).map(|count| format!("**[Kills and faults](#kills-and-faults) with nothing lost**: {count}."));
    let both: Vec<String> = [faulty, faults].into_iter().flatten().collect();
    (!both.is_empty()).then(|| both.join(" "))
}

fn of_figure<'a>(figures: &'a [Value], name: &str) -> Vec<&'a Value> {
    figures.iter().filter(|figure| figure["figure"] == name).collect()
}

fn mutation(figures: &[Value]) -> Option<String> {
    let own = of_figure(figures, "mutants");
    let (figure, score) = lowest_score(&own)?;
    let [tried, of] = ["tried", "of"].map(|key| number(figure, key));
    Some(format!(
        "**[Mutation tests](#mutation)**: the lowest score of {} is {score:.1} %, that of {} with {} of {} tried.",
        counted(own.len() as u64, "part"),
        code_span(part(figure)),
        grouped(tried),
        counted(of, "mutant")
    ))
}

fn fuzzing(figures: &[Value]) -> Option<String> {
    let mut own = of_figure(figures, "fuzz");
    own.retain(|figure| CORE.contains(&part(figure)));
    let [executions, findings] =
        ["executions", "findings"].map(|key| own.iter().map(|figure| number(figure, key)).sum::<u64>());
    let parts: Vec<String> = own
        .iter()
        .map(|figure| format!("{} {}", code_span(part(figure)), grouped(number(figure, "executions"))))
        .collect();
    (!own.is_empty()).then(|| {
        format!(
            "**[Fuzzing](#fuzzing) of the core**: {} ({}), with {}.",
            counted(executions, "execution"),
            parts.join(", "),
            counted(findings, "finding")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::findings;
    use crate::state::{Batch, Finding};
    use serde_json::json;

    fn batch(kind: &str, count: u64, valid: u64, findings: &[(u64, &str)]) -> Batch {
        let finding = |(seed, sort): &(u64, &str)| Finding { seed: *seed, sort: (*sort).into(), text: String::new() };
        let findings = findings.iter().map(finding).collect();
        Batch { kind: kind.into(), count, valid, findings, version: "v build 1".into(), ..Batch::default() }
    }

    fn repeat(kind: &str, seed: u64) -> Batch {
        Batch { first: seed, repeats: true, version: "v build 2".into(), ..batch(kind, 1, 1, &[]) }
    }

    fn result(batches: &[Batch], figures: &[Value]) -> String {
        let kinds = Kinds::of(batches);
        text(&kinds, &findings::all(&kinds, batches), figures)
    }

    fn check(page: &str, lines: &[&str]) {
        for line in lines {
            assert!(page.contains(&format!("- {line}\n")), "{line}\n{page}");
        }
    }

    #[test]
    fn clean_records_have_the_bound_of_three() {
        let batches = [batch("surfaces/a", 2000, 2000, &[]), batch("complexes/a", 1000, 1000, &[])];
        let page = result(&batches, &[]);
        check(
            &page,
            &[
                "**[Meshes](#summary)**: both checkers accept N = 3,000. Wrong and called valid: 0. The share of wrong ones is below 3/N = 1.0e-3 with 95 % confidence.",
                "**[Findings](#findings)** in 3,000 cases: 0.",
                "**[Valid surfaces](#surfaces) refused**: 0 of 2,000. [Complexes with regions](#complexes-with-regions) refused: 0 of 1,000.",
            ],
        );
        assert!(!page.contains("Networks") && !page.contains("Fuzzing"), "{page}");
    }

    #[test]
    fn findings_are_mended_or_open() {
        let found = [(3, "called valid"), (4, "checkers disagree"), (5, "panic"), (6, "hang"), (7, "files left")];
        let mut walk = batch("networks/walk", 1000, 900, &found);
        walk.typed.extend([("1: not faithful: far".to_owned(), 50), ("1: NOT valid: open".to_owned(), 45)]);
        let mut hang = repeat("networks/walk", 6);
        hang.findings.push(Finding { seed: 6, sort: "hang".into(), text: String::new() });
        let page = result(&[walk, repeat("networks/walk", 3), repeat("networks/walk", 5), hang], &[]);
        check(
            &page,
            &[
                "**[Meshes](#summary)**: both checkers accept N = 900. Wrong and called valid: 2 (1 mended, 1 open). The share of wrong ones is below 6.3/N = 7.0e-3 with 95 % confidence.",
                "**[Findings](#findings)** in 1,000 cases: 5 (2 mended, 3 open). Open: 0 panics, 1 hang and 2 others. Not run again: 2.",
                "**[Networks](#networks)**: 95.0 % of 1,000 give a valid mesh, some of them beyond a limit.",
            ],
        );
    }

    #[test]
    fn refusals_and_losses_are_counted() {
        let surfaces = batch("surfaces/a", 10, 8, &[(1, "valid input refused"), (2, "valid input refused")]);
        let mut soups = batch("soups/a", 5, 0, &[(1, "accepted")]);
        soups.typed.insert("3: open".into(), 4);
        let mut faults = batch("faults/a", 9, 3, &[(1, "mixed files")]);
        faults.typed.extend([("0: not tried: no mount".to_owned(), 1), ("130: killed".to_owned(), 4)]);
        let page = result(&[surfaces, soups, faults], &[]);
        check(
            &page,
            &[
                "**[Valid surfaces](#surfaces) refused**: 2 of 10.",
                "**[Faulty input](#faulty-input) refused**: 4 of 5. **[Kills and faults](#kills-and-faults) with nothing lost**: 7 of 8.",
            ],
        );
    }

    #[test]
    fn figures_of_other_programs_are_summed() {
        let figures = [
            json!({"figure": "mutants", "part": "a", "tried": 9, "of": 20, "caught": 3, "timeouts": 1, "missed": 1}),
            json!({"figure": "mutants", "part": "b", "tried": 9, "of": 9, "caught": 9}),
            json!({"figure": "fuzz", "part": "delaunay", "executions": 1_000_000}),
            json!({"figure": "fuzz", "part": "plc", "executions": 2000, "findings": 1}),
            json!({"figure": "fuzz", "part": "stl", "executions": 5}),
        ];
        let page = result(&[], &figures);
        check(
            &page,
            &[
                "**[Mutation tests](#mutation)**: the lowest score of 2 parts is 80.0 %, that of `a` with 9 of 20 mutants tried.",
                "**[Fuzzing](#fuzzing) of the core**: 1,002,000 executions (`delaunay` 1,000,000, `plc` 2,000), with 1 finding.",
            ],
        );
        assert_eq!(page.matches("- ").count(), 2, "{page}");
    }

    #[test]
    fn limits_of_poisson_are_those_of_tables() {
        for (count, limit) in [(0, 2.9957), (1, 4.7439), (5, 10.5130), (10, 16.9622)] {
            assert!((upper_limit(count) - limit).abs() < 1e-3, "{count}: {}", upper_limit(count));
        }
    }
}
