//! Grown networks: an organ filled with terminals, and a tree of vessels that reaches them all.
//!
//! Terminals fill the organ evenly (`organ`). The tree is grown from the inlet by splitting the set of terminals again and
//! again (`grow`); how many go to either side is such that each Strahler order has as many vessels as in a rat's kidney
//! (`split`). Radii follow from those of the terminals by Murray's law. Then every fork is moved to where its three vessels
//! have the least volume, as far as they stay long enough to be cut, and nodes move out of thick vessels (`relax`). That
//! takes about n log n steps and memory proportional to n.
//!
//! The published morphometry, and what a network has of it, is in `morphometry`.

mod grow;
mod morphometry;
mod organ;
mod random;
mod relax;
mod split;
#[cfg(test)]
mod tests;

pub use morphometry::{Morphometry, OrderFigures, Published, RAT_KIDNEY};

use super::{Edge, Node, NodeId, Skeleton};
use organ::Shape;
use random::{Random, Stream};

/// Terminals of a rat's kidney (afferent arterioles; Nordsletten et al. 2006).
const TERMINALS: f64 = 29_566.0;

/// Their radius, µm, and its standard deviation as a share of it.
const TERMINAL_RADIUS: f64 = 10.08;
const TERMINAL_SPREAD: f64 = 0.014;

/// Terminals closer than this, in their radii, leave no room for vessels between them.
const CLOSEST: f64 = 6.0;

/// Radii of terminals, µm.
const LEAST_RADIUS: f64 = 1e-6;
const LARGEST_RADIUS: f64 = 1e6;

/// Radius of the root, in longest extents of the organ, above which it would be most of it.
const THICKEST: f64 = 0.15;

/// More terminals have more nodes than ids.
const MOST_TERMINALS: u32 = 1_000_000_000;

/// Longest organ, µm: beyond, lengths and radii are nothing that can be meshed.
const LARGEST_SIZE: f64 = 1e9;

/// What is filled with vessels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Organ {
    /// An ellipsoid whose cortex is dense with terminals and whose medulla holds few; the vessel enters at a hilum that
    /// holds none.
    #[default]
    Kidney,
    /// An ellipsoid filled evenly.
    Ellipsoid,
}

impl Organ {
    /// Exponent of Murray's law unless another is asked for: 3 is Murray's own; with 3.2 all orders of a kidney of
    /// 29,566 terminals come closest to the published radii (from the thinnest to the thickest it is 3.36 there).
    pub fn usual_exponent(self) -> f64 {
        match self {
            Self::Kidney => 3.2,
            Self::Ellipsoid => 3.0,
        }
    }
}

/// What to grow. Lengths are in µm.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct GenerateParams {
    /// What is filled.
    pub organ: Organ,
    /// Number of terminals: outlets of the tree, which has one inlet besides.
    pub terminals: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Mean radius of the terminals.
    pub terminal_radius: f64,
    /// Exponent p of Murray's law r₀ᵖ = r₁ᵖ + r₂ᵖ.
    pub exponent: f64,
    /// Longest extent of the organ; by default that at which terminals are as dense as in a rat's kidney.
    pub size: Option<f64>,
}

impl GenerateParams {
    /// So many terminals in an organ, all else as usual.
    pub fn new(organ: Organ, terminals: u32) -> Self {
        Self {
            organ,
            terminals,
            seed: 0,
            terminal_radius: TERMINAL_RADIUS,
            exponent: organ.usual_exponent(),
            size: None,
        }
    }

    /// Longest extent of the organ.
    pub fn resolved_size(&self) -> f64 {
        self.size.unwrap_or_else(|| self.organ.usual_size(self.terminals, self.terminal_radius))
    }

    /// Whether such a network can be grown.
    ///
    /// # Errors
    /// Says what cannot be.
    pub fn check(&self) -> Result<(), GenerateError> {
        if !(2..=MOST_TERMINALS).contains(&self.terminals) {
            return Err(GenerateError::BadCount { terminals: self.terminals });
        }
        if !(LEAST_RADIUS..=LARGEST_RADIUS).contains(&self.terminal_radius) {
            return Err(GenerateError::BadRadius { radius: self.terminal_radius });
        }
        if !(1.5..=10.0).contains(&self.exponent) {
            return Err(GenerateError::BadExponent { exponent: self.exponent });
        }
        let size = self.resolved_size();
        if !(size > 0.0 && size <= LARGEST_SIZE) {
            return Err(GenerateError::BadSize { size });
        }
        let spacing = Shape::new(self.organ, size, Random::new(self.seed)).spacing(self.terminals);
        let closest = CLOSEST * self.terminal_radius;
        if spacing < closest {
            return Err(GenerateError::TooDense { size, least: size * closest / spacing, terminals: self.terminals });
        }
        let root = self.terminal_radius * f64::from(self.terminals).powf(1.0 / self.exponent);
        if root > THICKEST * size {
            return Err(GenerateError::TooThick { root, size });
        }
        Ok(())
    }
}

/// Why no network can be grown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// Too few terminals for a tree, or more than there are ids.
    #[error("{terminals} terminals: a tree has 2 to {MOST_TERMINALS}")]
    BadCount {
        /// Number asked for.
        terminals: u32,
    },
    /// The radius of the terminals is not one.
    #[error("terminal radius {radius}: from {LEAST_RADIUS:e} to {LARGEST_RADIUS:e} µm is possible")]
    BadRadius {
        /// What was asked for, µm.
        radius: f64,
    },
    /// The exponent leads to vessels that are no tree of vessels.
    #[error("exponent {exponent}: Murray's law takes 3; from 1.5 to 10 is possible")]
    BadExponent {
        /// What was asked for.
        exponent: f64,
    },
    /// The size is not one.
    #[error("size {size} µm: it must be above 0 and at most {LARGEST_SIZE:e} µm")]
    BadSize {
        /// Longest extent, µm.
        size: f64,
    },
    /// The root would fill the organ.
    #[error(
        "a root of radius {root:.0} µm does not fit into {size:.0} µm: take a larger exponent or size, or thinner terminals"
    )]
    TooThick {
        /// Radius that Murray's law gives it, µm.
        root: f64,
        /// Longest extent, µm.
        size: f64,
    },
    /// Terminals would be closer than vessels between them allow.
    #[error(
        "{terminals} terminals do not fit into {size:.0} µm: they would be closer to each other than {CLOSEST} radii; a \
         size of {least:.0} µm holds them"
    )]
    TooDense {
        /// Longest extent, µm.
        size: f64,
        /// Least size that holds them, µm.
        least: f64,
        /// Number of terminals.
        terminals: u32,
    },
    /// The organ could not be filled.
    #[error("only {placed} of {terminals} terminals found a place")]
    NoRoom {
        /// Terminals placed.
        placed: u32,
        /// Number asked for.
        terminals: u32,
    },
}

/// Grows a network: a tree of `2n` nodes and `2n − 1` straight vessels, the inlet being node 0. Lengths in µm; each edge
/// has one radius, a node that of the vessel that leads to it. The same for a seed, whatever the number of threads.
///
/// # Errors
/// When the parameters make no sense.
pub fn generate(params: &GenerateParams) -> Result<Skeleton, GenerateError> {
    params.check()?;
    let random = Random::new(params.seed);
    let shape = Shape::new(params.organ, params.resolved_size(), random);
    let mut points = shape.terminals(params.terminals)?;
    let mut tree = grow::grow(shape.inlet(), &mut points, params.exponent, random);
    drop(points);
    let radii = murray(&tree, params, random);
    relax::relax(&mut tree, &radii);
    Ok(skeleton(&tree, &radii))
}

/// Radius of the vessel to each node, from the terminals up; the inlet's is that of its vessel.
fn murray(tree: &grow::Tree, params: &GenerateParams, random: Random) -> Vec<f64> {
    let p = params.exponent;
    let mut powers = vec![0.0; tree.sizes.len()];
    for i in (1..powers.len()).rev() {
        if tree.sizes[i] == 1 {
            let off = TERMINAL_SPREAD * random.bell(Stream::Radius, i as u64);
            powers[i] = (params.terminal_radius * (1.0 + off)).powf(p);
        }
        let power = powers[i];
        powers[tree.parents[i] as usize] += power;
    }
    powers.iter().map(|power| power.powf(1.0 / p)).collect()
}

fn skeleton(tree: &grow::Tree, radii: &[f64]) -> Skeleton {
    let node = |(i, (position, radius)): (usize, (&crate::geometry::Point3, &f64))| Node {
        position: *position,
        radius: *radius,
        original: i as u32,
    };
    let edge =
        |(i, (&parent, &r)): (usize, (&u32, &f64))| Edge { nodes: [NodeId(parent), NodeId(i as u32)], radii: [r, r] };
    Skeleton {
        nodes: tree.positions.iter().zip(radii).enumerate().map(node).collect(),
        edges: tree.parents.iter().zip(radii).enumerate().skip(1).map(edge).collect(),
    }
}
