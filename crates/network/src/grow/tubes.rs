//! Collision tests between vessels.

use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, tube_tube};

/// Minimum distance of the axes of separate vessels, in sums of their radii.
pub(super) const APART: f64 = 1.5;

/// True if two vessels without a common node are too close to each other.
pub(super) fn meet(a: &Tube, b: &Tube) -> bool {
    let pair = tube_tube(a, b);
    pair.gap < (APART - 1.0) * (a.radius(pair.s) + b.radius(pair.t))
}

/// Vessels with a search tree.
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

    /// True if a vessel is too close to another one, except `but_one` and those with an end in `but`.
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

/// Bounding box; the boxes of vessels that are too close to each other overlap.
fn around(tube: &Tube) -> Aabb {
    Aabb::of_points([&tube.a, &tube.b]).grown(APART * tube.max_radius())
}
