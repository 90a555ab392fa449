//! Growth of a tree from its parameters.

use super::organ::Shape;
use super::params::{
    CLOSEST, GenerateError, GenerateParams, LARGEST_RADIUS, LARGEST_SIZE, LEAST_RADIUS, MOST_TERMINALS,
};
use super::random::{Random, Stream};
use super::{relax, tree};
use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};

const TERMINAL_SPREAD: f64 = 0.014;

/// Maximum root radius, in longest extents of the organ. A thicker root would fill most of it.
const THICKEST: f64 = 0.15;

impl GenerateParams {
    /// Longest extent of the organ.
    pub fn resolved_size(&self) -> f64 {
        self.size.unwrap_or_else(|| self.organ.usual_size(self.terminals, self.terminal_radius))
    }

    /// Checks that the network can be grown.
    ///
    /// # Errors
    /// The first invalid parameter.
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
        let root = self.terminal_radius * libm::pow(f64::from(self.terminals), 1.0 / self.exponent);
        if root > THICKEST * size {
            return Err(GenerateError::TooThick { root, size });
        }
        Ok(())
    }
}

/// Grows a network: a tree of `2n` nodes and `2n − 1` straight vessels with the inlet as node 0. Lengths in µm; each
/// edge has one radius, a node that of its incoming vessel. The number of threads has no influence.
///
/// ```
/// use anastomesh_network::{GenerateParams, Organ, generate};
///
/// let tree = generate(&GenerateParams::new(Organ::Ellipsoid, 50))?;
/// assert_eq!((tree.nodes.len(), tree.edges.len()), (100, 99));
/// assert_eq!(tree.adjacency().terminals().len(), 51);
/// # Ok::<(), anastomesh_network::GenerateError>(())
/// ```
///
/// # Errors
/// The parameters are invalid.
pub fn generate(params: &GenerateParams) -> Result<Skeleton, GenerateError> {
    params.check()?;
    let random = Random::new(params.seed);
    let shape = Shape::new(params.organ, params.resolved_size(), random);
    let mut points = shape.terminals(params.terminals)?;
    let mut tree = tree::grow(shape.inlet(), &mut points, params.exponent, random);
    drop(points);
    let radii = murray(&tree, params, random);
    relax::relax(&mut tree, &radii);
    Ok(skeleton(&tree, &radii))
}

/// Radius of the vessel to each node, from the terminals upwards; the inlet has the radius of its vessel.
fn murray(tree: &tree::Tree, params: &GenerateParams, random: Random) -> Vec<f64> {
    let p = params.exponent;
    let mut powers = vec![0.0; tree.sizes.len()];
    for i in (1..powers.len()).rev() {
        if tree.sizes[i] == 1 {
            let off = TERMINAL_SPREAD * random.bell(Stream::Radius, i as u64);
            powers[i] = libm::pow(params.terminal_radius * (1.0 + off), p);
        }
        let power = powers[i];
        powers[tree.parents[i] as usize] += power;
    }
    powers.iter().map(|&power| libm::pow(power, 1.0 / p)).collect()
}

fn skeleton(tree: &tree::Tree, radii: &[f64]) -> Skeleton {
    let node = |(i, (position, radius)): (usize, (&anastomesh_mesh::geometry::Point3, &f64))| Node {
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
