//! Budgets in counted operations. A budget in seconds would make results depend on the machine and its load.

use std::sync::atomic::{AtomicU64, Ordering};

/// Maximum number of operations of a piece of work, and the number so far. May be shared by several threads. The total
/// does not depend on their order, and neither does the decision whether it exceeds the limit.
///
/// ```
/// use anastomesh_mesh::budget::{Budget, OverBudget};
///
/// let budget = Budget::new(100);
/// assert_eq!(budget.spend(70), Ok(()));
/// assert_eq!(budget.spend(31), Err(OverBudget { limit: 100 }));
/// assert_eq!(budget.spent(), 101);
/// ```
#[derive(Debug)]
pub struct Budget {
    limit: u64,
    spent: AtomicU64,
}

impl Budget {
    /// Budget of `limit` operations.
    pub const fn new(limit: u64) -> Self {
        Self { limit, spent: AtomicU64::new(0) }
    }

    /// Counts operations.
    ///
    /// # Errors
    /// [`OverBudget`] if the total exceeds the limit.
    #[inline]
    pub fn spend(&self, operations: u64) -> Result<(), OverBudget> {
        let before = self.spent.fetch_add(operations, Ordering::Relaxed);
        if before.saturating_add(operations) > self.limit { Err(OverBudget { limit: self.limit }) } else { Ok(()) }
    }

    /// Operations so far, including those that exceeded the limit.
    pub fn spent(&self) -> u64 {
        self.spent.load(Ordering::Relaxed)
    }

    /// Maximum number of operations.
    pub const fn limit(&self) -> u64 {
        self.limit
    }

    /// Operations that are left.
    pub fn left(&self) -> u64 {
        self.limit.saturating_sub(self.spent())
    }
}

/// Excess over a [`Budget`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it exceeds its budget of {:.3} million operations", *limit as f64 / 1e6)]
pub struct OverBudget {
    /// Maximum number of operations.
    pub limit: u64,
}

/// Reason to end work early.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Stop {
    /// The caller asked for a stop.
    #[error("cancelled")]
    Cancelled,
    /// The budget is exceeded.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_itself_may_be_spent_and_no_more() {
        let budget = Budget::new(10);
        assert_eq!(budget.spend(10), Ok(()));
        assert_eq!(budget.left(), 0);
        assert_eq!(budget.spend(0), Ok(()));
        assert_eq!(budget.spend(1), Err(OverBudget { limit: 10 }));
        assert_eq!(budget.spend(0), Err(OverBudget { limit: 10 }));
    }
}
