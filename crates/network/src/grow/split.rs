//! Division of a vessel's terminals between its two branches. The resulting vessel count of each Strahler order matches
//! a rat kidney.
//!
//! The order of a vessel depends only on its number n of terminals: it is k for `LEAST[k]` ≤ n < `LEAST[k + 1]`. A
//! vessel of order k with n < 2·`LEAST[k]` divides into two of order k − 1. With more terminals, one branch has order k
//! − 1 and the other continues. The thresholds were fitted by simulation to the published mean counts in a tree of
//! 29,566 terminals.

use super::random::{Random, Stream};

/// Minimum number of terminals per order. Orders beyond the table grow by the factor `RATIO`.
const LEAST: [u32; 11] = [1, 2, 4, 9, 31, 65, 151, 446, 1878, 6330, 13_487];

/// Mean ratio between vessel counts of consecutive orders: the tenth root of 29,566.
const RATIO: f64 = 2.8;

/// Minimum number of terminals of an order.
fn least(order: usize) -> f64 {
    LEAST.get(order).map_or_else(
        || f64::from(LEAST[LEAST.len() - 1]) * RATIO.powi((order + 1 - LEAST.len()) as i32),
        |&n| f64::from(n),
    )
}

/// Strahler order of a vessel with this number of terminals; a terminal has order 0.
pub fn order(terminals: u32) -> usize {
    let mut order = 0;
    while least(order + 1) <= f64::from(terminals) {
        order += 1;
    }
    order
}

/// Number of terminals of the lesser branch of a vessel with `terminals` ≥ 2; `index` numbers the vessel.
pub fn lesser(terminals: u32, random: Random, index: u64) -> u32 {
    let k = order(terminals);
    let n = f64::from(terminals);
    // Only the middle half, so that vessel counts vary little between seeds.
    let chance = 0.25 + 0.5 * random.unit(Stream::Split, index);
    let (here, below) = (least(k), least(k.saturating_sub(1)));
    let share = if n < 2.0 * here {
        // Both branches below `here` and at least `below`, around the half.
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
