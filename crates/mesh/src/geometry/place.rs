//! Places as keys of maps.

use super::Point3;

/// The bits of a point's coordinates: equal for points at the same place only, −0 being 0.
pub fn place_key(p: &Point3) -> [u64; 3] {
    [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits())
}
