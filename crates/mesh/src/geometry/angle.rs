//! Angles.

/// Normalizes an angle to (−π, π].
#[inline]
pub fn turn(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let a = angle.rem_euclid(TAU);
    if a > PI { a - TAU } else { a }
}
