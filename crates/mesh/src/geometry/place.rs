//! Coordinates as hash keys.

use super::Point3;

/// Bits of a point's coordinates, equal only for equal points, with −0 treated as 0.
#[inline]
pub fn place_key(p: &Point3) -> [u64; 3] {
    [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits())
}
