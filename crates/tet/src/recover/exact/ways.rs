//! Recovery strategies. Parts that fail with one often succeed with another.

/// Operations per edge, triangle and vertex, as counted by budgets, beside the work counted by [`Space`].
const OPERATIONS: usize = 50;

/// Returns the operations since the last call, as counted by budgets. An operation takes about 0.1 µs.
pub(super) fn operations(s: &Space) -> usize {
    OPERATIONS + s.take_work()
}

use super::space::Space;

/// Maximum implicit vertices: per missing edge, plus a constant.
const VERTICES: (usize, usize) = (256, 1_000_000);

/// Maximum implicit vertices with deep cavities, where each vertex takes longer.
const VERTICES_DEEP: (usize, usize) = (64, 100_000);

/// Maximum fraction of missing edges left after recovery in planes. Beyond it, new vertices are mere obstacles.
const WORTHWHILE: f64 = 0.2;

/// A recovery strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RecoveryStrategy {
    /// If set, edges in facet planes are recovered first; the strategy stops if more than this fraction remains.
    pub level: Option<f64>,
    /// True if new vertices must lie well off the faces of their cavity, rather than merely see them.
    pub deep: bool,
    /// Seed of the order in which edges are cut.
    pub salt: u64,
    /// Maximum implicit vertices: per missing edge, plus a constant.
    vertices: (usize, usize),
}

impl RecoveryStrategy {
    /// Strategies for the complex left by flips, the fastest first.
    pub(crate) const GIVEN: [Self; 4] = [Self::seen(0), Self::deep(false, 0), Self::seen(1), Self::deep(true, 2)];

    /// Strategies for a surface in planes, after few flips.
    pub(crate) const PLANES: [Self; 2] = [Self::deep(true, 0), Self::deep(true, 0).unconditional()];

    /// Strategies for a complex without flat tetrahedra.
    pub(crate) const TURNED: [Self; 5] =
        [Self::deep(true, 0), Self::level(1), Self::deep(true, 2), Self::deep(false, 0), Self::deep(false, 1)];

    /// Last strategies, for parts that may be flat. They exchange edges in planes whatever the gain.
    pub(crate) const LAST: [Self; 7] = [
        Self::deep(true, 0).unconditional(),
        Self::level(1).unconditional(),
        Self::deep(true, 2).unconditional(),
        Self::level(3).unconditional(),
        Self::deep(false, 4),
        Self::deep(false, 5),
        Self::deep(false, 6),
    ];

    const fn seen(salt: u64) -> Self {
        Self { level: None, deep: false, salt, vertices: VERTICES }
    }

    const fn level(salt: u64) -> Self {
        Self { level: Some(WORTHWHILE), ..Self::seen(salt) }
    }

    const fn deep(level: bool, salt: u64) -> Self {
        let way = if level { Self::level(salt) } else { Self::seen(salt) };
        Self { deep: true, vertices: VERTICES_DEEP, ..way }
    }

    const fn unconditional(self) -> Self {
        Self { level: Some(f64::INFINITY), ..self }
    }

    /// Implicit vertices allowed for a number of missing edges.
    pub(super) const fn budget(self, edges: usize) -> usize {
        self.vertices.0 * edges + self.vertices.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_of_vertices_grow_with_the_missing_edges() {
        assert_eq!(RecoveryStrategy::seen(0).budget(3), 1_000_768);
        assert_eq!(RecoveryStrategy::deep(true, 0).budget(3), 100_192);
    }

    #[test]
    fn operations_are_counted_once() {
        let s = Space::of_points([]);
        s.count(7);
        assert_eq!([operations(&s), operations(&s)], [57, 50]);
    }
}
