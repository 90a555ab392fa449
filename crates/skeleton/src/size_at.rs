//! How long the edges of a mesh are asked to be at the nodes of a network, in those that the resolution gives.

use crate::NodeId;
use anastomesh_mesh::geometry::{Point3, Vec3};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;
use xxhash_rust::xxh3::Xxh3;

/// Edges at forks are at least so many times as long as the resolution says.
pub const LEAST_SIZE: f64 = 0.25;

/// How long edges are, where they are not as the resolution says.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SizeAt {
    /// At every fork so many times as long, 0.25 to 1.
    Forks(f64),
    /// As each node says: below 1 edges at a fork are shorter, above 1 tubes by template are stretched.
    Nodes(NodeSizes),
}

/// A number for each node of a network, by [`super::Node::original`].
#[derive(Clone, PartialEq, Serialize)]
pub struct NodeSizes {
    /// What the array is called.
    array: String,
    #[serde(skip)]
    values: Arc<[f64]>,
    /// Of the values: what says which they are, in little room.
    digest: String,
}

/// A number that no length can be multiplied by.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("node {} has the value {value}: a finite number above zero is needed", node.0)]
pub struct BadSize {
    /// The node, in the order of the file.
    pub node: NodeId,
    /// What it has.
    pub value: f64,
}

impl NodeSizes {
    /// The values of an array, one for each node in the order of the file; nodes beyond them have 1.
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

    /// What the array is called.
    pub fn array(&self) -> &str {
        &self.array
    }

    fn of(&self, original: u32) -> f64 {
        self.values.get(original as usize).copied().unwrap_or(1.0)
    }
}

impl fmt::Debug for NodeSizes {
    // Plans are written into keys: the digest stands for the values.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "NodeSizes({}, {})", self.array, self.digest)
    }
}

impl SizeAt {
    /// What is asked for at a fork.
    pub fn at_fork(&self, original: u32) -> f64 {
        match self {
            Self::Forks(factor) => *factor,
            Self::Nodes(sizes) => sizes.of(original),
        }
    }

    /// What is asked for between two nodes of a vessel, at a share of the way; none where forks alone are spoken of.
    pub fn between(&self, originals: [u32; 2], share: f64) -> Option<f64> {
        let Self::Nodes(sizes) = self else { return None };
        let [a, b] = originals.map(|original| sizes.of(original));
        Some(a + share * (b - a))
    }
}

/// A fork with shorter edges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FineFork {
    /// Its node.
    pub at: Point3,
    /// How far from the node its vessels are one lumen.
    pub within: f64,
    /// How many times as long as elsewhere edges are there, [`LEAST_SIZE`] to 1.
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
    /// Of a node and the vessels that leave it; none where edges are not to be shorter. Two vessels are apart from where
    /// equation 12 has them apart.
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

/// Crotches are looked for so far from their node, in radii of the widest vessel: vessels that leave side by side have none.
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
        // At right angles walls meet at the radius, at 60° at 1.73 of them.
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
