//! Checksums that link data read later to the certified data.

use crate::geometry::Point3;

/// Checksum of a triangle from those of its corners, invariant under rotation but not reversal. Sums of checksums do not
/// depend on order.
pub(super) fn face_sum([a, b, c]: [u64; 3]) -> u64 {
    let turned = |x: u64, y: u64, z: u64| mix(x ^ mix(y ^ mix(z).rotate_left(17)).rotate_left(29));
    turned(a, b, c).wrapping_add(turned(b, c, a)).wrapping_add(turned(c, a, b))
}

/// Checksum of a point.
pub(super) fn point_sum(p: &Point3) -> u64 {
    p.iter().fold(0x2545_f491_4f6c_dd1d, |sum: u64, x| mix(sum ^ x.to_bits()))
}

/// Finalizer of `SplitMix64`.
fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Checksum of a triangle of sorted vertices.
pub(super) fn id_sum(vertices: [u32; 3]) -> u64 {
    id_sums(vertices)[0]
}

/// Two independent checksums of a triangle of sorted vertices.
pub(in crate::check) fn id_sums(vertices: [u32; 3]) -> [u64; 2] {
    [0x2545_f491_4f6c_dd1d, 0x9fb2_1c65_1e98_df25]
        .map(|seed| vertices.into_iter().fold(seed, |sum, v| mix(sum ^ u64::from(v))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First outputs of the published generator with the seeds 0 and 1234567.
    #[test]
    fn the_finalizer_is_that_of_splitmix() {
        assert_eq!(mix(0), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix(1_234_567), 6_457_827_717_110_365_317);
    }

    /// Stored certificates contain these sums, so they must not change. The values are of a program in another language.
    #[test]
    fn checksums_are_those_of_stored_certificates() {
        assert_eq!([face_sum([1, 2, 3]), face_sum([1, 3, 2])], [0x5872_4d09_91ab_6fb8, 0xdf8e_3c31_186a_addc]);
        assert_eq!(face_sum([3, 1, 2]), face_sum([1, 2, 3]));
        assert_eq!(point_sum(&Point3::new(0.5, -2.0, 3.25)), 0x4d8d_386f_6b0e_6523);
        assert_eq!(id_sums([3, 5, 1000]), [0x33e3_a416_c554_228a, 0x9ada_9134_bcb8_9426]);
        assert_eq!(id_sum([3, 5, 1000]), 0x33e3_a416_c554_228a);
    }
}
