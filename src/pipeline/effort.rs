//! Effort for retries in a run. Blocks that fail take the full budget as long as failures are rare. If a
//! run has spent much on failed blocks, further blocks get quick attempts only. The run then ends in reasonable time.

use std::sync::atomic::{AtomicU64, Ordering};

/// Operations of failed blocks after which further blocks get a reduced budget: a constant, plus a number per expected
/// operation of the run. The expected operations alone take the time of the estimate.
const MUCH: [f64; 2] = [3e8, 2.0];

/// Multiple of [`MUCH`] after which no other partition or network is tried.
const HOPELESS: u64 = 2;

/// Operations that all clusters of a run may take together beyond those in proportion to their size, were all to fail.
const ALL_CLUSTERS: f64 = 2e10;

/// Bounds of a cluster's share of it. The smaller one lets a bifurcation be tried in every way.
const CLUSTER: [f64; 2] = [3e7, 1e8];

/// Expected operations of an attempt from which a cluster is large: about half a second.
pub const LARGE: f64 = 2e7;

/// Number of operations per expected one beyond that.
const PER_OPERATION_OF_LARGE: f64 = 10.0;

/// Maximum operations of all attempts at a cluster: a constant, plus a number per expected operation of the usual one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    pub constant: f64,
    pub per_operation: f64,
    /// Number per expected operation beyond those of a [`LARGE`] cluster.
    pub per_operation_of_large: f64,
}

impl Effort {
    /// Effort per cluster where failures are rare.
    pub fn full(clusters: usize) -> Self {
        Self {
            constant: (ALL_CLUSTERS / clusters.max(1) as f64).clamp(CLUSTER[0], CLUSTER[1]),
            per_operation: 25.0,
            per_operation_of_large: PER_OPERATION_OF_LARGE,
        }
    }

    /// Effort in proportion to the expected operations, beyond a constant.
    pub const fn linear(constant: f64, per_operation: f64) -> Self {
        Self { constant, per_operation, per_operation_of_large: per_operation }
    }

    /// Maximum operations. Casts of what is too large end at the largest integer.
    pub fn limit(self, expected: f64) -> u64 {
        let small = expected.min(LARGE);
        let large = expected - small;
        (self.constant + self.per_operation * small + self.per_operation_of_large * large) as u64
    }

    /// Effort where they are not.
    const REDUCED: Self = Self::linear(1e7, 4.0);
}

/// Operations that a run expects, and those of blocks that failed. Only failed blocks count: they are made again by a run
/// that continues, which therefore decides alike.
#[derive(Debug, Default)]
pub struct Ledger {
    expected: AtomicU64,
    in_vain: AtomicU64,
}

impl Ledger {
    /// Records the expected operations of the run.
    pub fn expect(&self, operations: f64) {
        self.expected.fetch_max(operations as u64, Ordering::Relaxed);
    }

    /// Counts the operations of a failed block.
    pub fn add(&self, operations: u64) {
        self.in_vain.fetch_add(operations, Ordering::Relaxed);
    }

    /// Effort for each cluster of a run with this number of clusters. Must not be asked while blocks are made, as results would depend on the order.
    pub fn effort(&self, clusters: usize) -> Effort {
        if self.in_vain() > self.much() { Effort::REDUCED } else { Effort::full(clusters) }
    }

    /// True if another partition or network is not worth trying.
    pub fn is_hopeless(&self) -> bool {
        self.in_vain() > HOPELESS * self.much()
    }

    fn in_vain(&self) -> u64 {
        self.in_vain.load(Ordering::Relaxed)
    }

    fn much(&self) -> u64 {
        (MUCH[0] + MUCH[1] * self.expected.load(Ordering::Relaxed) as f64) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effort_falls_when_much_was_spent_in_vain() {
        let ledger = Ledger::default();
        ledger.expect(1e9);
        ledger.expect(1e8);
        assert_eq!(ledger.effort(10), Effort::full(10));
        ledger.add(2_200_000_000);
        assert_eq!((ledger.effort(10), ledger.is_hopeless()), (Effort::full(10), false));
        ledger.add(200_000_000);
        assert_eq!((ledger.effort(10), ledger.is_hopeless()), (Effort::REDUCED, false));
        ledger.add(2_300_000_000);
        assert!(ledger.is_hopeless());
    }

    #[test]
    fn large_clusters_get_less_per_operation() {
        let effort = Effort { constant: 1.0, per_operation: 25.0, per_operation_of_large: 4.0 };
        let limits = [0.0, LARGE, 3.0 * LARGE].map(|expected| effort.limit(expected));
        assert_eq!(limits, [1, 1 + 25 * LARGE as u64, 1 + 33 * LARGE as u64]);
        assert_eq!(Effort::linear(2.0, 3.0).limit(10.0 * LARGE), 2 + 30 * LARGE as u64);
        assert_eq!(effort.limit(f64::INFINITY), u64::MAX);
    }

    #[test]
    fn many_clusters_get_less_each() {
        let constant = |clusters| Effort::full(clusters).constant;
        assert_eq!([0, 1, 200].map(constant), [CLUSTER[1]; 3]);
        assert!(constant(400) < CLUSTER[1] && constant(1_000_000) == CLUSTER[0]);
    }
}
