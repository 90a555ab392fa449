//! Rational arithmetic as an oracle for the predicates' tests, and points that are degenerate or nearly so.

use super::Point3;
use num_rational::BigRational;
use proptest::prelude::*;

pub(super) fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).expect("finite")
}

/// Determinant by expansion along the first row.
pub(super) fn det(m: &[Vec<BigRational>]) -> BigRational {
    if m.len() == 1 {
        return m[0][0].clone();
    }
    let mut sum = exact(0.0);
    for (k, head) in m[0].iter().enumerate() {
        let minor: Vec<Vec<BigRational>> = m[1..]
            .iter()
            .map(|r| r.iter().enumerate().filter(|&(j, _)| j != k).map(|(_, x)| x.clone()).collect())
            .collect();
        let term = head * det(&minor);
        sum = if k % 2 == 0 { sum + term } else { sum - term };
    }
    sum
}

pub(super) fn sign(x: &BigRational) -> i32 {
    let zero = exact(0.0);
    i32::from(*x > zero) - i32::from(*x < zero)
}

/// Coordinates on a coarse grid, on it but for a few ulps, or anywhere.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        (-4i32..4).prop_map(f64::from),
        (-4i32..4, -3i64..3).prop_map(|(g, ulps)| f64::from(g) + ulps as f64 * f64::EPSILON * 4.0),
        (-3i32..3).prop_map(|g| f64::from(g) * 0.1),
        -1.0..1.0f64,
    ]
}

pub(super) fn point(scale: f64) -> impl Strategy<Value = Point3> {
    (coordinate(), coordinate(), coordinate()).prop_map(move |(x, y, z)| Point3::new(x * scale, y * scale, z * scale))
}
