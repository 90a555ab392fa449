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
