//! Pressures in a conductor network by node elimination: the star of a node becomes a mesh between its neighbours.
//!
//! No subtractions occur, so every pressure is accurate to a few ulps for any range of conductances. (Those of vessels
//! exceed the dynamic range of sums in doubles.) A tree is eliminated from its tips without fill-in; loops cause
//! fill-in according to their cut width. A capillary bed has cuts of thousands, so a dense remainder is solved
//! iteratively (`iterate`).

use super::conjugate_gradient::{NodalSystem, NotConverged};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Limits of elimination: it stops with more remaining nodes and more neighbours per node than these.
const NODES: usize = 2000;
const NEIGHBOURS: usize = 12;

/// Nodes with conductances between them and to ground, and inflows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Conductors {
    /// Neighbours of each node, ascending, with conductances.
    around: Vec<Vec<(u32, f64)>>,
    /// Conductance from each node to ground, at pressure 0.
    ground: Vec<f64>,
    /// External inflow of each node; not negative.
    inflow: Vec<f64>,
}

/// Eliminated node and its former star.
struct Gone {
    node: u32,
    total: f64,
    star: Vec<(u32, f64)>,
}

impl Conductors {
    pub(super) fn new(nodes: usize) -> Self {
        Self { around: vec![Vec::new(); nodes], ground: vec![0.0; nodes], inflow: vec![0.0; nodes] }
    }

    /// Joins two nodes, in parallel to an existing conductor.
    pub(super) fn join(&mut self, [a, b]: [u32; 2], conductance: f64) {
        if a != b {
            add(&mut self.around[a as usize], b, conductance);
            add(&mut self.around[b as usize], a, conductance);
        }
    }

    pub(super) fn join_ground(&mut self, node: u32, conductance: f64) {
        self.ground[node as usize] += conductance;
    }

    pub(super) fn let_in(&mut self, node: u32, flow: f64) {
        self.inflow[node as usize] += flow;
    }

    /// Pressure of each node; 0 in components without ground, which must not have inflow.
    pub(super) fn pressures(mut self) -> Result<Vec<f64>, NotConverged> {
        // Nodes with few neighbours first, then in order of index.
        let entry = |node: usize, around: &[(u32, f64)]| Reverse((around.len() as u32, node as u32));
        let mut next: BinaryHeap<_> = self.around.iter().enumerate().map(|(node, list)| entry(node, list)).collect();
        let mut is_gone = vec![false; self.around.len()];
        let mut gone = Vec::with_capacity(self.around.len());
        let mut core = Vec::new();
        while let Some(Reverse((degree, node))) = next.pop() {
            // The heap also contains outdated entries.
            if is_gone[node as usize] || self.around[node as usize].len() != degree as usize {
                continue;
            }
            if degree as usize > NEIGHBOURS && is_gone.len() - gone.len() > NODES {
                core = (0..is_gone.len() as u32).filter(|&node| !is_gone[node as usize]).collect();
                break;
            }
            is_gone[node as usize] = true;
            let last = self.eliminate(node);
            next.extend(last.star.iter().map(|&(other, _)| entry(other as usize, &self.around[other as usize])));
            gone.push(last);
        }
        drop(next);
        let mut pressure = vec![0.0; self.around.len()];
        for (node, found) in core.iter().zip(self.core_system(&core).pressures()?) {
            pressure[*node as usize] = found;
        }
        for Gone { node, total, star } in gone.iter().rev() {
            let through: f64 = star.iter().map(|&(other, g)| g * pressure[other as usize]).sum();
            if *total > 0.0 {
                pressure[*node as usize] = (self.inflow[*node as usize] + through) / total;
            }
        }
        Ok(pressure)
    }

    /// Remaining nodes, renumbered in ascending order.
    fn core_system(&mut self, core: &[u32]) -> NodalSystem {
        let number = |node: u32| core.partition_point(|&other| other < node) as u32;
        let mut system = NodalSystem::default();
        for &node in core {
            let around = std::mem::take(&mut self.around[node as usize]);
            let around = around.into_iter().map(|(other, g)| (number(other), g));
            system.add(around, self.ground[node as usize], self.inflow[node as usize]);
        }
        system
    }

    fn eliminate(&mut self, node: u32) -> Gone {
        let star = std::mem::take(&mut self.around[node as usize]);
        let (ground, inflow) = (self.ground[node as usize], self.inflow[node as usize]);
        let total = ground + star.iter().map(|(_, g)| g).sum::<f64>();
        for &(other, g) in &star {
            let share = g / total;
            self.ground[other as usize] += share * ground;
            self.inflow[other as usize] += share * inflow;
            let mesh = star.iter().filter(|(third, _)| *third != other).map(|&(third, h)| (third, share * h));
            let own = &mut self.around[other as usize];
            *own = merged(own, node, mesh);
        }
        Gone { node, total, star }
    }
}

fn add(list: &mut Vec<(u32, f64)>, node: u32, conductance: f64) {
    match list.binary_search_by_key(&node, |entry| entry.0) {
        Ok(at) => list[at].1 += conductance,
        Err(at) => list.insert(at, (node, conductance)),
    }
}

/// Merges two ascending lists, without an eliminated node.
fn merged(own: &[(u32, f64)], gone: u32, more: impl Iterator<Item = (u32, f64)>) -> Vec<(u32, f64)> {
    let mut more = more.peekable();
    let mut all = Vec::with_capacity(own.len() + more.size_hint().1.unwrap_or(0));
    for &(node, g) in own.iter().filter(|(node, _)| *node != gone) {
        while let Some(new) = more.next_if(|new| new.0 < node) {
            all.push(new);
        }
        all.push((node, g + more.next_if(|new| new.0 == node).map_or(0.0, |new| new.1)));
    }
    all.extend(more);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn pressures(nodes: usize, joined: &[(u32, u32, f64)], ground: &[(u32, f64)], inflow: &[(u32, f64)]) -> Vec<f64> {
        let mut network = Conductors::new(nodes);
        for &(a, b, g) in joined {
            network.join([a, b], g);
        }
        for &(node, g) in ground {
            network.join_ground(node, g);
        }
        for &(node, flow) in inflow {
            network.let_in(node, flow);
        }
        network.pressures().unwrap()
    }

    #[test]
    fn in_a_row_pressures_add_up() {
        let found = pressures(3, &[(0, 1, 2.0), (1, 2, 0.5)], &[(2, 4.0)], &[(0, 1.0)]);
        assert_eq!(found, [2.75, 2.25, 0.25]);
    }

    #[test]
    fn an_even_bridge_carries_nothing() {
        let bridge = [(0, 1, 1.0), (0, 2, 2.0), (1, 2, 7.0)];
        let found = pressures(3, &bridge, &[(1, 1.0), (2, 2.0)], &[(0, 3.0)]);
        assert!(found.iter().zip([2.0, 1.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
    }

    #[test]
    fn conductances_that_differ_by_more_than_doubles_can_add() {
        let found = pressures(2, &[(0, 1, 1e30)], &[(1, 1e-30)], &[(0, 1e-30)]);
        assert_eq!(found, [1.0, 1.0]);
    }

    #[test]
    fn what_leads_nowhere_has_no_pressure() {
        assert_eq!(pressures(3, &[(0, 1, 1.0), (1, 2, 1.0)], &[], &[]), [0.0; 3]);
    }

    /// Cube with `side` nodes along each edge and conductances over three orders of magnitude; ground at one corner.
    fn cube(side: u32) -> Vec<(u32, u32, f64)> {
        let at = |x: u32, y: u32, z: u32| x + side * (y + side * z);
        let mut joined = Vec::new();
        for (x, y, z) in (0..side.pow(3)).map(|i| (i % side, i / side % side, i / side / side)) {
            let next = [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)];
            for (k, (a, b, c)) in next.into_iter().enumerate().filter(|(_, (a, b, c))| a.max(b).max(c) < &side) {
                let conductance = 10.0_f64.powi((7 * x + 5 * y + 3 * z + k as u32) as i32 % 4);
                joined.push((at(x, y, z), at(a, b, c), conductance));
            }
        }
        joined
    }

    #[test]
    fn what_flows_into_a_thicket_leaves_it() {
        let side = 22;
        let (nodes, joined) = (side * side * side, cube(side));
        let found = pressures(nodes as usize, &joined, &[(nodes - 1, 2.0)], &[(0, 1.0)]);
        let mut missing = vec![0.0; nodes as usize];
        missing[0] = 1.0;
        missing[nodes as usize - 1] -= 2.0 * found[nodes as usize - 1];
        for (a, b, g) in joined {
            let flow = g * (found[a as usize] - found[b as usize]);
            missing[a as usize] -= flow;
            missing[b as usize] += flow;
        }
        let most = missing.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!(most < 1e-10, "{most}");
        assert!((found[nodes as usize - 1] - 0.5).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn as_by_a_dense_solution(joined in prop::collection::vec((0_u32..12, 0_u32..12, 0.1..10.0), 1..40)) {
            // A ring connects everything.
            let mut joined = joined;
            joined.extend((0..12).map(|i| (i, (i + 1) % 12, 1.0)));
            let found = pressures(12, &joined, &[(3, 0.7), (8, 2.0)], &[(0, 1.0), (5, 0.25)]);
            let mut matrix = DMatrix::zeros(12, 12);
            for &(a, b, g) in joined.iter().filter(|(a, b, _)| a != b) {
                let (a, b) = (a as usize, b as usize);
                matrix[(a, a)] += g;
                matrix[(b, b)] += g;
                matrix[(a, b)] -= g;
                matrix[(b, a)] -= g;
            }
            matrix[(3, 3)] += 0.7;
            matrix[(8, 8)] += 2.0;
            let mut inflow = DVector::zeros(12);
            inflow[0] = 1.0;
            inflow[5] = 0.25;
            let expected = matrix.lu().solve(&inflow).unwrap();
            prop_assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-10 * b), "{found:?} {expected}");
        }
    }
}
