//! Displacement of the nodes and metrics over the iterations.

use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::{Metrics, Skeleton};
use serde::{Deserialize, Serialize};

/// Metrics after some iterations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistorySample {
    /// Iteration number.
    pub iteration: usize,
    /// Displacement of the nodes.
    pub displacement: Displacement,
    /// Metrics of the state.
    pub metrics: Metrics,
    /// Vessel pairs pushed apart in this iteration, plus vessels lengthened or opened.
    pub asked: usize,
}

/// Displacement statistics of nodes, in the unit of the skeleton unless stated otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Displacement {
    /// Mean over the nodes.
    pub mean: f64,
    /// Median over the nodes.
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Maximum.
    pub max: f64,
}

impl Displacement {
    /// Displacement of the nodes of `skeleton` from `origin`.
    pub fn of(skeleton: &Skeleton, origin: &[Point3]) -> Self {
        Self::among(skeleton.nodes.iter().zip(origin).map(|(n, o)| (n.position - o).norm()).collect())
    }

    /// Displacement in radii of the nodes.
    pub fn in_radii(skeleton: &Skeleton, origin: &[Point3]) -> Self {
        Self::among(skeleton.nodes.iter().zip(origin).map(|(n, o)| (n.position - o).norm() / n.radius).collect())
    }

    fn among(mut far: Vec<f64>) -> Self {
        if far.is_empty() {
            return Self::default();
        }
        far.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| far[(share * (far.len() - 1) as f64).round() as usize];
        Self {
            mean: far.iter().sum::<f64>() / far.len() as f64,
            median: at(0.5),
            p95: at(0.95),
            p99: at(0.99),
            max: at(1.0),
        }
    }
}
