//! Options and report of mesh improvement.

/// Effort of an improvement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// `Fast` with one round of smoothing, for Delaunay meshes of well-placed points.
    Quick,
    /// Smoothing and flips; insertion and contraction at tetrahedra of the lowest quality.
    #[default]
    Fast,
    /// All methods, including small-polyhedron reconnection, on each tetrahedron that is still bad.
    Full,
}

/// Targets and work limits of an improvement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimizeOptions {
    /// Number of leading points that keep their index and exact coordinates. Points on boundary or frozen faces stay,
    /// too.
    pub fixed_points: usize,
    /// Rounds of smoothing followed by flips.
    pub rounds: usize,
    /// Inner vertices are smoothed if a tetrahedron around them has a radius ratio below this.
    pub smooth_below: f64,
    /// Flips are tried on tetrahedra with a radius ratio below this.
    pub flip_below: f64,
    /// Vertices are inserted and contracted at tetrahedra that stay below this radius ratio.
    pub stubborn_below: f64,
    /// True if every point keeps its index: none is removed, and new ones follow all others.
    pub keep_points: bool,
    /// Maximum attempted changes per tetrahedron of the input mesh.
    pub attempts_per_tet: usize,
    /// Effort below `stubborn_below`.
    pub effort: Effort,
    /// True if tetrahedra at needles of the surface are left once they are about as good as the needle allows.
    pub spare_needles: bool,
}

impl Default for OptimizeOptions {
    fn default() -> Self {
        Self {
            fixed_points: 0,
            rounds: 2,
            smooth_below: 0.7,
            flip_below: 0.5,
            stubborn_below: 0.3,
            keep_points: false,
            attempts_per_tet: 20,
            effort: Effort::Fast,
            spare_needles: false,
        }
    }
}

impl OptimizeOptions {
    /// Options for an effort.
    pub fn of(effort: Effort) -> Self {
        match effort {
            // A second round adds 0.002 to the mean radius ratio for a third of the time.
            Effort::Quick => Self { rounds: 1, flip_below: 0.53, effort, ..Self::default() },
            Effort::Fast => Self { rounds: 1, ..Self::default() },
            Effort::Full => Self::full(),
        }
    }

    /// Options for the best mesh that the surface allows.
    pub fn full() -> Self {
        Self { smooth_below: 0.9, stubborn_below: 0.35, effort: Effort::Full, ..Self::default() }
    }
}

/// Report of an improvement.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct OptimizeReport {
    /// Vertex moves.
    pub moved: usize,
    /// Faces and edges removed.
    pub flips: usize,
    /// Vertices inserted.
    pub inserted: usize,
    /// Vertices contracted away.
    pub contracted: usize,
    /// Smallest radius ratio before.
    pub worst_before: f64,
    /// Smallest radius ratio after.
    pub worst_after: f64,
    /// Remaining tetrahedra with a radius ratio below 1e-9 and a face off the surface; counted only with full effort.
    pub flat_left: usize,
    /// True if the attempt limit was reached, so that more improvement may be possible.
    pub budget_spent: bool,
}

impl OptimizeReport {
    /// Adds the counts of another part.
    pub(crate) fn add(&mut self, other: &Self) {
        self.moved += other.moved;
        self.flips += other.flips;
        self.inserted += other.inserted;
        self.contracted += other.contracted;
        self.worst_before = self.worst_before.min(other.worst_before);
        self.worst_after = self.worst_after.min(other.worst_after);
        self.flat_left += other.flat_left;
        self.budget_spent |= other.budget_spent;
    }
}
