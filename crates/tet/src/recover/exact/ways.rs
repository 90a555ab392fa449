//! Ways to recover: what fails in one comes loose in another.

/// Implicit vertices allowed: for each missing edge, and in any case.
const VERTICES: (usize, usize) = (256, 1_000_000);

/// The same where cavities are deep, which takes longer for each.
const VERTICES_DEEP: (usize, usize) = (64, 100_000);

/// The same where other ways are left that may need fewer.
const VERTICES_FIRST: (usize, usize) = (4, 25_000);

/// Share of the missing edges that may be left when what lies in planes is recovered; beyond that it gains little, and new
/// vertices are in the way.
const WORTHWHILE: f64 = 0.2;

/// A way to recover what is missing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RecoveryStrategy {
    /// Whether edges in planes of faces are turned first; then the share of those missing that may be left for the others
    /// to be gone on with.
    pub level: Option<f64>,
    /// Whether cavities are to be deep, not only seen.
    pub deep: bool,
    /// Chooses the order in which edges are cut.
    pub salt: u64,
    /// Implicit vertices allowed: for each missing edge, and in any case.
    vertices: (usize, usize),
}

impl RecoveryStrategy {
    /// What is quickest where it succeeds, given up early.
    pub(crate) const FIRST: [Self; 1] = [Self { vertices: VERTICES_FIRST, ..Self::seen(0) }];

    /// For parts that are flat but for rounding.
    pub(crate) const TURNED: [Self; 5] =
        [Self::deep(true, 0), Self::level(1), Self::deep(true, 2), Self::deep(false, 0), Self::deep(false, 1)];

    /// What is left to try.
    pub(crate) const OTHERS: [Self; 4] = [Self::seen(0), Self::seen(1), Self::deep(true, 2), Self::deep(false, 3)];

    /// What is tried at last, for parts that may be flat: edges in planes are turned, be it worthwhile or not, and then
    /// there are other orders.
    pub(crate) const LAST: [Self; 7] = [
        Self::deep(true, 0).in_any_case(),
        Self::level(1).in_any_case(),
        Self::deep(true, 2).in_any_case(),
        Self::level(3).in_any_case(),
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

    const fn in_any_case(self) -> Self {
        Self { level: Some(f64::INFINITY), ..self }
    }

    /// Implicit vertices allowed for so many missing edges.
    pub(super) const fn budget(self, edges: usize) -> usize {
        self.vertices.0 * edges + self.vertices.1
    }
}
