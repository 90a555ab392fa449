//! What to improve, how hard, and what was done.

/// How hard an improvement tries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// As `Fast`, with one round of smoothing: for Delaunay meshes of points that lie well.
    Quick,
    /// Smoothing and flips; insertion and contraction where a tetrahedron is very bad.
    #[default]
    Fast,
    /// Then everything there is, small-polyhedron reconnection included, on each tetrahedron that is still bad.
    Full,
}

/// What to improve and how much work to spend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimizeOptions {
    /// The first so many points stay where they are, with index and bits. Points on the boundary or on a frozen face
    /// stay too.
    pub fixed_points: usize,
    /// Rounds of smoothing followed by flips.
    pub rounds: usize,
    /// Inner vertices are smoothed when a tetrahedron around them has a radius ratio below this.
    pub smooth_below: f64,
    /// Flips are tried on tetrahedra whose radius ratio is below this.
    pub flip_below: f64,
    /// Vertices are inserted and contracted where tetrahedra stay below this radius ratio.
    pub stubborn_below: f64,
    /// Every point keeps its index: none is removed, new ones come after all others.
    pub keep_points: bool,
    /// Upper limit of attempted changes, per tetrahedron of the mesh that comes in.
    pub attempts_per_tet: usize,
    /// How hard to try below `stubborn_below`.
    pub effort: Effort,
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
        }
    }
}

impl OptimizeOptions {
    /// What an effort comes to.
    pub fn of(effort: Effort) -> Self {
        match effort {
            // A second round adds 0.002 to the mean radius ratio for a third of the time.
            Effort::Quick => Self { rounds: 1, flip_below: 0.53, effort, ..Self::default() },
            Effort::Fast => Self { rounds: 1, ..Self::default() },
            Effort::Full => Self::full(),
        }
    }

    /// For a mesh that is to be as good as its surface allows.
    pub fn full() -> Self {
        Self { smooth_below: 0.9, stubborn_below: 0.35, effort: Effort::Full, ..Self::default() }
    }
}

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct OptimizeReport {
    /// Steps of vertices.
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
    /// Tetrahedra of a radius ratio below 1e-9 that are left and have a face that is not the surface's; looked for where
    /// the effort is full.
    pub flat_left: usize,
    /// The limit of attempts was reached: more could have been improved.
    pub budget_spent: bool,
}
