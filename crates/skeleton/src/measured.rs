//! Whether a network was measured or grown, by the shape of its vessels.

use super::{Adjacency, Skeleton};

/// A network is measured when its vessels have more inner points than this, on average: those that are grown have none.
const INNER_POINTS: f64 = 0.5;

impl Skeleton {
    /// Of each node, whether it has two vessels and the way turns back there: a terminal that two trees share.
    pub fn folds(&self, adjacency: &Adjacency) -> Vec<bool> {
        let folds = self.node_ids().map(|n| match adjacency.edges(n) {
            &[e, f] => self.angle(n, [e, f]) < std::f64::consts::FRAC_PI_2,
            _ => false,
        });
        folds.collect()
    }

    /// Whether a network was measured rather than grown: its vessels are polylines. Nodes at which a vessel turns back do
    /// not count.
    pub fn is_measured(&self) -> bool {
        let adjacency = self.adjacency();
        let folds = self.folds(&adjacency);
        let inner = self.node_ids().filter(|&n| adjacency.valence(n) == 2 && !folds[n.index()]).count();
        let branches = self.edges.len().saturating_sub(inner);
        inner as f64 > INNER_POINTS * branches as f64
    }
}
