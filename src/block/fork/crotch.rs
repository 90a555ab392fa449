//! Crotches of a fork: where the walls of two vessels meet, in the plane of their axes.
//!
//! At small angles the crotch is far from the node, and a few degrees move it by a good part of a radius. The mean of the
//! vessels' own movements does not follow it, so the points near it have a displacement of their own.

use super::shape::{Fork, LIMBS, Limb};
use crate::surface::Field;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Minimum cosine of an angle with a crotch.
const LEAST_COSINE: f64 = -0.8;
/// Newton steps along the ray from the node, and the largest deviation from the wall after them.
const STEPS: usize = 6;
const OFF_WALL: f64 = 2e-3;
/// Reach of a displacement relative to the distance of its crotch from the node.
const REACH: f64 = 1.0;
/// Distance from a disc, in its radii, over which displacements decrease to zero.
const NEAR_DISC: f64 = 1.0 / 3.0;

/// Crotch between each two limbs, at the index of the third; that of a bend is the last.
pub type Crotches = [Option<Point3>; LIMBS];

/// Displacements of the crotches of a fork.
pub struct Shifts<'a> {
    fork: &'a Fork,
    /// Place of each, and the displacement.
    shifts: Vec<[Vec3; 2]>,
}

/// Returns the crotches of a fork; `None` where the angle is large.
pub fn crotches(fork: &Fork, field: &mut Field) -> Crotches {
    std::array::from_fn(|i| {
        let [a, b] = [1, 2].map(|k| fork.limbs.get((i + k) % LIMBS));
        let (a, b) = (a?, b?);
        if a.axis.dot(&b.axis) < LEAST_COSINE {
            return None;
        }
        // Where the walls of two cylinders meet.
        let corner = (a.axis * b.radii[0] + b.axis * a.radii[0]) / a.axis.cross(&b.axis).norm();
        let mut distance = corner.norm();
        let direction = corner / distance;
        let nearest = direction.dot(&a.axis).min(direction.dot(&b.axis));
        let is_beside = fork.limbs.get(i).is_some_and(|other| direction.dot(&other.axis) >= nearest);
        if !distance.is_finite() || is_beside {
            return None;
        }
        for _ in 0..=STEPS {
            let p = fork.node + direction * distance;
            let (value, gradient) = field.value_and_gradient(&p);
            if (value - 1.0).abs() <= OFF_WALL {
                // A step may pass the node, and end at the wall behind it.
                return (distance > 0.0).then_some(p);
            }
            distance -= (value - 1.0) / gradient.dot(&direction);
        }
        None
    })
}

impl<'a> Shifts<'a> {
    /// Displacements of the crotches of `fork` to those of its image. `moved`: where a point is without them.
    pub fn new(fork: &'a Fork, [from, to]: [Crotches; 2], moved: impl Fn(&Point3) -> Point3) -> Self {
        let pairs = from.into_iter().zip(to).filter_map(|(from, to)| Some((from?, to?)));
        Self { fork, shifts: pairs.map(|(from, to)| [from - fork.node, to - moved(&from)]).collect() }
    }

    /// Displacement of a point: full at a crotch, and zero at the discs.
    pub fn at(&self, p: &Point3) -> Vec3 {
        let w = p - self.fork.node;
        let by = |[at, by]: &[Vec3; 2]| {
            let share = (w - at).norm_squared() / (REACH * REACH * at.norm_squared());
            by * (1.0 - share).max(0.0).powi(2)
        };
        let sum: Vec3 = self.shifts.iter().map(by).sum();
        let away = |limb: &Limb| (from_disc(&w, limb) / NEAR_DISC).min(1.0);
        if sum == Vec3::zeros() { sum } else { sum * self.fork.limbs.iter().map(away).product::<f64>() }
    }
}

/// Distance of an offset from the node to the disc of a limb, in its radii.
fn from_disc(w: &Vec3, limb: &Limb) -> f64 {
    let w = w - limb.axis * limb.length;
    let along = w.dot(&limb.axis);
    let beside = ((w - limb.axis * along).norm() - limb.radii[1]).max(0.0);
    (along * along + beside * beside).sqrt() / limb.radii[1]
}

#[cfg(test)]
mod tests {
    use super::super::shape::TIP;
    use super::*;
    use anastomesh_mesh::geometry::Tube;
    use anastomesh_skeleton::resolution::KAPPA;

    /// Planar fork of vessels of radius 1 in three directions, in degrees.
    fn fork(degrees: [f64; 3]) -> Fork {
        let limb = |degrees: f64| {
            let (y, x) = libm::sincos(degrees.to_radians());
            let (axis, across) = (Vec3::new(x, y, 0.0), Vec3::new(-y, x, 0.0));
            Limb { axis, frame: [across, Vec3::z()], length: 5.0, radii: [1.0; 2], side: TIP, end: 0 }
        };
        Fork { node: Point3::origin(), radius: 1.0, limbs: degrees.map(limb).to_vec() }
    }

    fn crotches_of(fork: &Fork) -> Crotches {
        let tube = |limb: &Limb| Tube { a: fork.node, b: fork.node + limb.axis * 6.0, ra: 1.0, rb: 1.0 };
        crotches(fork, &mut Field::new(&fork.limbs.iter().map(tube).collect::<Vec<_>>(), KAPPA).expect("a field"))
    }

    #[test]
    fn a_crotch_is_between_the_limbs_and_on_the_wall() {
        // At 60 degrees two cylinders of radius 1 meet 2 from the node. The wall is rounded, so it is further away.
        let [crotch, left, right] = crotches_of(&fork([180.0, -30.0, 30.0]));
        let crotch = crotch.expect("a crotch");
        assert!(crotch.x > 2.0 && crotch.x < 2.4 && crotch.y.abs() < 1e-9 && crotch.z.abs() < 1e-9, "{crotch}");
        assert_eq!([left, right], [None; 2], "angles of 150 degrees");
        // The ray between the outer two is that of the third.
        let [crotch, ..] = crotches_of(&fork([0.0, -60.0, 60.0]));
        assert_eq!(crotch, None);
    }

    #[test]
    fn displacements_move_crotches_and_leave_discs() {
        let (narrow, wide) = (fork([180.0, -25.0, 25.0]), fork([180.0, -30.0, 30.0]));
        let [from, to] = [crotches_of(&narrow), crotches_of(&wide)];
        let shifts = Shifts::new(&narrow, [from, to], |p| *p);
        let crotch = from[0].expect("a crotch");
        assert!((crotch + shifts.at(&crotch) - to[0].expect("a crotch")).norm() < 1e-12);
        for limb in &narrow.limbs {
            assert_eq!(shifts.at(&(narrow.node + limb.axis * limb.length + limb.frame[0] * 0.9)), Vec3::zeros());
        }
    }
}
