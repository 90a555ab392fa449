//! Common terms of orientation, ratio and angles of a tetrahedron, or of several at a time. Results of both are equal bit for
//! bit.

use crate::geometry::Point3;
use crate::geometry::predicates::{ORIENT3D_BOUND, orient3d};
use nalgebra::{SimdBool, SimdRealField, Vector3};
use simba::simd::WideF64x4;

/// Number of tetrahedra that are measured at a time.
pub(super) const LANES: usize = 4;

/// The edges from the first vertex of a tetrahedron, and their products.
pub(crate) struct Spokes<T = f64> {
    pub(super) edges: [Vector3<T>; 3],
    /// Of the second and third edge, the third and first, the first and second.
    pub(super) crossed: [Vector3<T>; 3],
    /// As [`volume6`](super::volume6).
    pub(crate) volume: T,
}

/// Corners of four tetrahedra, by corner.
#[inline]
pub(super) fn four_corners(four: &[[&Point3; 4]; LANES]) -> [Vector3<WideF64x4>; 4] {
    std::array::from_fn(|corner| {
        let axis = |i: usize| WideF64x4::from(four.map(|corners| corners[corner][i]));
        Vector3::new(axis(0), axis(1), axis(2))
    })
}

impl Spokes {
    #[inline]
    pub(crate) fn new(corners: [&Point3; 4]) -> Self {
        Self::of(&corners.map(|p| p.coords))
    }

    /// True if the tetrahedron of these corners is positive by the exact predicate.
    #[inline]
    pub(crate) fn is_positive(&self, [a, b, c, d]: [&Point3; 4]) -> bool {
        self.are_surely_positive() || orient3d(a, b, c, d) > 0.0
    }
}

impl Spokes<WideF64x4> {
    #[inline]
    pub(super) fn of_four(corners: &[Vector3<WideF64x4>; 4]) -> Self {
        Self::of(corners)
    }
}

impl<T: SimdRealField<Element = f64> + Copy> Spokes<T> {
    #[inline]
    fn of([a, b, c, d]: &[Vector3<T>; 4]) -> Self {
        let (u, v, w) = (b - a, c - a, d - a);
        let (vw, wu, uv) = (v.cross(&w), w.cross(&u), u.cross(&v));
        Self { edges: [u, v, w], crossed: [vw, wu, uv], volume: uv.dot(&w) }
    }

    /// True where the volume exceeds the bound of its rounding error.
    #[inline]
    pub(super) fn are_surely_positive(&self) -> T::SimdBool {
        let [u, v, w] = self.edges.each_ref();
        let largest = |i: usize| u[i].simd_abs().simd_max(v[i].simd_abs()).simd_max(w[i].simd_abs());
        self.volume.simd_gt(T::splat(ORIENT3D_BOUND) * largest(0) * largest(1) * largest(2))
    }

    /// True only if the radius ratio is at least `least`. The sum of four areas is at most twice the root of the sum of
    /// their squares.
    #[inline]
    pub(super) fn has_ratio(&self, least: f64) -> T::SimdBool {
        let ([u, v, w], [vw, wu, uv]) = (&self.edges, &self.crossed);
        let squares = vw.norm_squared() + wu.norm_squared() + uv.norm_squared() + (vw + wu + uv).norm_squared();
        let center = vw * u.norm_squared() + wu * v.norm_squared() + uv * w.norm_squared();
        let (square, bound) = (self.volume * self.volume, T::splat(2.0 * least * (1.0 + 1e-12)));
        let (square, other) = (T::splat(36.0) * square * square, bound * bound * squares * center.norm_squared());
        self.volume.simd_gt(T::splat(0.0))
            & other.simd_ge(T::splat(f64::MIN_POSITIVE))
            & square.simd_ge(other)
            & square.simd_lt(T::splat(f64::INFINITY))
    }

    #[inline]
    pub(super) fn radius_ratio(&self) -> T {
        let ([u, v, w], [vw, wu, uv]) = (&self.edges, &self.crossed);
        let doubled_area = vw.norm() + wu.norm() + uv.norm() + (vw + wu + uv).norm();
        let center = vw * u.norm_squared() + wu * v.norm_squared() + uv * w.norm_squared();
        // r = |V6| / ΣA2 and R = |center| / (2 |V6|), where V6 is six volumes and A2 two areas.
        let product = doubled_area * center.norm();
        let zero = T::splat(0.0);
        let ratio = || T::splat(6.0) * self.volume * self.volume.simd_abs() / product;
        product.simd_gt(zero).if_else(ratio, || zero)
    }

    /// All lanes true.
    #[inline]
    pub(super) fn truth() -> T::SimdBool {
        T::splat(0.0).simd_eq(T::splat(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SimdValue;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn four_tetrahedra_have_the_bits_of_each(
            x in prop::array::uniform32(-1.0..1.0_f64), y in prop::array::uniform16(-1.0..1.0_f64), unit in -60..60_i32,
        ) {
            let x: Vec<f64> = x.into_iter().chain(y).map(|x| x * 10.0_f64.powi(unit)).collect();
            let points: Vec<Point3> = x.chunks(3).map(|p| Point3::new(p[0], p[1], p[2])).collect();
            let four: [[&Point3; 4]; LANES] = std::array::from_fn(|i| std::array::from_fn(|k| &points[4 * i + k]));
            let all = Spokes::of_four(&four_corners(&four));
            for (lane, corners) in four.into_iter().enumerate() {
                let one = Spokes::new(corners);
                prop_assert_eq!(all.volume.extract(lane).to_bits(), one.volume.to_bits());
                prop_assert_eq!(all.radius_ratio().extract(lane).to_bits(), one.radius_ratio().to_bits());
                prop_assert_eq!(all.has_ratio(0.3).extract(lane), one.has_ratio(0.3));
                prop_assert_eq!(all.are_surely_positive().extract(lane), one.are_surely_positive());
            }
        }
    }
}
