//! Tubes of a network with spatial search.

use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, point_segment};
use anastomesh_skeleton::{EdgeId, Skeleton};

/// Tubes of a network with spatial search.
pub struct Tubes {
    pub list: Vec<Tube>,
    pub tree: Bvh,
    /// Upper bound for the distance between two points of the network.
    extent: f64,
    /// The median radius.
    pub typical: f64,
}

/// Nearest tube to a place.
#[derive(Clone, Copy)]
pub struct Nearest {
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
    pub fn nearest_wall(&self, place: &Point3) -> Option<Nearest> {
        self.nearest(place, 0.1 * self.typical, |distance, radius| distance - radius)
    }

    /// Returns the tube with the least `measure` (of axis distance and radius) near a place. `reach` is the initial
    /// search radius.
    pub fn nearest(&self, place: &Point3, reach: f64, measure: impl Fn(f64, f64) -> f64) -> Option<Nearest> {
        let mut reach = reach.max(1e-3 * self.typical);
        loop {
            let mut best: Option<(f64, Nearest)> = None;
            self.tree.query(&Aabb::of_points([place]).grown(reach), |id| {
                let tube = &self.list[id as usize];
                let (t, distance) = point_segment(place, &tube.a, &tube.b);
                let found = Nearest { edge: EdgeId(id), t, distance, radius: tube.radius(t) };
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
