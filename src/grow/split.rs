//! How the terminals of a vessel are shared between its two branches, so that each Strahler order has as many vessels as
//! it has in a rat's kidney.
//!
//! The order of a vessel follows from the number n of its terminals alone: it is k when `LEAST[k]` ≤ n < `LEAST[k + 1]`.
//! A vessel of order k with n < 2·`LEAST[k]` forks into two of order k − 1; with more terminals it gives off one of order
//! k − 1 and goes on. The thresholds are those for which the mean numbers of vessels in a tree of 29,566 terminals are
//! closest to the published ones (fitted by simulation).

use super::random::{Random, Stream};

/// Least number of terminals of each order; from the last on, each order has `RATIO` times as many as the one before.
const LEAST: [u32; 11] = [1, 2, 4, 9, 31, 65, 151, 446, 1878, 6330, 13_487];

/// Mean ratio of the numbers of vessels of neighbouring orders: the tenth root of 29,566.
const RATIO: f64 = 2.8;

/// The least number of terminals of an order.
fn least(order: usize) -> f64 {
    LEAST.get(order).map_or_else(
        || f64::from(LEAST[LEAST.len() - 1]) * RATIO.powi((order + 1 - LEAST.len()) as i32),
        |&n| f64::from(n),
    )
}

/// The Strahler order of a vessel with so many terminals; terminals have 0.
pub fn order(terminals: u32) -> usize {
    let mut order = 0;
    while least(order + 1) <= f64::from(terminals) {
        order += 1;
    }
    order
}

/// Terminals of the lesser branch of a vessel with `terminals` ≥ 2; `index` numbers the vessel.
pub fn lesser(terminals: u32, random: Random, index: u64) -> u32 {
    let k = order(terminals);
    let n = f64::from(terminals);
    // The middle half: numbers of vessels vary little from seed to seed.
    let chance = 0.25 + 0.5 * random.unit(Stream::Split, index);
    let (here, below) = (least(k), least(k.saturating_sub(1)));
    let share = if n < 2.0 * here {
        // Both below `here`, neither below `below`; around the half.
        let low = below.max(n - here + 1.0);
        let high = (here - 1.0).min(n - below);
        low + (high - low + 1.0) * chance
    } else {
        below + (here - below) * chance
    };
    let share = (share as u32).clamp(1, terminals - 1);
    share.min(terminals - share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_strahlers() {
        let random = Random::new(3);
        for n in (2..3000).chain([29_566, 100_000, 1_000_000, 50_000_000]) {
            for index in 0..20 {
                let a = lesser(n, random, index);
                assert!(a >= 1 && 2 * a <= n);
                let (low, high) = (order(a), order(n - a));
                let strahler = if low == high { low + 1 } else { high };
                assert_eq!(strahler, order(n), "{n} = {a} + {}", n - a);
            }
        }
    }
}
