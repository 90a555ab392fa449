//! Offset of the midpoint of a curved edge from its chord.

use crate::geometry::Vec3;

/// Offset from the midpoint of the chord `e` to the surface. `start` and `end` are unit normals of the surface at the ends of the
/// chord. Zero if they do not describe an arc.
///
/// On a cylinder or sphere of radius R, let 2θ be the angle between the normals, with the bisector m. Then
/// start + end = 2 cos θ m. The difference end − start has length 2 sin θ. It has the direction in which the chord runs around
/// the axis, where the chord extends over 2R sin θ. Therefore (end − start) · e = 4R sin² θ. The surface is R (1 − cos θ) above the
/// middle of the chord, which is
///
/// (end − start) · e / (4 (1 + cos θ)).
///
/// This is exact for any chord of a sphere or a cylinder, also for chords that are oblique to the axis. An inflection gives zero.
pub(super) fn arc_offset(e: Vec3, start: Vec3, end: Vec3) -> Vec3 {
    let sum = start + end;
    let cosine = 0.5 * sum.norm();
    if cosine.is_nan() || cosine < LEAST_COSINE {
        return Vec3::zeros();
    }
    let bisector = sum / (2.0 * cosine);
    let length = e.norm();
    let height = (end - start).dot(&e) / (4.0 * (1.0 + cosine));
    // Normals along the chord belong to a surface that is not resolved. Heights of rounding errors are no curvature.
    let is_arc = bisector.dot(&e).abs() <= GREATEST_SLOPE * length && height.abs() > FLAT * length;
    if is_arc { bisector * height } else { Vec3::zeros() }
}

/// Least cosine of half the angle between the normals: arcs of 120° at most. Chords of longer arcs stay straight.
const LEAST_COSINE: f64 = 0.5;

/// Greatest sine of the angle between the bisector of the normals and the plane across the chord.
const GREATEST_SLOPE: f64 = 0.5;

/// Height of an arc over its chord below which the edge is straight. Rounding errors of normals are about 1e-15.
const FLAT: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn on_cylinder(radius: f64, angle: f64, z: f64) -> (Vec3, Vec3) {
        let normal = Vec3::new(libm::cos(angle), libm::sin(angle), 0.0);
        (normal * radius + Vec3::z() * z, normal)
    }

    proptest! {
        #[test]
        fn chords_of_cylinders_are_exact(radius in 0.1..10.0, angle in 0.01..2.0_f64, z in -5.0..5.0) {
            let ((a, n), (b, m)) = (on_cylinder(radius, 0.3, 0.0), on_cylinder(radius, 0.3 + angle, z));
            let steep = z.abs() > 1e3 * radius * angle;
            let middle = (a + b) / 2.0 + arc_offset(b - a, n, m);
            prop_assert!(steep || (middle.xy().norm() - radius).abs() < 1e-12 * radius);
            prop_assert!((middle.z - z / 2.0).abs() < 1e-12 * (1.0 + z.abs()));
        }

        #[test]
        fn chords_of_spheres_are_exact(u in prop::array::uniform3(-1.0..1.0), v in prop::array::uniform3(-1.0..1.0)) {
            let (Some(u), Some(v)) = (Vec3::from(u).try_normalize(0.1), Vec3::from(v).try_normalize(0.1)) else {
                return Ok(());
            };
            prop_assume!((u + v).norm() > 1.01);
            let middle = (u + v) * 1.5 + arc_offset((v - u) * 3.0, u, v);
            prop_assert!((middle.norm() - 3.0).abs() < 1e-11);
        }
    }

    #[test]
    fn inflections_and_flat_surfaces_stay_straight() {
        let tilted = Vec3::new(0.3, 0.0, 1.0).normalize();
        assert_eq!(arc_offset(Vec3::x(), tilted, tilted), Vec3::zeros());
        assert_eq!(arc_offset(Vec3::x(), Vec3::z(), -Vec3::z()), Vec3::zeros());
        assert_eq!(arc_offset(Vec3::x(), Vec3::zeros(), Vec3::z()), Vec3::zeros());
    }
}
