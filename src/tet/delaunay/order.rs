//! Order of insertion: random rounds, each along the Hilbert curve (Amenta, Choi, Rote, 'Incremental constructions con
//! BRIO', 2003).

use crate::geometry::Point3;
use crate::geometry::hilbert::{Grid, hilbert_key};

/// Logarithm of how many times as many points a round has as the one before.
const GROWTH: u32 = 3;

/// The points' ids, round by round, each round along the Hilbert curve. The first round has a few dozen points.
#[inline(never)]
pub(super) fn brio(points: &[Point3]) -> Vec<u32> {
    let n = points.len();
    let index_bits = usize::BITS - n.leading_zeros();
    let rounds = (n.max(2).ilog2().saturating_sub(5)) / GROWTH;
    // Round, key and index in one word: the fewer points, the finer the grid.
    let key_bits = ((64 - 5 - index_bits) / 3).min(20);
    let grid = Grid::new(points, key_bits);
    let mask = (1u64 << index_bits) - 1;
    let mut order: Vec<u64> = (0..)
        .zip(points)
        .map(|(i, p)| {
            let coins = (hash(i).trailing_zeros() / GROWTH).min(rounds);
            let key = hilbert_key(grid.cell(p), key_bits);
            (u64::from(rounds - coins) << (3 * key_bits + index_bits)) | (key << index_bits) | i
        })
        .collect();
    order.sort_unstable();
    order.into_iter().map(|word| (word & mask) as u32).collect()
}

/// A well-mixed function of an integer (splitmix64).
pub(in crate::tet) fn hash(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
