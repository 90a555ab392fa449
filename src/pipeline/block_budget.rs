//! Budget of a cluster: of each attempt, and of all together. It follows from the input of the cluster and the effort of the
//! run alone, so that equal inputs have equal results on any machine.
//!
//! Attempts that fuse overlapping vessels have a reserve. They come last, and are often the only ones that can succeed. In a
//! large cluster, the others would leave nothing for them.

use super::effort::{Effort, LARGE};
use super::estimate::attempt_cost;
use super::plan::MeshPlan;
use crate::block::{BlockError, BlockParams};
use crate::partition::{Cluster, ClusterId};
use anastomesh_mesh::budget::{Budget, OverBudget, Stop};
use anastomesh_tet::parts::Watch;

/// Maximum operations of an attempt: a constant, plus a number per expected operation. Attempts that succeed take at most
/// three times the expected operations on the shared networks.
const ATTEMPT: Effort = Effort::linear(3e7, 8.0);

/// Budget of a cluster.
pub(super) struct BlockBudget<'a> {
    id: ClusterId,
    plan: &'a MeshPlan,
    all: Budget,
    /// Operations that only attempts with [`BlockParams::allow_fused`] may take, when nothing is left of `all`.
    reserve: Budget,
    /// True if an attempt takes long.
    pub is_large: bool,
    watch: &'a Watch<'a>,
}

impl<'a> BlockBudget<'a> {
    /// Budget of a cluster's attempts.
    pub(super) fn of(id: ClusterId, cluster: &Cluster, plan: &'a MeshPlan, effort: Effort, watch: &'a Watch) -> Self {
        let usual = attempt_cost(cluster, plan, &plan.block_params());
        let is_large = usual.operations > LARGE;
        let all = Budget::new(effort.limit(usual.operations));
        Self { id, plan, all, reserve: Budget::new(0), is_large, watch }
    }

    /// Adds a reserve for attempts that fuse vessels: as much as one attempt may take.
    pub(super) fn with_reserve(self, cluster: &Cluster) -> Self {
        let usual = attempt_cost(cluster, self.plan, &self.plan.block_params());
        Self { reserve: Budget::new(ATTEMPT.limit(usual.operations)), ..self }
    }

    /// True if no further attempt may be made, except with fused vessels.
    pub(super) fn is_over(&self) -> bool {
        self.watch.is_cancelled() || self.all.left() == 0
    }

    /// True if no further attempt with these parameters may be made.
    pub(super) fn is_over_for(&self, params: &BlockParams) -> bool {
        self.watch.is_cancelled() || self.left(params) == 0
    }

    /// Operations left for an attempt.
    fn left(&self, params: &BlockParams) -> u64 {
        self.all.left().saturating_add(if params.allow_fused { self.reserve.left() } else { 0 })
    }

    /// Operations so far.
    pub(super) fn spent(&self) -> u64 {
        self.all.spent() + self.reserve.spent()
    }

    /// Makes an attempt within its own budget, and that of all attempts.
    ///
    /// # Errors
    /// Those of the attempt; [`BlockError::Memory`] if it is expected to take more memory than there is.
    pub(super) fn attempt<T>(
        &self,
        cluster: &Cluster,
        params: &BlockParams,
        make: impl FnOnce(&Watch) -> Result<T, BlockError>,
    ) -> Result<T, BlockError> {
        let cost = attempt_cost(cluster, self.plan, params);
        if cost.bytes > self.plan.memory {
            return Err(BlockError::Memory { cluster: self.id, bytes: cost.bytes, limit: self.plan.memory });
        }
        if self.is_over_for(params) {
            let over = OverBudget { limit: self.all.limit() };
            let source = if self.watch.is_cancelled() { Stop::Cancelled } else { over.into() };
            return Err(BlockError::Stopped { cluster: self.id, source });
        }
        let own = Budget::new(ATTEMPT.limit(cost.operations).min(self.left(params)));
        let made = make(&self.watch.within(&own));
        let reserved = if params.allow_fused { own.spent().saturating_sub(self.all.left()) } else { 0 };
        // The next attempt, if any, finds out.
        let _ = (self.all.spend(own.spent() - reserved), self.reserve.spend(reserved));
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::fixtures::bifurcation;
    use crate::pipeline::once;

    #[test]
    fn an_attempt_beyond_its_budget_ends_with_a_typed_fault() {
        let (cluster, plan, watch) = (bifurcation(3), MeshPlan::default(), Watch::NOBODY);
        let params = plan.block_params();
        let of = |constant: f64| {
            let effort = Effort::linear(constant, 0.0);
            let budget = BlockBudget::of(ClusterId(7), &cluster, &plan, effort, &watch);
            let make = |watch: &Watch| once::cluster(ClusterId(7), &cluster, &params, |node| node.0, watch);
            (budget.attempt(&cluster, &params, make), budget.spent(), budget.is_over())
        };
        let (made, spent, is_over) = of(1e8);
        let expected = attempt_cost(&cluster, &plan, &params).operations;
        assert!(made.is_ok() && !is_over);
        assert!(spent as f64 > 0.3 * expected && (spent as f64) < 4.0 * expected, "{spent} {expected}");
        for share in [0.0, 0.2, 0.5, 0.9] {
            let (made, spent_then, is_over) = of(share * spent as f64);
            assert!(is_over && spent_then <= spent);
            let error = made.expect_err("a budget that is too small");
            assert!(error.is_over_budget() && error.stage() == "budget", "{error}");
            assert!(error.to_string().starts_with("cluster 7: it exceeds its budget of "), "{error}");
            // The operations do not depend on anything but the input.
            assert_eq!(of(share * spent as f64).1, spent_then);
        }
    }

    #[test]
    fn attempts_that_fuse_vessels_have_a_reserve() {
        let (cluster, plan, watch) = (bifurcation(3), MeshPlan::default(), Watch::NOBODY);
        let apart = plan.block_params();
        let fused = BlockParams { allow_fused: true, ..apart };
        let of = |has_reserve: bool| {
            let budget = BlockBudget::of(ClusterId(7), &cluster, &plan, Effort::linear(100.0, 0.0), &watch);
            let budget = if has_reserve { budget.with_reserve(&cluster) } else { budget };
            let take = |params: &BlockParams, operations: usize| {
                let made = budget.attempt(&cluster, params, |watch| {
                    watch.spend(operations).map_err(|source| BlockError::Stopped { cluster: ClusterId(7), source })
                });
                (made.is_ok(), budget.spent(), budget.is_over_for(params))
            };
            // The attempt that exceeds the budget counts in full.
            assert_eq!(take(&apart, 200), (false, 200, true));
            assert!(budget.is_over() && budget.is_over_for(&fused) != has_reserve);
            assert_eq!(take(&apart, 1), (false, 200, true));
            [take(&fused, 1_000_000), take(&fused, 30_000_000), take(&fused, usize::MAX >> 1)]
        };
        let [first, second, third] = of(true);
        assert_eq!(first, (true, 1_000_200, false));
        assert_eq!(second, (true, 31_000_200, false));
        assert!(!third.0 && third.2);
        assert_eq!(of(false), [(false, 200, true); 3]);
    }

    #[test]
    fn an_attempt_that_needs_too_much_memory_is_not_made() {
        let plan = MeshPlan { memory: 1 << 20, ..MeshPlan::default() };
        let cluster = bifurcation(3);
        let budget = BlockBudget::of(ClusterId(0), &cluster, &plan, Effort::full(1), &Watch::NOBODY);
        let made: Result<(), _> = budget.attempt(&cluster, &plan.block_params(), |_| panic!("it is not made"));
        assert!(matches!(made, Err(BlockError::Memory { limit, .. }) if limit == 1 << 20));
    }
}
