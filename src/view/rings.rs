//! Rings: boundary loops of a block's wall, shared with its neighbours.
//!
//! Both blocks at a ring keep identical points of it, because the selection depends on the ring alone.

use rustc_hash::FxHashMap;

/// Rings of a surface with counter-clockwise triangles, as point sequences. Rings that touch in a point may be merged.
pub fn rings(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let edges = open_sides(triangles);
    let mut next: FxHashMap<u32, u32> = FxHashMap::default();
    for &[a, b] in &edges {
        next.entry(a).or_insert(b);
    }
    let mut rings = Vec::new();
    for [start, _] in edges {
        let mut ring = Vec::new();
        let mut at = start;
        while let Some(following) = next.remove(&at) {
            ring.push(at);
            at = following;
        }
        if ring.len() > 2 {
            rings.push(ring);
        }
    }
    rings
}

/// Half-edges without an opposite one, in ascending order.
fn open_sides(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    // Edges with their orientation balance: upward minus downward half-edges.
    let mut sides: Vec<([u32; 2], i8)> = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        sides.extend([[a, b], [b, c], [c, a]].map(|[a, b]| if a < b { ([a, b], 1) } else { ([b, a], -1) }));
    }
    sides.sort_unstable();
    let mut open = Vec::new();
    for same in sides.chunk_by(|x, y| x.0 == y.0) {
        let [a, b] = same[0].0;
        match same.iter().map(|side| i64::from(side.1)).sum::<i64>() {
            0 => {}
            up if up > 0 => open.push([a, b]),
            _ => open.push([b, a]),
        }
    }
    open.sort_unstable();
    open
}

/// Selects `keep` evenly spaced points of a ring and maps each ring point to a selected one. Counting starts at the
/// point with the lowest global number, towards its lower-numbered neighbour.
pub fn thinned(ring: &[u32], keep: usize, number: impl Fn(u32) -> u32) -> Vec<(u32, u32)> {
    let count = ring.len();
    if keep >= count {
        return ring.iter().map(|&v| (v, v)).collect();
    }
    let first = (0..count).min_by_key(|&i| number(ring[i])).unwrap_or(0);
    let forwards = number(ring[(first + 1) % count]) < number(ring[(first + count - 1) % count]);
    let at = |i: usize| if forwards { ring[(first + i) % count] } else { ring[(first + 2 * count - i) % count] };
    let kept = |i: usize| i * count / keep;
    let way = |a: usize, b: usize| a.abs_diff(b).min(count - a.abs_diff(b));
    // Each point is mapped to the nearest selected one.
    let stands = |i: usize| (0..keep).map(kept).min_by_key(|&place| way(i, place)).unwrap_or(0);
    (0..count).map(|i| (at(i), at(stands(i)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn a_strip_has_two_rings() {
        let n = 7;
        let quad = |i: u32| [[i, (i + 1) % n, n + i], [(i + 1) % n, n + (i + 1) % n, n + i]];
        let strip: Vec<[u32; 3]> = (0..n).flat_map(quad).collect();
        let found: Vec<BTreeSet<u32>> = rings(&strip).into_iter().map(|r| r.into_iter().collect()).collect();
        assert_eq!(found, [(0..n).collect(), (n..2 * n).collect()]);
    }

    #[test]
    fn both_sides_keep_the_same() {
        let ring: Vec<u32> = vec![40, 12, 90, 7, 33, 51, 28, 64, 19, 77, 5];
        for keep in 3..12 {
            let mut other: Vec<u32> = ring.iter().rev().copied().collect();
            other.rotate_left(4);
            let of = |ring: &[u32]| thinned(ring, keep, |v| v).into_iter().collect::<BTreeSet<_>>();
            assert_eq!(of(&ring), of(&other));
            let kept: BTreeSet<u32> = of(&ring).into_iter().map(|(_, to)| to).collect();
            assert_eq!(kept.len(), keep.min(ring.len()));
            assert!(of(&ring).iter().all(|(from, to)| !kept.contains(from) || from == to));
        }
    }
}
