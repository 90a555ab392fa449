//! Places with shorter edges than those of the resolution.

use super::separation;
use anastomesh_mesh::geometry::{Point3, Vec3};
use serde::{Deserialize, Serialize};

/// Minimum edge length at such places, relative to the resolution's.
pub const LEAST_SIZE: f64 = 0.25;

/// A ball in which edges are shorter, at a fork or on a vessel's axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FinePlace {
    /// Centre.
    pub at: Point3,
    /// Radius. Within that of a fork, its vessels are one lumen.
    pub within: f64,
    /// Edge length relative to that elsewhere, [`LEAST_SIZE`] to 1.
    pub factor: f64,
}

/// A vessel that leaves a fork.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Unit vector out of the fork.
    pub direction: Vec3,
    /// Radius at the fork.
    pub radius: f64,
}

impl FinePlace {
    /// Creates that of a fork from its node and vessels; `None` if edges are not to be shorter. Equation 12 gives the distance
    /// from which two vessels are separate.
    pub fn of_fork(at: Point3, legs: &[Leg], factor: f64) -> Option<Self> {
        if legs.len() < 3 || factor >= 1.0 {
            return None;
        }
        let widest = legs.iter().map(|leg| leg.radius).fold(0.0, f64::max);
        let longest = LONGEST_CROTCH * widest;
        let apart = |a: &Leg, b: &Leg| separation(&a.direction, &b.direction, [a.radius, b.radius]);
        let pairs = (0..legs.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let within = pairs.map(|(i, j)| apart(&legs[i], &legs[j]).min(longest)).fold(widest, f64::max);
        Some(Self { at, within, factor: factor.max(LEAST_SIZE) })
    }
}

/// Maximum distance of a crotch from its node, in radii of the widest vessel. Vessels side by side have no crotch.
const LONGEST_CROTCH: f64 = 4.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn leg(x: f64, y: f64) -> Leg {
        Leg { direction: Vec3::new(x, y, 0.0).normalize(), radius: 1.0 }
    }

    #[test]
    fn forks_reach_as_far_as_their_crotch() {
        let fork = |y| FinePlace::of_fork(Point3::origin(), &[leg(-1.0, 0.0), leg(1.0, y), leg(1.0, -y)], 0.5);
        let within = |y| fork(y).expect("a fork").within;
        // At right angles walls meet at 1 radius, at 60° at 1.73 radii.
        assert!((within(1.0) - 1.0).abs() < 1e-12);
        assert!((within((1.0_f64 / 3.0).sqrt()) - 3.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(within(1e-9), LONGEST_CROTCH);
        assert_eq!(FinePlace::of_fork(Point3::origin(), &[leg(-1.0, 0.0), leg(1.0, 0.0)], 0.5), None);
    }
}
