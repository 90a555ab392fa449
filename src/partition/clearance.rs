//! Whether the tip of a vessel stays clear of another vessel.
//!
//! Equation 12 says where the wall of a vessel leaves the wall of its neighbour at a junction. The same question, asked
//! of any other vessel: how far is its axis from the solid that the tip fills? The neighbour at the junction
//! is then no exception, and bends need no angle.

use anastomesh_mesh::geometry::{Aabb, Point3, Section, Tube, segment_segment};

/// How far a tip reaches back from its end plane, in radii: trimming and flattening work there.
const BACK: f64 = 0.5;

/// How far the wall goes on, in radii, where the axis of a vessel ends: with σ = κ r = 0.33 r the field on the axis,
/// exp(r² / 2σ²) Φ(−h / σ), falls to 1 at h = 0.77 r. The wall there is half a sphere about the point at h = −0.23 r,
/// within 0.06 r.
const ROUND: f64 = 0.77;

/// The golden section, and how often an interval is cut by it at most: to 10⁻¹⁰ of it.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const GOLDEN_STEPS: u32 = 48;

/// How far the middle of the round tip that an overrun gives a vessel lies beyond the end plane.
pub(super) fn tip_middle(radius: f64, overrun: f64) -> f64 {
    overrun - (1.0 - ROUND) * radius
}

/// The end of a vessel: the solid cylinder about its end plane, from shortly before it to the middle of the round tip, and
/// half a ball about this.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tip {
    section: Section,
    /// Heights over the plane between which the cylinder reaches.
    reach: [f64; 2],
}

impl Tip {
    pub fn new(section: Section, overrun: f64) -> Self {
        let back = -BACK * section.radius;
        Self { section, reach: [back, tip_middle(section.radius, overrun).max(back)] }
    }

    fn axis_point(&self, height: f64) -> Point3 {
        self.section.origin + self.section.axis * height
    }

    /// Distance that has to lie between the cylinder and the axis of a vessel of radius `other`: two parallel vessels
    /// are then `blending` × the sum of their radii apart.
    fn margin(&self, other: f64, blending: f64) -> f64 {
        blending * other + (blending - 1.0) * self.section.radius
    }

    /// A box that meets the box of every vessel in the way, if that is grown by `blending` × its radius.
    pub fn aabb(&self, blending: f64) -> Aabb {
        let ends = self.reach.map(|h| self.axis_point(h));
        Aabb::of_points(&ends).grown(blending * self.section.radius)
    }

    /// Whether the vessel is far enough off.
    pub fn clears(&self, tube: &Tube, blending: f64) -> bool {
        let radius = self.section.radius;
        let ends = self.reach.map(|h| self.axis_point(h));
        let near = segment_segment([&ends[0], &ends[1]], [&tube.a, &tube.b]);
        if near.distance >= radius + self.margin(tube.max_radius(), blending) {
            return true;
        }
        // How much there is to spare is convex along the axis: a distance to a convex solid, less a linear radius. A
        // golden section closes in on its least value, until the steepest that it can fall decides. A cone's widest part
        // need not be what comes closest.
        let spare = |t: f64| {
            let p = tube.point(t);
            (p - self.closest(&p)).norm() - self.margin(tube.radius(t), blending)
        };
        let steep = tube.length() + blending * (tube.rb - tube.ra).abs();
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..GOLDEN_STEPS {
            let inner = [hi - GOLDEN * (hi - lo), lo + GOLDEN * (hi - lo)];
            let spares = inner.map(spare);
            let least = spares[0].min(spares[1]);
            if least < 0.0 {
                return false;
            }
            if least > steep * (inner[0] - lo) {
                return true;
            }
            if spares[0] < spares[1] { hi = inner[1] } else { lo = inner[0] }
        }
        true
    }

    /// The point of the solid that is closest to `p`.
    fn closest(&self, p: &Point3) -> Point3 {
        let height = self.section.height(p);
        if height > self.reach[1] {
            let middle = self.axis_point(self.reach[1]);
            let way = p - middle;
            let distance = way.norm();
            return if distance > self.section.radius { middle + way * (self.section.radius / distance) } else { *p };
        }
        let aside = p - self.axis_point(height);
        let distance = aside.norm();
        let lateral = if distance > self.section.radius { aside * (self.section.radius / distance) } else { aside };
        self.axis_point(height.clamp(self.reach[0], self.reach[1])) + lateral
    }
}
