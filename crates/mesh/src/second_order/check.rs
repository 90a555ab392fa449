//! Check of the Jacobian determinants of a second-order mesh.

use super::jacobian::{Sign, jacobian_above};
use super::midpoints::SecondOrder;
use crate::TetMesh;
use crate::geometry::predicates::orient3d;
use rayon::prelude::*;

/// Result of [`check_jacobians`].
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobians {
    /// Elements whose Jacobian determinant is not proved to be positive everywhere, ascending.
    pub invalid: Vec<u32>,
    /// Lower bound of the determinants of the other elements, each relative to that of the straight element with the same corners.
    pub least_scaled: f64,
}

impl Jacobians {
    /// True if all elements have a positive Jacobian determinant.
    pub fn is_valid(&self) -> bool {
        self.invalid.is_empty()
    }
}

/// Proves that the Jacobian determinant of each element is positive everywhere. Elements with straight edges are decided by the exact
/// orientation of their corners.
///
/// # Panics
/// If the midpoints are those of another mesh.
pub fn check_jacobians(mesh: &TetMesh, second: &SecondOrder) -> Jacobians {
    let least = |&tet: &[u32; 4]| {
        let nodes = second.nodes(&mesh.points, tet);
        let [a, b, c, d] = [nodes[0], nodes[1], nodes[2], nodes[3]];
        if SecondOrder::is_straight(&mesh.points, tet, &nodes) {
            return (orient3d(&a, &b, &c, &d) > 0.0).then_some(1.0);
        }
        let straight = (b - a).cross(&(c - a)).dot(&(d - a));
        match jacobian_above(&nodes, 0.0) {
            Sign::Above { least } => Some(least / straight.max(f64::MIN_POSITIVE)),
            Sign::Below | Sign::Undecided => None,
        }
    };
    let all: Vec<Option<f64>> = mesh.tets.par_iter().map(least).collect();
    Jacobians {
        invalid: (0..).zip(&all).filter(|(_, least)| least.is_none()).map(|(tet, _)| tet).collect(),
        least_scaled: all.iter().flatten().copied().fold(f64::INFINITY, f64::min),
    }
}
