//! The tubes of a network, to be found by place.

use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, point_segment};
use anastomesh_skeleton::{EdgeId, Skeleton};

/// The tubes of a network, to be found by place.
pub struct Tubes {
    pub list: Vec<Tube>,
    pub tree: Bvh,
    /// A length in which the network is large: no place of it is further from another one.
    extent: f64,
    /// The median radius.
    pub typical: f64,
}

/// What is nearest to a place.
#[derive(Clone, Copy)]
pub struct Nearest {
    pub edge: EdgeId,
    /// Where along it, in [0, 1].
    pub t: f64,
    /// Distance of the axis.
    pub distance: f64,
    /// Radius there.
    pub radius: f64,
}

impl Tubes {
    /// Of all edges.
    pub fn of(skeleton: &Skeleton) -> Self {
        let list: Vec<Tube> = skeleton.edge_ids().map(|e| skeleton.tube(e)).collect();
        let boxes: Vec<Aabb> = list.iter().map(|t| Aabb::of_points([&t.a, &t.b]).grown(t.max_radius())).collect();
        let all = boxes.iter().fold(Aabb::EMPTY, |sum, aabb| sum.union(aabb));
        let mut radii: Vec<f64> = list.iter().map(|t| 0.5 * (t.ra + t.rb)).collect();
        radii.sort_unstable_by(f64::total_cmp);
        let typical = radii.get(radii.len() / 2).copied().unwrap_or(1.0);
        Self { tree: Bvh::of(boxes), list, extent: (all.max - all.min).norm(), typical }
    }

    /// The tube whose wall is nearest, counted as negative inside.
    pub fn nearest_wall(&self, place: &Point3) -> Option<Nearest> {
        self.nearest(place, 0.1 * self.typical, |distance, radius| distance - radius)
    }

    /// The tube of which `measure` (distance of the axis, radius) is least among those near a place; `reach` is how far
    /// off it is looked for first.
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
            // What lies outside of the box is further from every tube's wall than its half.
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
