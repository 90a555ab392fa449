//! Edge lengths requested at the nodes of a network, relative to those of the resolution.

use crate::NodeId;
use anastomesh_mesh::geometry::{Point3, Vec3};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;
use xxhash_rust::xxh3::Xxh3;

/// Minimum edge length at forks, relative to the resolution's.
pub const LEAST_SIZE: f64 = 0.25;

/// Edge lengths that differ from the resolution's.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SizeAt {
    /// Factor at every fork, 0.25 to 1.
    Forks(f64),
    /// Factor per node: below 1 edges at a fork are shorter, above 1 template tubes are stretched.
    Nodes(NodeSizes),
}

/// A factor for each node of a network, by [`super::Node::original`].
#[derive(Clone, PartialEq, Serialize)]
pub struct NodeSizes {
    /// Name of the array.
    array: String,
    #[serde(skip)]
    values: Arc<[f64]>,
    /// Hash of the values.
    digest: String,
}

/// A value that is not usable as a factor.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("node {} has the value {value}: give a finite number above zero", node.0)]
pub struct BadSize {
    /// The node, in the order of the file.
    pub node: NodeId,
    /// Its value.
    pub value: f64,
}

impl NodeSizes {
    /// Creates factors from an array, one per node in the order of the file; further nodes have 1.
    ///
    /// # Errors
    /// A value that is not a finite number above zero.
    pub fn new(array: &str, values: &[f64]) -> Result<Self, BadSize> {
        if let Some(at) = values.iter().position(|&value| !(value > 0.0 && value.is_finite())) {
            return Err(BadSize { node: NodeId(at as u32), value: values[at] });
        }
        let mut hash = Xxh3::new();
        for value in values {
            hash.update(&value.to_bits().to_le_bytes());
        }
        Ok(Self { array: array.to_owned(), values: values.into(), digest: format!("{:032x}", hash.digest128()) })
    }

    /// Name of the array.
    pub fn array(&self) -> &str {
        &self.array
    }

    fn of(&self, original: u32) -> f64 {
        self.values.get(original as usize).copied().unwrap_or(1.0)
    }
}

impl fmt::Debug for NodeSizes {
    // Cache keys contain plans in this form, so the hash stands for the values.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "NodeSizes({}, {})", self.array, self.digest)
    }
}

impl SizeAt {
    /// Factor requested at a fork.
    pub fn at_fork(&self, original: u32) -> f64 {
        match self {
            Self::Forks(factor) => *factor,
            Self::Nodes(sizes) => sizes.of(original),
        }
    }

    /// Factor at a fraction of the way between two nodes of a vessel; `None` if only forks have one.
    pub fn between(&self, originals: [u32; 2], share: f64) -> Option<f64> {
        let Self::Nodes(sizes) = self else { return None };
        let [a, b] = originals.map(|original| sizes.of(original));
        Some(a + share * (b - a))
    }
}

/// A fork with shorter edges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FineFork {
    /// Position of its node.
    pub at: Point3,
    /// Distance from the node within which its vessels are one lumen.
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

impl FineFork {
    /// Creates it from a node and its vessels; `None` if edges are not to be shorter. Equation 12 gives the distance
    /// from which two vessels are separate.
    pub fn new(at: Point3, legs: &[Leg], factor: f64) -> Option<Self> {
        if legs.len() < 3 || factor >= 1.0 {
            return None;
        }
        let widest = legs.iter().map(|leg| leg.radius).fold(0.0, f64::max);
        let longest = LONGEST_CROTCH * widest;
        let apart = |a: &Leg, b: &Leg| super::separation(&a.direction, &b.direction, [a.radius, b.radius]);
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
        let fork = |y| FineFork::new(Point3::origin(), &[leg(-1.0, 0.0), leg(1.0, y), leg(1.0, -y)], 0.5);
        let within = |y| fork(y).expect("a fork").within;
        // At right angles walls meet at 1 radius, at 60° at 1.73 radii.
        assert!((within(1.0) - 1.0).abs() < 1e-12);
        assert!((within((1.0_f64 / 3.0).sqrt()) - 3.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(within(1e-9), LONGEST_CROTCH);
        assert_eq!(FineFork::new(Point3::origin(), &[leg(-1.0, 0.0), leg(1.0, 0.0)], 0.5), None);
    }

    #[test]
    fn values_are_looked_up_by_node_and_checked() {
        let sizes = SizeAt::Nodes(NodeSizes::new("Size", &[0.5, 3.0]).expect("numbers"));
        assert_eq!([0, 1, 2].map(|node| sizes.at_fork(node)), [0.5, 3.0, 1.0]);
        assert_eq!(sizes.between([0, 1], 0.25), Some(1.125));
        assert_eq!(SizeAt::Forks(0.5).between([0, 1], 0.25), None);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = NodeSizes::new("Size", &[1.0, bad]).expect_err("no factor");
            assert_eq!(error.node, NodeId(1));
        }
    }
}
