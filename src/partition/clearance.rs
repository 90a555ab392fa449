//! Clearance test between the tip of a vessel and other vessels.
//!
//! Equation 12 locates the point where the walls of two vessels at a junction separate. This module generalizes it to
//! any vessel: the distance between its axis and the solid of the tip decides. Junction neighbours and bends then need
//! no special case.

use anastomesh_mesh::geometry::{Aabb, Point3, Section, Tube, segment_segment};

/// Extent of a tip before its end plane, in radii: trimming and flattening affect this part.
const BACK: f64 = 0.5;

/// Height of the wall beyond the end of a vessel's axis, in radii. Let σ = κ r = 0.33 r. The field on the axis, exp(r²
/// / 2σ²) Φ(−h / σ), falls to 1 at h = 0.77 r. The wall there is a hemisphere about the point at h = −0.23 r, within
/// 0.06 r.
const ROUND: f64 = 0.77;

/// Height of the rim of an overrun's end over the solid of the tip, in radii: √(1 + (1 − ROUND)²) − 1, rounded up.
const RIM: f64 = 0.027;

/// Golden ratio and maximum number of golden section steps: they reduce an interval to 10⁻¹⁰ of its length.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const GOLDEN_STEPS: u32 = 48;

/// Distance of the centre of a vessel's round tip beyond its end plane.
pub(super) fn tip_middle(radius: f64, overrun: f64) -> f64 {
    overrun - (1.0 - ROUND) * radius
}

/// End of a vessel: a solid cylinder and half a ball.
///
/// The cylinder extends from shortly before the end plane to the centre of the round tip, which is the ball's centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tip {
    section: Section,
    /// Heights of the cylinder's ends over the plane.
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

    /// Required distance between the cylinder and the axis of a vessel of radius `other`. It keeps parallel vessels
    /// `blending` times the sum of their radii apart.
    fn margin(&self, other: f64, blending: f64) -> f64 {
        blending * other + (blending - 1.0) * self.section.radius
    }

    /// Box that overlaps the box of every obstructing vessel, if that is grown by `blending` times its radius.
    pub fn aabb(&self, blending: f64) -> Aabb {
        let ends = self.reach.map(|h| self.axis_point(h));
        Aabb::of_points(&ends).grown(blending * self.section.radius)
    }

    /// True if the vessel keeps the required distance.
    pub fn clears(&self, tube: &Tube, blending: f64) -> bool {
        self.keeps(tube, blending, |other| self.margin(other, blending))
    }

    /// True if the axis of the vessel stays `blending` times its radius away from the tip, up to the rim of its overrun.
    pub fn rim_clears(&self, tube: &Tube, blending: f64) -> bool {
        self.keeps(tube, blending, |other| blending * other + RIM * self.section.radius)
    }

    /// True if every point of the vessel's axis keeps the distance `margin(radius)` from the solid. The margin is linear
    /// with slope `blending`.
    fn keeps(&self, tube: &Tube, blending: f64, margin: impl Fn(f64) -> f64) -> bool {
        let ends = self.reach.map(|h| self.axis_point(h));
        let near = segment_segment([&ends[0], &ends[1]], [&tube.a, &tube.b]);
        if near.distance >= self.section.radius + margin(tube.max_radius()) {
            return true;
        }
        // The clearance is convex along the axis: distance to a convex solid minus a linear radius. Golden section
        // search encloses its minimum until the steepest possible decrease decides. The widest part of a cone need not
        // be the closest.
        let spare = |t: f64| {
            let p = tube.point(t);
            (p - self.closest(&p)).norm() - margin(tube.radius(t))
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

    /// Closest point of the solid to `p`.
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
