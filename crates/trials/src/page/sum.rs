//! Sums of the batches of a kind, and of the kinds of a family.

use super::family::Family;
use crate::state::{Batch, Finding};
use std::collections::BTreeMap;

/// Minimum number of a kind's last cases. Whole builds are counted, from the newest on.
pub const LAST: u64 = 30;

/// Sum of batches.
#[derive(Clone, Debug, Default)]
pub struct Sum {
    /// Numbers of the last cases, and of the valid ones among them with those beyond a limit.
    pub last: [u64; 2],
    pub count: u64,
    pub valid: u64,
    pub valid_by_one: u64,
    pub typed: BTreeMap<String, u64>,
    /// Builds of the findings, by seed and sort.
    pub findings: BTreeMap<(u64, String), String>,
    pub worst: f64,
    pub worst_seed: u64,
    /// Processor seconds of the cases in `timed`.
    pub seconds: f64,
    /// Cases whose time is recorded.
    pub timed: u64,
    /// Number of findings. Sums of families have no list of them, because kinds have the same seeds.
    pub found: u64,
    /// Cases that were called valid, and are not by at least one checker.
    pub wrong: u64,
}

impl Sum {
    /// Sum of the batches of a kind, the newest first.
    pub fn of(batches: &[&Batch]) -> Self {
        let mut sum = Self::default();
        for batch in batches {
            sum.add(batch);
            if sum.last[0] < LAST {
                sum.last = [sum.count, sum.valid + sum.valid_by_one + sum.not_faithful()];
            }
        }
        sum.found = sum.findings.len() as u64;
        sum.wrong = sum.findings.keys().filter(|(_, sort)| is_wrong(sort)).count() as u64;
        sum
    }

    /// Sum of the kinds of a family, without the seeds of its findings.
    pub fn total<'a>(kinds: impl Iterator<Item = &'a Self>) -> Self {
        let mut total = Self::default();
        for kind in kinds {
            total.last = [0, 1].map(|i| total.last[i] + kind.last[i]);
            total.count += kind.count;
            total.valid += kind.valid;
            total.valid_by_one += kind.valid_by_one;
            total.add_messages(&kind.typed);
            total.worst = total.worst.max(kind.worst);
            total.seconds += kind.seconds;
            total.timed += kind.timed;
            total.found += kind.found;
            total.wrong += kind.wrong;
        }
        total
    }

    fn add(&mut self, batch: &Batch) {
        self.count += batch.count;
        self.valid += batch.valid;
        self.valid_by_one += batch.valid_by_one;
        self.add_messages(&batch.typed);
        let key = |finding: &Finding| (finding.seed, finding.sort.clone());
        self.findings.extend(batch.findings.iter().map(|f| (key(f), batch.version.clone())));
        if batch.worst > self.worst {
            (self.worst, self.worst_seed) = (batch.worst, batch.worst_seed);
        }
        self.seconds += batch.seconds;
        self.timed += batch.timed;
    }

    fn add_messages(&mut self, typed: &BTreeMap<String, u64>) {
        for (message, count) in typed {
            *self.typed.entry(message.clone()).or_default() += count;
        }
    }

    /// Valid cases.
    pub fn all_valid(&self) -> u64 {
        self.valid + self.valid_by_one
    }

    /// Cases that ended with a documented exit code and a message.
    pub fn ended(&self) -> u64 {
        self.typed.values().sum::<u64>() - self.not_tried()
    }

    /// Cases without a mesh at the output.
    pub fn refused(&self) -> u64 {
        self.ended() - self.not_faithful() - self.not_valid()
    }

    /// Meshes that the program and both checkers call not valid.
    pub fn not_valid(&self) -> u64 {
        self.with(|message| message.starts_with("1: NOT valid"))
    }

    /// Valid meshes beyond a limit, such as that on the distance from the network.
    pub fn not_faithful(&self) -> u64 {
        self.with(|message| message.starts_with("1: ") && !message.starts_with("1: NOT valid"))
    }

    /// Cases that ran. Some machines cannot make some faults: `faults::trial::skipped` gives them the code 0.
    pub fn tried(&self) -> u64 {
        self.count - self.not_tried()
    }

    fn not_tried(&self) -> u64 {
        self.with(|message| message.starts_with("0: "))
    }

    /// Cases whose message satisfies a condition.
    fn with(&self, condition: impl Fn(&str) -> bool) -> u64 {
        self.typed.iter().filter(|(message, _)| condition(message)).map(|(_, count)| count).sum()
    }

    /// Findings of a sort, of a kind.
    pub fn with_finding(&self, sort: &str) -> u64 {
        self.findings.keys().filter(|(_, found)| found == sort).count() as u64
    }
}

/// True for findings of meshes that are wrong and called valid.
pub fn is_wrong(sort: &str) -> bool {
    ["called valid", "checkers disagree"].contains(&sort)
}

/// Sums of all kinds, by family and name.
pub struct Kinds<'a>(pub BTreeMap<&'a str, Sum>);

impl<'a> Kinds<'a> {
    /// Sums without repetitions.
    pub fn of(batches: &'a [Batch]) -> Self {
        let mut kinds: BTreeMap<&str, Vec<&Batch>> = BTreeMap::new();
        for batch in batches.iter().filter(|batch| !batch.repeats).rev() {
            kinds.entry(&batch.kind).or_default().push(batch);
        }
        Self(kinds.into_iter().map(|(kind, batches)| (kind, Sum::of(&batches))).collect())
    }

    /// Kinds of a family, by name.
    pub fn of_family(&self, family: &Family) -> impl Iterator<Item = (&'a str, &Sum)> {
        self.0.iter().filter_map(|(kind, sum)| Some((kind.strip_prefix(family.prefix)?, sum)))
    }

    /// Sum of a family; `None` without cases.
    pub fn total(&self, family: &Family) -> Option<Sum> {
        let total = Sum::total(self.of_family(family).map(|(_, sum)| sum));
        (total.count > 0).then_some(total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_that_a_machine_cannot_make_are_not_tried() {
        let mut batch = Batch { kind: "faults/full".into(), count: 9, valid: 2, ..Batch::default() };
        batch.typed.extend([("0: not tried: no mount".to_owned(), 4), ("3: full".to_owned(), 3)]);
        let sum = Sum::of(&[&batch]);
        assert_eq!((sum.tried(), sum.ended(), sum.refused()), (5, 3, 3));
    }

    #[test]
    fn a_family_adds_up_kinds_with_equal_seeds() {
        let mut batch = Batch { count: 2, worst: 3.0, seconds: 4.0, timed: 1, ..Batch::default() };
        batch.findings.push(Finding { seed: 1, sort: "called valid".into(), text: String::new() });
        let kind = Sum::of(&[&batch]);
        let total = Sum::total([&kind, &kind].into_iter());
        assert_eq!((total.count, total.found, total.wrong, total.last), (4, 2, 2, [4, 0]));
        assert_eq!((total.worst, total.seconds, total.timed), (3.0, 8.0, 2));
    }
}
