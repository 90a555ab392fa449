//! Head of the page, with the commands and the terms of the tables.

use super::builds;
use super::result::upper_limit;
use super::sum::LAST;
use crate::format::{code_span, counted};
use crate::state::Batch;

/// First lines, before the result.
pub fn start(batches: &[Batch]) -> String {
    format!(
        "# Trials

`anastomesh-trials` makes difficult input from seeds, and runs the program on each case in a process of its own. `anastomesh check` and
`anastomesh-verify` check each mesh. This page is its output. It is not edited by hand.{}

",
        runs(batches)
    )
}

/// Days, newest build and number of builds; empty without runs.
fn runs(batches: &[Batch]) -> String {
    let Some(newest) = batches.last() else { return String::new() };
    let [first, last] = builds::days(batches.iter());
    format!(
        "\n\nRuns from {first} to {last}. Newest build: {}, of [{}](#builds).",
        code_span(&newest.version),
        counted(builds::count(batches), "build")
    )
}

/// Commands and terms, after the result.
pub fn terms() -> String {
    format!(
        "## Commands

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

## Terms

Each case of networks, surfaces, complexes and options ends in one of five ways:

- **Valid**: exit code 0, and both checkers accept the mesh. In brackets: cases with cells that the second checker does not read, such as
  those of second order.
- **Beyond a limit**: a valid mesh that differs from the input by more than a limit, such as the distance from the network. The exit code
  is 1, and the message names the limit.
- **Called not valid**: exit code 1, and both checkers agree that the mesh is not valid. `--refine` helps in most cases.
- **Refused**: a documented exit code with a message, and no file at the output.
- **Finding**: anything else. Examples are a panic, a run of more than 60 s of processor time, more than 3 GiB of memory, and checkers that disagree.
  The limit of time grows in proportion for inputs of more than 2,000 edges, triangles or lines, that of memory up to fourfold.

Faulty input, kills and faults have columns of their own. A finding is **mended** if its case passes with a later build. Otherwise it is
**open**.

All columns but one add up all builds. *Of the last, %* is the share that is valid or beyond a limit with the newest builds of a kind. They
are as many as {LAST} cases need, whose number is in brackets.

A mesh is wrong and called valid if the checkers disagree, or if the exit code is 0 and one of them rejects it. N is the number of valid
meshes that both checkers read. If none is wrong, the share of wrong ones is below 3/N with 95 % confidence, for input like that of the
trials. If some are, the result has a larger numerator: the upper limit of a Poisson distribution, such as {:.1} for 5.

Times are processor times of a run with one thread, and elapsed times of kills. *Processor time* is the sum of all recorded cases. Their
number is in brackets if earlier cases have no record, and – means no record. In messages, N stands for a number.

",
        upper_limit(5)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_build_is_named_with_the_number_of_builds() {
        let batch =
            |version: &str, date: &str| Batch { version: version.into(), date: date.into(), ..Batch::default() };
        let head = start(&[batch("v builds a, b", "2026-01-03"), batch("v build b", "2026-01-04")]);
        assert!(
            head.contains("Runs from 2026-01-03 to 2026-01-04. Newest build: `v build b`, of [2 builds](#builds)."),
            "{head}"
        );
        assert!(!start(&[]).contains("Runs"));
    }
}
