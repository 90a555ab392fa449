//! Improvement of a tetrahedral mesh with a fixed surface: smoothing of inner vertices, edge and face removal, and
//! insertion and contraction of vertices. (Freitag, Ollivier-Gooch 1997; Klingner, Shewchuk, 'Aggressive tetrahedral
//! mesh improvement', 2007.)
//!
//! Every change keeps all tetrahedra positive by the exact predicate. Every topological change raises the worst radius
//! ratio of the tetrahedra that it touches.

mod allowance;
mod cavity;
mod flat;
mod flipping;
mod improver;
mod options;
mod reconnect;
mod reconnecting;
mod smoothing;
mod star_energy;
mod strain;
mod thorough;

pub use improver::Improver;
pub use options::{Effort, OptimizeOptions, OptimizeReport};
pub(super) use strain::score;

use super::complex::{Complex, ComplexError};
use super::progress::Watch;
use anastomesh_mesh::TetMesh;

/// Improves a mesh; its boundary faces and fixed points stay. Other points may be moved, added, removed and renumbered,
/// unless `keep_points` is set. Points without a tetrahedron are dropped.
///
/// # Errors
/// If the arrays are not a mesh of positive, conforming tetrahedra; the mesh is then unchanged.
pub fn optimize(mesh: &mut TetMesh, options: &OptimizeOptions) -> Result<OptimizeReport, ComplexError> {
    let count = mesh.points.len();
    let mut complex = Complex::from_mesh(mesh.points.clone(), &mesh.tets)?;
    let report = optimize_complex(&mut complex, options, &Watch::NOBODY);
    *mesh = complex.into_mesh();
    let kept = if options.keep_points { count } else { options.fixed_points };
    mesh.drop_unused_points(kept);
    Ok(report)
}

/// Improves a complex in place, including ghosts and frozen faces. Unused points stay in the list. Stops early, with a
/// valid result, if the watch asks to stop.
pub fn optimize_complex(complex: &mut Complex, options: &OptimizeOptions, watch: &Watch) -> OptimizeReport {
    let mut improver = Improver::new(std::mem::take(complex), options).watched(*watch);
    improver.run();
    let (improved, report) = improver.finish();
    *complex = improved;
    report
}

#[cfg(test)]
mod tests;
