//! Rational arithmetic as an oracle for the predicates' tests.

use num_rational::BigRational;

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
