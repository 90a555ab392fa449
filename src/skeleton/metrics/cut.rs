//! Whether a branch has room for a cut: equations 11 and 12 at both ends, and a connector between them.

use super::super::{Adjacency, Branch, NodeId, Skeleton};
use crate::geometry::Vec3;

/// Least distance of a cut from a node, in radii (equation 11: 2 ω).
const NODE_DISTANCE: f64 = 2.2;
/// Margin on equation 12.
const ANGLE_MARGIN: f64 = 1.25;
/// Room for a connector, in radii.
const CONNECTOR: f64 = 2.0;
/// Over how many radii the direction of a polyline is measured.
const WINDOW: f64 = 3.0;

/// How far the cuts of a branch have to stay from its ends, and what is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutRoom {
    /// Least distances from the first and the last node: max(2.2 r, 1.25 × equation 12).
    pub distances: [f64; 2],
    /// Room for the connector: 2 r, r the mean radius.
    pub connector: f64,
    /// Length of the branch.
    pub length: f64,
}

impl CutRoom {
    /// Whether everything fits.
    pub fn fits(&self) -> bool {
        self.distances[0] + self.distances[1] + self.connector <= self.length
    }
}

/// Equation 12: how far from their node two vessels of the given radii that leave it along `u` and `v` are separate,
/// measured along the first: (r2 + r1 cos φ) / sin φ; 0 unless the angle is acute.
pub fn separation(u: &Vec3, v: &Vec3, radii: [f64; 2]) -> f64 {
    let dot = u.dot(v);
    if dot <= 0.0 {
        return 0.0;
    }
    // Both over |u| |v|.
    let scale = u.norm() * v.norm();
    (radii[1] * scale + radii[0] * dot) / u.cross(v).norm()
}

impl Skeleton {
    /// What a cut of the branch needs and has; none when it is open at a terminal, or a ring without a junction.
    pub fn cut_room(&self, adjacency: &Adjacency, branch: &Branch) -> Option<CutRoom> {
        if branch.ends().iter().any(|&n| adjacency.valence(n) < 3) {
            return None;
        }
        let distances = [0, 1].map(|end| self.cut_distance(adjacency, branch, end));
        Some(CutRoom { distances, connector: CONNECTOR * branch.mean_radius(self), length: branch.length() })
    }

    /// Whether an inner branch can be cut; none for other branches.
    pub(super) fn is_cuttable(&self, adjacency: &Adjacency, branch: &Branch) -> Option<bool> {
        self.cut_room(adjacency, branch).map(|room| room.fits())
    }

    fn cut_distance(&self, adjacency: &Adjacency, branch: &Branch, end: usize) -> f64 {
        let node = branch.ends()[end];
        let own = if end == 0 { branch.edges[0] } else { branch.edges[branch.edges.len() - 1] };
        let radius = |e: super::super::EdgeId| self.edge(e).radii[self.edge(e).end(node)];
        let u = self.leaving(adjacency, node, own);
        let others = adjacency.edges(node).iter().filter(|&&e| e != own);
        let apart = others
            .map(|&e| separation(&u, &self.leaving(adjacency, node, e), [radius(own), radius(e)]))
            .fold(0.0, f64::max);
        (NODE_DISTANCE * radius(own)).max(ANGLE_MARGIN * apart)
    }

    /// Where a vessel leads that leaves `node` by `edge`: the chord over the first radii of it.
    fn leaving(&self, adjacency: &Adjacency, node: NodeId, mut edge: super::super::EdgeId) -> Vec3 {
        let start = self.node(node).position;
        let window = WINDOW * self.node(node).radius;
        let mut at = node;
        // Chains are finite, but a ring of tiny edges must not be walked round and round.
        for _ in 0..64 {
            at = self.edge(edge).other(at);
            let chord = self.node(at).position - start;
            if chord.norm() >= window || adjacency.valence(at) != 2 {
                return chord;
            }
            let pair = adjacency.edges(at);
            edge = if pair[0] == edge { pair[1] } else { pair[0] };
        }
        self.node(at).position - start
    }
}
