//! Quadric error metric (Garland and Heckbert 1997): sums of squared distances from planes.

use anastomesh_mesh::geometry::{Point3, Vec3};
use nalgebra::Matrix3;
use std::ops::AddAssign;

/// Weighted sum of squared distances from planes: vᵀAv + 2bᵀv + c relative to a centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quadric {
    a: Matrix3<f64>,
    b: Vec3,
    c: f64,
}

impl Quadric {
    /// Quadric of a plane with unit normal through a point. Points are relative to a nearby centre.
    pub fn plane(normal: &Vec3, point: &Vec3, weight: f64) -> Self {
        let d = -normal.dot(point);
        Self { a: weight * normal * normal.transpose(), b: weight * d * normal, c: weight * d * d }
    }

    /// Value at a point.
    pub fn at(&self, v: &Vec3) -> f64 {
        (v.dot(&(self.a * v)) + 2.0 * self.b.dot(v) + self.c).max(0.0)
    }

    /// Minimizer; `None` if it is not unique or ill-conditioned.
    pub fn least(&self) -> Option<Vec3> {
        let scale = self.a.trace() / 3.0;
        let sound = self.a.determinant().abs() > 1e-4 * scale.powi(3);
        if scale > 0.0 && sound { self.a.try_inverse().map(|inverse| -(inverse * self.b)) } else { None }
    }
}

impl AddAssign for Quadric {
    fn add_assign(&mut self, other: Self) {
        self.a += other.a;
        self.b += other.b;
        self.c += other.c;
    }
}

/// Point relative to a centre.
pub fn relative(point: &Point3, centre: &Point3) -> Vec3 {
    point - centre
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_where_it_is_least() {
        let mut sum = Quadric::default();
        for (normal, place) in [(Vec3::x(), 1.0), (Vec3::y(), 2.0), (Vec3::z(), -3.0)] {
            assert_eq!(sum.least(), None);
            sum += Quadric::plane(&normal, &(normal * place), 2.0);
        }
        let least = sum.least().unwrap();
        assert!((least - Vec3::new(1.0, 2.0, -3.0)).norm() < 1e-12 && sum.at(&least) < 1e-12);
        assert!((sum.at(&Vec3::new(2.0, 2.0, -3.0)) - 2.0).abs() < 1e-12);
    }
}
