//! Distances between points, segments, triangles and tapering tubes.
//!
//! All in floating point: these functions measure and decide no topology.

use super::convex::minimise_convex;
use super::{Point3, Tube};

/// Closest points of two segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentPair {
    /// Parameter in [0, 1] on the first segment.
    pub s: f64,
    /// Parameter in [0, 1] on the second segment.
    pub t: f64,
    /// Distance between the two points.
    pub distance: f64,
}

/// Parameter in [0, 1] of the point of segment `ab` closest to `p`, and its distance. Length 0 gives 0.
#[inline]
pub fn point_segment(p: &Point3, a: &Point3, b: &Point3) -> (f64, f64) {
    let d = b - a;
    let along = (p - a).dot(&d);
    let length2 = d.norm_squared();
    let t = if along <= 0.0 {
        0.0
    } else if along >= length2 {
        1.0
    } else {
        along / length2
    };
    (t, (p - (a + d * t)).norm())
}

/// Closest points of the segments `a` and `b`. Parallel and degenerate segments are valid and give one closest pair.
pub fn segment_segment(a: [&Point3; 2], b: [&Point3; 2]) -> SegmentPair {
    let (d, e, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (dd, de, ee) = (d.norm_squared(), d.dot(&e), e.norm_squared());
    let (dw, ew) = (d.dot(&w), e.dot(&w));
    // The squared distance is convex in (s, t): its minimum is inside the square or on one of its four sides.
    let ends = [0.0, 1.0].map(|s: f64| {
        let (t, distance) = point_segment(&(a[0] + d * s), b[0], b[1]);
        SegmentPair { s, t, distance }
    });
    let others = [0.0, 1.0].map(|t: f64| {
        let (s, distance) = point_segment(&(b[0] + e * t), a[0], a[1]);
        SegmentPair { s, t, distance }
    });
    let mut best = ends[0];
    for pair in [ends[1], others[0], others[1]] {
        if pair.distance < best.distance {
            best = pair;
        }
    }
    let determinant = dd * ee - de * de;
    let (s, t) = ((de * ew - ee * dw) / determinant, (dd * ew - de * dw) / determinant);
    if determinant > 0.0 && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        let distance = (w + d * s - e * t).norm();
        if distance < best.distance {
            best = SegmentPair { s, t, distance };
        }
    }
    best
}

/// Point of triangle `abc` closest to `p`, and its distance. Degenerate triangles are valid.
pub fn point_triangle(p: &Point3, [a, b, c]: [&Point3; 3]) -> (Point3, f64) {
    let (u, v, w) = (b - a, c - a, p - a);
    let (uu, uv, vv) = (u.norm_squared(), u.dot(&v), v.norm_squared());
    let (wu, wv) = (w.dot(&u), w.dot(&v));
    let determinant = uu * vv - uv * uv;
    let (y, z) = (vv * wu - uv * wv, uu * wv - uv * wu);
    if determinant > 0.0 && y >= 0.0 && z >= 0.0 && y + z <= determinant {
        let q = a + u * (y / determinant) + v * (z / determinant);
        return (q, (p - q).norm());
    }
    let mut best = (*a, f64::INFINITY);
    for (from, to) in [(a, b), (b, c), (c, a)] {
        let (t, distance) = point_segment(p, from, to);
        if distance < best.1 {
            best = (from + (to - from) * t, distance);
        }
    }
    best
}

/// Closest approach of two tube walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubePair {
    /// Parameter in [0, 1] on the first tube's axis.
    pub s: f64,
    /// Parameter in [0, 1] on the second tube's axis.
    pub t: f64,
    /// Distance of the two axis points minus the sum of the radii there; negative if the tubes overlap.
    pub gap: f64,
}

/// Parameter and gap of the sphere of `tube` closest to the point `p`: the minimum over t of |p − x(t)| − r(t). A taper
/// moves it from the foot of the perpendicular towards the thick end.
pub fn point_tube(p: &Point3, tube: &Tube) -> (f64, f64) {
    let d = tube.b - tube.a;
    let length = d.norm();
    let gap = |t: f64| (p - tube.point(t)).norm() - tube.radius(t);
    let slope = tube.rb - tube.ra;
    if length <= slope.abs() {
        // One end's sphere contains all others.
        let t = if slope > 0.0 { 1.0 } else { 0.0 };
        return (t, gap(t));
    }
    let along = (p - tube.a).dot(&d) / length;
    let height = (p - (tube.a + d * (along / length))).norm();
    let sine = slope / length;
    let shift = height * sine / (1.0 - sine * sine).sqrt();
    let t = ((along + shift) / length).clamp(0.0, 1.0);
    (t, gap(t))
}

/// Smallest gap between two tubes: the minimum over (s, t) of |x(s) − y(t)| − r(s) − q(t), to about 1e-9 of the
/// lengths. The function is convex (a norm minus linear terms), so a search over s with t solved exactly finds it.
pub fn tube_tube(a: &Tube, b: &Tube) -> TubePair {
    if (a.ra, b.ra) == (a.rb, b.rb) {
        let pair = segment_segment([&a.a, &a.b], [&b.a, &b.b]);
        return TubePair { s: pair.s, t: pair.t, gap: pair.distance - a.ra - b.ra };
    }
    let at = |s: f64| {
        let (t, gap) = point_tube(&a.point(s), b);
        (gap - a.radius(s), s, t)
    };
    let (gap, s, t) = minimise_convex(at, [0.0, 1.0], f64::INFINITY);
    TubePair { s, t, gap }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point3> {
        prop::array::uniform3(prop_oneof![-4.0..4.0_f64, (-4_i8..5).prop_map(f64::from)])
            .prop_map(|[x, y, z]| Point3::new(x, y, z))
    }

    fn tube() -> impl Strategy<Value = Tube> {
        (point(), point(), 0.1..2.0_f64, 0.1..2.0_f64).prop_map(|(a, b, ra, rb)| Tube { a, b, ra, rb })
    }

    const STEPS: i32 = 60;

    fn parameters() -> impl Iterator<Item = f64> {
        (0..=STEPS).map(|i| f64::from(i) / f64::from(STEPS))
    }

    proptest! {
        #[test]
        fn segments_come_no_closer_anywhere(a in point(), b in point(), c in point(), d in point()) {
            let pair = segment_segment([&a, &b], [&c, &d]);
            let (p, q) = (a + (b - a) * pair.s, c + (d - c) * pair.t);
            prop_assert!(((p - q).norm() - pair.distance).abs() < 1e-12);
            for s in parameters() {
                for t in parameters() {
                    let sample = (a + (b - a) * s - (c + (d - c) * t)).norm();
                    prop_assert!(sample >= pair.distance - 1e-7, "{sample} < {}", pair.distance);
                }
            }
        }

        #[test]
        fn triangle_comes_no_closer_anywhere(p in point(), a in point(), b in point(), c in point()) {
            let (q, distance) = point_triangle(&p, [&a, &b, &c]);
            prop_assert!(((p - q).norm() - distance).abs() < 1e-12);
            for s in parameters() {
                for t in parameters().filter(|t| s + t <= 1.0) {
                    let sample = (p - (a + (b - a) * s + (c - a) * t)).norm();
                    prop_assert!(sample >= distance - 1e-7, "{sample} < {distance}");
                }
            }
        }

        #[test]
        fn tubes_come_no_closer_anywhere(a in tube(), b in tube()) {
            let pair = tube_tube(&a, &b);
            let gap = |s: f64, t: f64| (a.point(s) - b.point(t)).norm() - a.radius(s) - b.radius(t);
            prop_assert!((gap(pair.s, pair.t) - pair.gap).abs() < 1e-12);
            for s in parameters() {
                for t in parameters() {
                    prop_assert!(gap(s, t) >= pair.gap - 1e-6, "{} < {}", gap(s, t), pair.gap);
                }
            }
        }
    }

    #[test]
    fn crossing_parallel_and_degenerate_segments() {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let crossing =
            segment_segment([&p(-1.0, 0.0, 0.0), &p(1.0, 0.0, 0.0)], [&p(0.0, -1.0, 2.0), &p(0.0, 1.0, 2.0)]);
        assert_eq!((crossing.s, crossing.t, crossing.distance), (0.5, 0.5, 2.0));
        let parallel = segment_segment([&p(0.0, 0.0, 0.0), &p(1.0, 0.0, 0.0)], [&p(0.5, 3.0, 0.0), &p(9.0, 3.0, 0.0)]);
        assert!((parallel.distance - 3.0).abs() < 1e-15);
        let point = segment_segment([&p(1.0, 1.0, 1.0), &p(1.0, 1.0, 1.0)], [&p(1.0, 1.0, 1.0), &p(1.0, 1.0, 1.0)]);
        assert!(point.distance < 1e-300);
    }
}
