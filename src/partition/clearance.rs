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

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Vec3;
    use proptest::prelude::*;

    /// Tip of radius 2 at the origin, along x. Its cylinder reaches from -1 to 4, and its ball to 6.
    fn tip() -> Tip {
        let tip = Tip::new(Section::new(Point3::origin(), Vec3::x(), 2.0), 4.0 + 0.46);
        assert!(tip.reach[0] == -1.0 && (tip.reach[1] - 4.0).abs() < 1e-12);
        tip
    }

    fn tube(a: [f64; 3], b: [f64; 3], ra: f64, rb: f64) -> Tube {
        Tube { a: a.into(), b: b.into(), ra, rb }
    }

    #[test]
    fn a_tip_is_a_cylinder_and_half_a_ball() {
        let closest = |p: [f64; 3]| tip().closest(&Point3::from(p));
        for (p, expected) in [
            ([1.0, 5.0, 0.0], [1.0, 2.0, 0.0]),
            ([1.0, 1.0, 0.5], [1.0, 1.0, 0.5]),
            ([-3.0, 0.0, 4.0], [-1.0, 0.0, 2.0]),
            ([-3.0, 1.0, 0.0], [-1.0, 1.0, 0.0]),
            ([9.0, 0.0, 0.0], [6.0, 0.0, 0.0]),
            ([4.5, 0.5, 0.0], [4.5, 0.5, 0.0]),
        ] {
            assert!((closest(p) - Point3::from(expected)).norm() < 1e-9, "{p:?}: {}", closest(p));
        }
        let diagonal = closest([7.0, 3.0, 0.0]);
        assert!((diagonal - Point3::new(4.0 + libm::sqrt(2.0), libm::sqrt(2.0), 0.0)).norm() < 1e-9, "{diagonal}");
    }

    #[test]
    fn parallel_vessels_stay_the_blended_radii_apart() {
        let beside = |distance: f64| tube([-9.0, distance, 0.0], [9.0, distance, 0.0], 1.0, 1.0);
        // Distances of axes: 1.5 · (2 + 1), and 2 + 1.5 · 1 + 0.027 · 2.
        assert!(!tip().clears(&beside(4.49), 1.5) && tip().clears(&beside(4.51), 1.5));
        assert!(!tip().rim_clears(&beside(3.553), 1.5) && tip().rim_clears(&beside(3.555), 1.5));
        // Beyond the ball, and before the cylinder.
        let across = |x: f64| tube([x, -9.0, 0.0], [x, 9.0, 0.0], 1.0, 1.0);
        assert!(!tip().clears(&across(8.49), 1.5) && tip().clears(&across(8.51), 1.5));
        assert!(!tip().clears(&across(-3.49), 1.5) && tip().clears(&across(-3.51), 1.5));
    }

    #[test]
    fn vessels_in_the_way_have_boxes_that_overlap() {
        let bounds = tip().aabb(1.5);
        assert!((bounds.min - Point3::new(-4.0, -3.0, -3.0)).norm() < 1e-9, "{}", bounds.min);
        assert!((bounds.max - Point3::new(7.0, 3.0, 3.0)).norm() < 1e-9, "{}", bounds.max);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// The search agrees with samples along the vessel.
        #[test]
        fn cones_are_searched_for_their_closest_point(
            a in prop::array::uniform3(-9.0..9.0_f64), b in prop::array::uniform3(-9.0..9.0_f64),
            ra in 0.05..3.0_f64, rb in 0.05..3.0_f64, blending in 1.0..2.0_f64,
        ) {
            let (tip, cone) = (tip(), tube(a, b, ra, rb));
            let spare = |k: i32| {
                let t = f64::from(k) / 1000.0;
                let p = cone.point(t);
                (p - tip.closest(&p)).norm() - tip.margin(cone.radius(t), blending)
            };
            let least = (0..=1000).map(spare).fold(f64::INFINITY, f64::min);
            // Samples are up to 0.03 apart.
            prop_assume!(least.abs() > 0.05);
            prop_assert_eq!(tip.clears(&cone, blending), least > 0.0);
            let near = Aabb::of_points([&cone.a, &cone.b]).grown(blending * cone.max_radius());
            prop_assert!(least > 0.0 || near.overlaps(&tip.aabb(blending)));
        }
    }
}
