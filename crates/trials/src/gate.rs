//! Gate: compares the newest build with earlier ones.

use crate::state::Batch;
use std::collections::BTreeMap;

/// Standard deviations of a share that chance explains. With 130 kinds, it exceeds 4 by chance once in 100 comparisons.
const DEVIATIONS: f64 = 4.0;

#[derive(Clone, Copy, Debug, Default)]
struct Share {
    count: u64,
    valid: u64,
    findings: u64,
}

impl Share {
    fn add(&mut self, batch: &Batch) {
        self.count += batch.count;
        self.valid += batch.valid + batch.valid_by_one;
        self.findings += batch.findings.len() as u64;
    }

    fn of(part: u64, whole: u64) -> f64 {
        part as f64 / whole.max(1) as f64
    }
}

/// Kinds in which the build of the last batch has a smaller share of valid cases, or more findings, than earlier builds.
pub fn compare(batches: &[Batch]) -> Vec<String> {
    let Some(newest) = batches.last().map(|batch| &batch.version) else { return Vec::new() };
    let mut shares: BTreeMap<&str, [Share; 2]> = BTreeMap::new();
    for batch in batches.iter().filter(|batch| !batch.repeats) {
        let is_new = usize::from(batch.version == *newest);
        shares.entry(&batch.kind).or_default()[is_new].add(batch);
    }
    shares.into_iter().flat_map(|(kind, [old, new])| worse(kind, old, new)).collect()
}

fn worse(kind: &str, old: Share, new: Share) -> Vec<String> {
    if old.count == 0 || new.count == 0 {
        return Vec::new();
    }
    let mut out = Vec::new();
    let rises = |a: u64, b: u64| is_larger([a, old.count], [b, new.count]);
    if rises(old.count - old.valid, new.count - new.valid) {
        let [before, after] = [old, new].map(|share| 100.0 * Share::of(share.valid, share.count));
        out.push(format!("{kind}: {after:.1} % valid, {before:.1} % before"));
    }
    if rises(old.findings, new.findings) || (old.findings == 0 && new.findings > 0) {
        let [before, after] = [old, new].map(|share| format!("{} of {}", share.findings, share.count));
        out.push(format!("{kind}: findings {after}, {before} before"));
    }
    out
}

/// True if the share of the second pair exceeds that of the first by more than chance explains.
fn is_larger([a, whole_a]: [u64; 2], [b, whole_b]: [u64; 2]) -> bool {
    let pooled = Share::of(a + b, whole_a + whole_b);
    let deviation = (pooled * (1.0 - pooled) * (1.0 / whole_a as f64 + 1.0 / whole_b as f64)).sqrt();
    Share::of(b, whole_b) - Share::of(a, whole_a) > DEVIATIONS * deviation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::Finding;

    fn batch(version: &str, count: u64, valid: u64) -> Batch {
        Batch { kind: "a/b".into(), version: version.into(), count, valid, ..Batch::default() }
    }

    #[test]
    fn worse_builds_are_named() {
        assert!(compare(&[]).is_empty());
        assert!(compare(&[batch("1", 100, 90), batch("2", 100, 88)]).is_empty());
        assert_eq!(compare(&[batch("1", 100, 90), batch("2", 100, 40)]), ["a/b: 40.0 % valid, 90.0 % before"]);
        assert!(compare(&[batch("1", 100, 40), batch("2", 100, 90)]).is_empty());
        let finding = Finding { seed: 0, sort: "panic".into(), text: String::new() };
        let bad = Batch { findings: vec![finding], ..batch("2", 100, 89) };
        assert_eq!(compare(&[batch("1", 100, 90), bad]), ["a/b: findings 1 of 100, 0 of 100 before"]);
    }
}
