//! Vessels in each other's way.

use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, tube_tube};

/// Axes of vessels that do not meet are further apart than this, in sums of their radii.
pub(super) const APART: f64 = 1.5;

/// Whether two vessels that share no node are too close to each other.
pub(super) fn meet(a: &Tube, b: &Tube) -> bool {
    let pair = tube_tube(a, b);
    pair.gap < (APART - 1.0) * (a.radius(pair.s) + b.radius(pair.t))
}

/// Vessels, and a tree in which those close to a place are found.
pub(super) struct TubeTree {
    pub list: Vec<Tube>,
    pub tree: Bvh,
}

impl TubeTree {
    pub fn new(vessels: impl Iterator<Item = Tube>) -> Self {
        let list: Vec<Tube> = vessels.collect();
        let boxes: Vec<Aabb> = list.iter().map(around).collect();
        Self { tree: Bvh::new(&boxes), list }
    }

    /// Whether one of them is too close to a vessel, but for those that begin or end at one of these points, and for one.
    pub fn meets(&self, vessel: &Tube, but: &[Point3], but_one: Option<u32>) -> bool {
        let mut meets = false;
        self.tree.query(&around(vessel), |i| {
            let other = &self.list[i as usize];
            let shares = but_one == Some(i) || but.iter().any(|p| *p == other.a || *p == other.b);
            meets = meets || (!shares && meet(vessel, other));
        });
        meets
    }
}

/// Boxes of vessels that are too close to each other overlap.
fn around(tube: &Tube) -> Aabb {
    Aabb::of_points([&tube.a, &tube.b]).grown(APART * tube.max_radius())
}
