//! Proof, for most vertices of a smooth surface, that the adjacent triangles intersect only where connected.
//!
//! Suppose a linear map to the plane gives all triangles of a vertex one orientation, and together one turn around it.
//! Then the images do not overlap, nor do the triangles. Signs are those of the exact values; doubtful signs prove
//! nothing.

use super::{Point3, Vec3};

/// Relative error bound of a cross product of images, and an absolute bound against underflow. The margin is wide:
/// errors are below 30 units of 1.1e-16.
const RELATIVE: f64 = 1e-13;
const ABSOLUTE: f64 = 1e-280;

/// Maximum triangles at one vertex; larger fans are left to other tests.
const MOST: usize = 16;

/// True for vertices whose triangles provably share only the vertex and the edges between consecutive ones. None of
/// these triangles is degenerate.
pub(super) fn proved_fans(points: &[Point3], triangles: &[[u32; 3]]) -> Vec<bool> {
    let mut offsets = vec![0_u32; points.len() + 1];
    for &v in triangles.iter().flatten() {
        offsets[v as usize + 1] += 1;
    }
    for i in 0..points.len() {
        offsets[i + 1] += offsets[i];
    }
    let mut around = vec![[0_u32; 2]; 3 * triangles.len()];
    for &[a, b, c] in triangles {
        for (v, ends) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            let slot = &mut offsets[v as usize];
            around[*slot as usize] = ends;
            *slot += 1;
        }
    }
    // Filling moved each offset to the start of the next vertex.
    let mut start = 0;
    let proved = |(v, &end): (usize, &u32)| {
        let fan = &around[start..end as usize];
        start = end as usize;
        is_closed(fan) && turns_once(points, &points[v], fan)
    };
    offsets[..points.len()].iter().enumerate().map(proved).collect()
}

/// True if each end of a triangle is the start of exactly one other, and vice versa.
fn is_closed(fan: &[[u32; 2]]) -> bool {
    if fan.len() < 3 || fan.len() > MOST {
        return false;
    }
    let once =
        |from: usize, to: usize| fan.iter().all(|t| fan.iter().map(|u| u32::from(t[from] == u[to])).sum::<u32>() == 1);
    once(1, 0) && once(0, 1)
}

fn turns_once(points: &[Point3], p: &Point3, fan: &[[u32; 2]]) -> bool {
    let spokes = |t: &[u32; 2]| t.map(|v| points[v as usize] - p);
    let sum: Vec3 = fan.iter().map(spokes).map(|[a, b]| a.cross(&b)).sum();
    let Some(normal) = sum.try_normalize(0.0) else { return false };
    let mut axis = Vec3::zeros();
    axis[normal.iamin()] = 1.0;
    // Any two vectors are valid; these make the images as large as the triangles.
    let e = normal.cross(&axis);
    let f = normal.cross(&e);
    let mut turns = 0;
    for t in fan {
        let image = |d: Vec3| (d.dot(&e), d.dot(&f), d.x.abs() + d.y.abs() + d.z.abs());
        let [(ax, ay, a), (bx, by, b)] = spokes(t).map(image);
        let cross = ax * by - ay * bx;
        // Formulated so that NaN fails.
        let certain = cross > RELATIVE * (a * b) + ABSOLUTE
            && cross < f64::MAX
            && ay.abs() > RELATIVE * a + ABSOLUTE
            && by.abs() > RELATIVE * b + ABSOLUTE;
        if !certain {
            return false;
        }
        turns += u32::from(ay < 0.0 && by > 0.0);
    }
    turns == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Contact, classify};
    use proptest::prelude::*;

    proptest! {
        /// Proofs agree with the exact test of every pair of triangles.
        #[test]
        fn proved_fans_have_no_improper_contact(rim in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -0.3..0.3_f64), 3..9)) {
            let mut points = vec![Point3::origin()];
            points.extend(rim.iter().map(|&(x, y, z)| Point3::new(x, y, z)));
            let n = rim.len() as u32;
            let triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
            if proved_fans(&points, &triangles)[0] {
                for i in 0..triangles.len() {
                    for j in i + 1..triangles.len() {
                        prop_assert_eq!(classify(&points, triangles[i], triangles[j]), Contact::Neighbours);
                    }
                }
            }
        }
    }

    fn star(turns: f64, n: u32) -> (Vec<Point3>, Vec<[u32; 3]>) {
        let mut points = vec![Point3::origin()];
        points.extend((0..n).map(|i| {
            let angle = 0.1 + turns * std::f64::consts::TAU * f64::from(i) / f64::from(n);
            Point3::new(angle.cos(), angle.sin(), 0.1 * f64::from(i % 2))
        }));
        (points, (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect())
    }

    #[test]
    fn a_fan_that_turns_once_is_proved_and_one_that_turns_twice_or_is_open_is_not() {
        let (points, triangles) = star(1.0, 6);
        assert!(proved_fans(&points, &triangles)[0]);
        assert!(!proved_fans(&points, &triangles[..5])[0]);
        let (points, triangles) = star(2.0, 12);
        assert!(!proved_fans(&points, &triangles)[0]);
    }
}
