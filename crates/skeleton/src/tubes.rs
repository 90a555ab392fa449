//! Tubes of a network with spatial search.

use crate::{EdgeId, Skeleton};
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, point_segment};

/// Tubes of a network with spatial search.
///
/// ```
/// use anastomesh_mesh::Point3;
/// use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton, Tubes};
///
/// let node = |z: f64, original| Node { position: Point3::new(0.0, 0.0, z), radius: 1.0, original };
/// let edges = vec![Edge { nodes: [NodeId(0), NodeId(1)], radii: [1.0; 2] }];
/// let vessel = Skeleton { nodes: vec![node(0.0, 0), node(8.0, 1)], edges };
/// let nearest = Tubes::of(&vessel).nearest_wall(&Point3::new(3.0, 0.0, 2.0)).expect("an edge");
/// assert_eq!((nearest.t, nearest.distance, nearest.radius), (0.25, 3.0, 1.0));
/// ```
pub struct Tubes {
    /// Tube of each edge.
    pub list: Vec<Tube>,
    /// Their boxes.
    pub tree: Bvh,
    /// Upper bound for the distance between two points of the network.
    extent: f64,
    /// Median radius.
    pub typical: f64,
}

/// Tube nearest to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NearestTube {
    /// Edge of the tube.
    pub edge: EdgeId,
    /// Parameter along the edge, in [0, 1].
    pub t: f64,
    /// Distance from the axis.
    pub distance: f64,
    /// Radius at this point.
    pub radius: f64,
}

impl Tubes {
    /// Collects the tubes of all edges.
    pub fn of(skeleton: &Skeleton) -> Self {
        let list: Vec<Tube> = skeleton.edge_ids().map(|e| skeleton.tube(e)).collect();
        let boxes: Vec<Aabb> = list.iter().map(|t| Aabb::of_points([&t.a, &t.b]).grown(t.max_radius())).collect();
        let all = boxes.iter().fold(Aabb::EMPTY, |sum, aabb| sum.union(aabb));
        let mut radii: Vec<f64> = list.iter().map(|t| 0.5 * (t.ra + t.rb)).collect();
        radii.sort_unstable_by(f64::total_cmp);
        let typical = radii.get(radii.len() / 2).copied().unwrap_or(1.0);
        Self { tree: Bvh::of(boxes), list, extent: (all.max - all.min).norm(), typical }
    }

    /// Returns the tube with the nearest wall; distances inside are negative.
    pub fn nearest_wall(&self, place: &Point3) -> Option<NearestTube> {
        self.nearest(place, 0.1 * self.typical, |distance, radius| distance - radius)
    }

    /// Returns the tube with the least `measure` (of axis distance and radius) near a place. `reach` is the initial
    /// search radius.
    pub fn nearest(&self, place: &Point3, reach: f64, measure: impl Fn(f64, f64) -> f64) -> Option<NearestTube> {
        let mut reach = reach.max(1e-3 * self.typical);
        loop {
            let mut best: Option<(f64, NearestTube)> = None;
            self.tree.query(&Aabb::of_points([place]).grown(reach), |id| {
                let tube = &self.list[id as usize];
                let (t, distance) = point_segment(place, &tube.a, &tube.b);
                let found = NearestTube { edge: EdgeId(id), t, distance, radius: tube.radius(t) };
                let value = measure(distance, found.radius);
                if best.is_none_or(|(b, n)| value < b || value <= b && found.edge < n.edge) {
                    best = Some((value, found));
                }
            });
            // Tubes outside the box have walls further away than its half extent.
            if let Some((value, nearest)) = best
                && value <= reach
            {
                return Some(nearest);
            }
            if reach > 2.0 * self.extent {
                return best.map(|(_, nearest)| nearest);
            }
            reach *= 2.0;
        }
    }
}
