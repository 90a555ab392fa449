//! Proof that a closed surface is star-shaped, and so without self-intersection.
//!
//! Let the faces be a cycle: as many run along an edge in one direction as in the other. Seen from a centre, let all of them
//! turn the same way. Then the number of faces in a direction is the same for all directions outside of edges. If it is
//! 1, the faces meet only at common edges and vertices. Each edge has two faces, and the faces of each vertex are one fan.
//! The surface is a sphere, and the centre is in its kernel. All signs are exact.

use super::predicates::{in_exact_range, orient3d};
use super::{Point3, Vec3};

/// Cosine beyond which a vertex is certainly on the other side of the centre. The margin covers roundoff.
const BEHIND: f64 = -1e-6;

/// True if a cycle of faces is star-shaped around the centre. False says nothing.
pub(crate) fn is_star_shaped(points: &[Point3], faces: &[[u32; 3]], centre: &Point3) -> bool {
    let corners = |face: &[u32; 3]| face.map(|v| &points[v as usize]);
    let faces_out = |face: &[u32; 3]| {
        let [a, b, c] = corners(face);
        orient3d(centre, a, b, c) > 0.0
    };
    let Some(first) = faces.first() else { return false };
    if !centre.iter().all(|&x| in_exact_range(x)) || !faces.iter().all(faces_out) {
        return false;
    }
    let [a, b, c] = corners(first);
    let target = Point3::from((a.coords + b.coords + c.coords) / 3.0);
    target.iter().all(|&x| in_exact_range(x)) && faces_towards(&target, centre, faces.iter().map(corners)) == Some(1)
}

/// Number of faces that the ray from the centre to the target passes; `None` if it may pass an edge.
fn faces_towards<'a>(target: &Point3, centre: &Point3, faces: impl Iterator<Item = [&'a Point3; 3]>) -> Option<usize> {
    let ray: Vec3 = target - centre;
    let length = ray.norm();
    // A face in the direction of the ray has a vertex on its side.
    let is_ahead = |p: &Point3| {
        let to = p - centre;
        ray.dot(&to) >= BEHIND * length * to.norm()
    };
    let mut count = 0;
    for [a, b, c] in faces.filter(|face| face.iter().any(|p| is_ahead(p))) {
        let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| orient3d(centre, p, q, target));
        if sides.iter().all(|side| *side >= 0.0) {
            if sides.contains(&0.0) {
                return None;
            }
            count += 1;
        }
    }
    Some(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Fans, contacts_with};
    use crate::shapes::sphere_surface;
    use proptest::prelude::*;

    #[test]
    fn a_sphere_is_star_shaped_around_points_inside() {
        let ball = sphere_surface(2);
        for centre in [[0.0; 3], [0.4, 0.3, -0.2]] {
            assert!(is_star_shaped(&ball.points, &ball.triangles, &centre.into()));
        }
        for centre in [[1.0, 0.0, 0.0], [1.5, 0.0, 0.0], [1e-300, 0.0, 0.0], [f64::NAN; 3]] {
            assert!(!is_star_shaped(&ball.points, &ball.triangles, &centre.into()));
        }
    }

    /// Each direction has two faces, and all of them face outwards.
    #[test]
    fn a_double_cover_is_not() {
        let ball = sphere_surface(1);
        let count = ball.points.len() as u32;
        let outer = ball.points.iter().map(|p| p * 2.0);
        let points: Vec<Point3> = ball.points.iter().copied().chain(outer).collect();
        let apart = ball.triangles.iter().map(|t| t.map(|v| v + count));
        let both: Vec<[u32; 3]> = ball.triangles.iter().copied().chain(apart).collect();
        assert!(!is_star_shaped(&points, &both, &Point3::origin()));
        let twice = [&ball.triangles[..], &ball.triangles].concat();
        assert!(!is_star_shaped(&points, &twice, &Point3::origin()));
    }

    proptest! {
        /// The proof agrees with the test of all pairs of faces.
        #[test]
        fn star_shaped_surfaces_have_no_contacts(
            factors in prop::collection::vec(0.2..2.0_f64, 42),
            shifts in prop::collection::vec(-0.5..0.5_f64, 3 * 42),
            amount in 0.0..1.0_f64,
        ) {
            let ball = sphere_surface(1);
            let mut points = ball.points.clone();
            for (i, p) in points.iter_mut().enumerate() {
                let shift = Vec3::new(shifts[3 * i], shifts[3 * i + 1], shifts[3 * i + 2]);
                *p = Point3::from(p.coords * factors[i] + shift * amount);
            }
            let fans = Fans::of(&points, &ball.triangles);
            let contacts = contacts_with(&points, &ball.triangles, &fans, &|| false);
            if is_star_shaped(&points, &ball.triangles, &Point3::origin()) {
                prop_assert!(contacts.is_empty() && fans.is_manifold);
            }
        }
    }
}
