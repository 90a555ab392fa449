//! Edge lengths requested at the nodes of a network, relative to those of the resolution.

use crate::{NodeId, SizeField};
use serde::Serialize;
use std::fmt;
use std::sync::Arc;
use xxhash_rust::xxh3::Xxh3;

/// Edge lengths that differ from the resolution's.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SizeAt {
    /// Factor at every fork, 0.25 to 1.
    Forks(f64),
    /// Factor per node: below 1 edges at a fork are shorter, above 1 template tubes are stretched.
    Nodes(NodeSizes),
    /// Edge lengths at points. Edges are shorter where the field asks for it, and never longer.
    Field(SizeField),
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
    /// Factor requested at a fork; 1 if it is not given by node.
    pub fn at_fork(&self, original: u32) -> f64 {
        match self {
            Self::Forks(factor) => *factor,
            Self::Nodes(sizes) => sizes.of(original),
            Self::Field(_) => 1.0,
        }
    }

    /// The lengths at points.
    pub fn field(&self) -> Option<&SizeField> {
        if let Self::Field(field) = self { Some(field) } else { None }
    }

    /// Factor at a fraction of the way between two nodes of a vessel; `None` if nodes have none.
    pub fn between(&self, originals: [u32; 2], share: f64) -> Option<f64> {
        let Self::Nodes(sizes) = self else { return None };
        let [a, b] = originals.map(|original| sizes.of(original));
        Some(a + share * (b - a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
