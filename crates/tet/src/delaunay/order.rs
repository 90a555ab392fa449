//! Insertion order: random rounds, each along the Hilbert curve (Amenta, Choi, Rote, 'Incremental constructions con
//! BRIO', 2003).

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::hilbert::{Grid, hilbert_key};

/// Binary logarithm of the growth factor between rounds.
const GROWTH: u32 = 3;

/// Point indices, round by round, each round along the Hilbert curve. The first round has a few dozen points.
pub(super) fn brio(points: &[Point3]) -> Vec<u32> {
    let rounds = Rounds::of(points.len());
    along_curve(points, |i| rounds.of_point(i))
}

/// Point indices along the Hilbert curve.
pub(super) fn hilbert(points: &[Point3]) -> Vec<u32> {
    along_curve(points, |_| 0)
}

/// As [`brio`], for a number of points already sorted along the Hilbert curve.
pub(super) fn brio_of_sorted(count: usize) -> Vec<u32> {
    let rounds = Rounds::of(count);
    let mut first = vec![0; rounds.last as usize + 2];
    for i in 0..count as u64 {
        first[rounds.of_point(i) as usize + 1] += 1;
    }
    for k in 1..first.len() {
        first[k] += first[k - 1];
    }
    let mut order = vec![0; count];
    for i in 0..count as u64 {
        let next: &mut usize = &mut first[rounds.of_point(i) as usize];
        order[*next] = i as u32;
        *next += 1;
    }
    order
}

/// Assignment of points to rounds.
struct Rounds {
    last: u32,
}

impl Rounds {
    fn of(count: usize) -> Self {
        Self { last: count.max(2).ilog2().saturating_sub(5) / GROWTH }
    }

    #[inline]
    fn of_point(&self, i: u64) -> u32 {
        self.last - (hash(i).trailing_zeros() / GROWTH).min(self.last)
    }
}

/// Indices sorted by round, then along the Hilbert curve.
fn along_curve(points: &[Point3], round: impl Fn(u64) -> u32) -> Vec<u32> {
    // Round, key and index share one word: the fewer points, the finer the grid.
    let index_bits = usize::BITS - points.len().leading_zeros();
    let key_bits = ((64 - 5 - index_bits) / 3).min(20);
    let grid = Grid::new(points.iter().copied(), key_bits);
    let mask = (1u64 << index_bits) - 1;
    let word = |(i, p)| {
        let key = hilbert_key(grid.cell(p), key_bits);
        (u64::from(round(i)) << (3 * key_bits + index_bits)) | (key << index_bits) | i
    };
    let mut order: Vec<u64> = (0..).zip(points).map(word).collect();
    order.sort_unstable();
    order.into_iter().map(|word| (word & mask) as u32).collect()
}

/// Hash of an integer (splitmix64).
pub(crate) fn hash(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
