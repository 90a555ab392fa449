//! Classification of a network as measured or generated, by the shape of its vessels.

use super::{Adjacency, Skeleton};

/// Minimum mean number of inner points per vessel of a measured network. Vessels of generated networks have none.
const INNER_POINTS: f64 = 0.5;

impl Skeleton {
    /// True for each node with two vessels that turn back there: a terminal shared by two trees.
    pub fn folds(&self, adjacency: &Adjacency) -> Vec<bool> {
        let folds = self.node_ids().map(|n| match adjacency.edges(n) {
            &[e, f] => self.angle(n, [e, f]) < std::f64::consts::FRAC_PI_2,
            _ => false,
        });
        folds.collect()
    }

    /// True if a network was measured rather than generated: its vessels are polylines, without counting folds.
    pub fn is_measured(&self) -> bool {
        let adjacency = self.adjacency();
        let folds = self.folds(&adjacency);
        let inner = self.node_ids().filter(|&n| adjacency.valence(n) == 2 && !folds[n.index()]).count();
        let branches = self.edges.len().saturating_sub(inner);
        inner as f64 > INNER_POINTS * branches as f64
    }
}
