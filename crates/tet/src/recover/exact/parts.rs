//! Partition of the missing edges and triangles into parts without a common edge.

use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// Edges and triangles of the surface that the complex lacks.
#[derive(Clone, Copy)]
pub(crate) struct Missing<'a> {
    pub edges: &'a [[u32; 2]],
    pub triangles: &'a [u32],
}

/// Missing edges and their missing triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Part {
    pub edges: Vec<[u32; 2]>,
    pub triangles: Vec<u32>,
}

/// Splits into parts, in the order of their first edges, followed by triangles with all edges present.
pub(super) fn parts(triangles: &[[u32; 3]], missing: Missing) -> Vec<Part> {
    let id: FxHashMap<[u32; 2], usize> = missing.edges.iter().map(|e| sorted(e[0], e[1])).zip(0..).collect();
    let sides_of = |t: u32| sides(triangles[t as usize]).into_iter().filter_map(|e| id.get(&e).copied());
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); missing.edges.len()];
    let mut parts: Vec<Part> = Vec::new();
    let mut whole: Vec<Part> = Vec::new();
    for &t in missing.triangles {
        sides_of(t).for_each(|e| around[e].push(t));
        if sides_of(t).next().is_none() {
            whole.push(Part { edges: Vec::new(), triangles: vec![t] });
        }
    }
    let mut seen = vec![false; missing.edges.len()];
    for first in 0..missing.edges.len() {
        if seen[first] {
            continue;
        }
        seen[first] = true;
        let mut part = Part::default();
        let mut queue = VecDeque::from([first]);
        while let Some(e) = queue.pop_front() {
            part.edges.push(missing.edges[e]);
            for &t in &around[e] {
                part.triangles.push(t);
                queue.extend(sides_of(t).filter(|&f| !std::mem::replace(&mut seen[f], true)));
            }
        }
        part.triangles.sort_unstable();
        part.triangles.dedup();
        parts.push(part);
    }
    parts.append(&mut whole);
    parts
}

/// Edges of a triangle, smaller vertex first.
pub(super) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [sorted(a, b), sorted(b, c), sorted(c, a)]
}

pub(super) fn sorted(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_share_a_missing_edge_are_one_part() {
        let triangles = [[0, 1, 2], [2, 1, 3], [3, 1, 4], [5, 6, 7], [7, 6, 8], [8, 9, 10]];
        let missing = Missing { edges: &[[6, 7], [1, 3], [1, 2], [20, 21]], triangles: &[0, 1, 2, 3, 4, 5] };
        let part =
            |edges: &[[u32; 2]], triangles: &[u32]| Part { edges: edges.to_vec(), triangles: triangles.to_vec() };
        let expected =
            [part(&[[6, 7]], &[3, 4]), part(&[[1, 3], [1, 2]], &[0, 1, 2]), part(&[[20, 21]], &[]), part(&[], &[5])];
        assert_eq!(parts(&triangles, missing), expected);
    }
}
