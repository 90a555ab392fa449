//! Edge lengths at points along vessels, from which the tetrahedra of the tissue grow.

use crate::error::DomainError;
use crate::plan::{Site, Thickness};
use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::{EdgeId, Skeleton};
use anastomesh_tet::TetError;

/// Distance of points along a vessel, relative to the edge length there. Lengths halfway are a fifth longer for the default
/// growth. Smaller distances take more time, and change the number of cells by a few percent.
const STEP: f64 = 1.0;

/// Relative difference of the edge lengths at both ends of an edge up to which points are equally spaced.
const EQUAL: f64 = 1e-3;

/// Tetrahedra per point along a vessel, at least.
const TETS: f64 = 6.0;

/// Points along the edges of a network with the edge lengths wanted there. `most` is the maximum number of tetrahedra.
///
/// # Errors
/// If the points alone need more tetrahedra.
pub fn sources(network: &Skeleton, size: &Thickness, most: usize) -> Result<Vec<(Point3, f64)>, DomainError> {
    let lines: Vec<Line> = network.edge_ids().map(|edge| Line::of(network, size, edge)).collect();
    let tets = TETS * lines.iter().map(|line| line.steps).sum::<f64>();
    if tets > most as f64 {
        return Err(DomainError::Tissue(TetError::TooMany { estimate: tets as usize, limit: most }));
    }
    Ok(lines.iter().flat_map(Line::points).collect())
}

/// Edge of a network with the edge lengths at its ends.
struct Line {
    ends: [Point3; 2],
    sizes: [f64; 2],
    /// Number of steps along it, a whole number.
    steps: f64,
}

impl Line {
    fn of(network: &Skeleton, size: &Thickness, edge: EdgeId) -> Self {
        let tube = network.tube(edge);
        let ends = network.edges[edge.index()].nodes.map(|node| network.nodes[node.index()].original);
        let at = |t: f64| size.at(&Site { radius: tube.radius(t), ends, t });
        let sizes = [at(0.0), at(1.0)];
        // Mean of a length that grows linearly, in steps that grow alike.
        let [a, b] = sizes;
        let mean = if (b - a).abs() <= EQUAL * a { a } else { (b - a) / libm::log(b / a) };
        let steps = (network.length(edge) / (STEP * mean)).ceil().max(1.0);
        Self { ends: [tube.a, tube.b], sizes, steps }
    }

    /// Points from one end to the other, in proportion to the lengths.
    fn points(&self) -> impl Iterator<Item = (Point3, f64)> {
        let ([p, q], [a, b]) = (self.ends, self.sizes);
        (0..=self.steps as u64).map(move |i| {
            let part = i as f64 / self.steps;
            let t = if (b - a).abs() <= EQUAL * a { part } else { (libm::pow(b / a, part) - 1.0) / (b / a - 1.0) };
            (p.lerp(&q, t.clamp(0.0, 1.0)), a + t * (b - a))
        })
    }
}
