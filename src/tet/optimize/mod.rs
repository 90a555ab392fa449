//! Improvement of a tetrahedral mesh whose surface stays as it is: smoothing of the inner vertices, edge and face
//! removal, insertion and contraction of vertices where those do not suffice. (Freitag, Ollivier-Gooch 1997;
//! Klingner, Shewchuk, 'Aggressive tetrahedral mesh improvement', 2007.)
//!
//! Every change keeps all tetrahedra positive by the exact predicate, and every change of the connection raises the
//! worst radius ratio of the tetrahedra that it touches.

mod allowance;
mod cavity;
mod flat;
mod flipping;
mod improver;
mod reconnect;
mod smoothing;
mod thorough;

pub use improver::Improver;

use super::complex::{Complex, ComplexError};
use crate::mesh::TetMesh;
use crate::mesh::quality::radius_ratio;

/// Radius ratio below which a tetrahedron strains its surroundings.
const STRAINED: f64 = 0.5;
/// How much the worst weigh more than their number.
const STEEPER: f64 = 0.5;

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

/// Improves a mesh; its boundary faces and fixed points stay. Points that are not fixed may be moved, added, removed
/// and renumbered (unless `keep_points` says otherwise); those that no tetrahedron uses are dropped.
///
/// # Errors
/// When the arrays are not a mesh of positive, conforming tetrahedra; the mesh is then unchanged.
pub fn optimize(mesh: &mut TetMesh, options: &OptimizeOptions) -> Result<OptimizeReport, ComplexError> {
    let count = mesh.points.len();
    let mut complex = Complex::from_mesh(mesh.points.clone(), &mesh.tets)?;
    let report = optimize_complex(&mut complex, options);
    *mesh = complex.into_mesh();
    let kept = if options.keep_points { count } else { options.fixed_points };
    mesh.drop_unused_points(kept);
    Ok(report)
}

/// Improves a complex in place, ghosts, frozen faces and all. Points that are no longer used stay in the list.
pub fn optimize_complex(complex: &mut Complex, options: &OptimizeOptions) -> OptimizeReport {
    let mut improver = Improver::new(std::mem::take(complex), options);
    improver.run();
    let (improved, report) = improver.finish();
    *complex = improved;
    report
}

/// Radius ratio of a tetrahedron of real vertices, if it is positive by the exact predicate.
#[inline]
pub(super) fn score(c: &Complex, v: &[u32; 4]) -> Option<f64> {
    let [p, q, r, s] = v.map(|i| &c.points[i as usize]);
    (c.orient(v) > 0.0).then(|| radius_ratio(p, q, r, s))
}

/// How much a tetrahedron of this radius ratio asks to be mended: its logarithm below one half, and very little above,
/// so that nothing is mended at the cost of more that is as bad.
#[inline]
pub(super) fn strain(q: f64) -> f64 {
    let bad = if q < STRAINED { (STRAINED / q.max(1e-12)).ln() } else { 0.0 };
    bad * (1.0 + STEEPER * bad) + 0.1 * (1.0 - q)
}

/// The radius ratio below which a tetrahedron has more strain than this, if that is below one half.
fn ratio_of_strain(strain: f64) -> f64 {
    let bad = ((1.0 + 4.0 * STEEPER * strain.max(0.0)).sqrt() - 1.0) / (2.0 * STEEPER);
    STRAINED * (-bad).exp()
}

#[cfg(test)]
mod tests;
