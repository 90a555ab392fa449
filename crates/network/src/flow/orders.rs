//! Strahler orders and diameter-defined orders of vessels.

use super::conjugate_gradient::NotConverged;
use super::poiseuille::solve;
use anastomesh_skeleton::{EdgeId, NodeId, Skeleton};

/// Orders of all vessels, from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Orders {
    /// Strahler order by edge. Vessels that end at outlets have 1. A vessel that feeds two or more of the highest order
    /// below it has one more. Pressures define the direction.
    pub strahler: Vec<u32>,
    /// Diameter-defined orders (Jiang, Kassab and Fung 1994) by edge. Starting from Strahler orders, vessels move to
    /// the order that matches their diameter, until convergence. Truncated outlets may then exceed order 1.
    pub by_diameter: Vec<u32>,
}

/// Maximum number of rounds.
const MAX_ORDER_PASSES: usize = 100;

impl Orders {
    /// Computes the orders of the vessels of a network with equal inflow at each inlet.
    ///
    /// # Errors
    /// The pressures cannot be found.
    pub fn from_inlets(skeleton: &Skeleton, inlets: impl IntoIterator<Item = NodeId>) -> Result<Self, NotConverged> {
        let inflow = inlets.into_iter().map(|node| (node, 1.0)).collect();
        Ok(Self::of(skeleton, &solve(skeleton, &inflow, 1.0)?.pressure))
    }

    /// Orders of a network's vessels with these node pressures.
    pub fn of(skeleton: &Skeleton, pressure: &[f64]) -> Self {
        let strahler = strahler(skeleton, pressure);
        let branches = skeleton.branches(&skeleton.adjacency()).list;
        let radius = |edges: &[EdgeId]| {
            let length: f64 = edges.iter().map(|&e| skeleton.length(e)).sum();
            let volume: f64 = edges.iter().map(|&e| skeleton.length(e) * skeleton.edge(e).mean_radius()).sum();
            volume / length.max(f64::MIN_POSITIVE)
        };
        let radii: Vec<f64> = branches.iter().map(|branch| radius(&branch.edges)).collect();
        let order = |edges: &[EdgeId]| edges.iter().map(|e| strahler[e.index()]).max().unwrap_or(1);
        let mut orders: Vec<u32> = branches.iter().map(|branch| order(&branch.edges)).collect();
        for _ in 0..MAX_ORDER_PASSES {
            let bounds = bounds(&orders, &radii);
            let moved: Vec<u32> = radii.iter().map(|&r| 1 + bounds.iter().filter(|&&b| r > b).count() as u32).collect();
            if moved == orders {
                break;
            }
            orders = moved;
        }
        let mut by_diameter = strahler.clone();
        for (branch, &order) in branches.iter().zip(&orders) {
            branch.edges.iter().for_each(|e| by_diameter[e.index()] = order);
        }
        Self { strahler, by_diameter }
    }
}

/// Strahler orders, by edges in ascending order of pressure, each after those that it feeds.
fn strahler(skeleton: &Skeleton, pressure: &[f64]) -> Vec<u32> {
    let adjacency = skeleton.adjacency();
    let ends = |e: EdgeId| {
        let [a, b] = skeleton.edge(e).nodes.map(|n| (pressure[n.index()], n));
        if a.0 <= b.0 { [a, b] } else { [b, a] }
    };
    let mut edges: Vec<EdgeId> = skeleton.edge_ids().collect();
    edges.sort_by(|&a, &b| {
        let [a, b] = [a, b].map(|e| ends(e).map(|(p, _)| p));
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    let mut orders = vec![0_u32; skeleton.edges.len()];
    for edge in edges {
        let end: NodeId = ends(edge)[0].1;
        let fed = adjacency.edges(end).iter().filter(|&&e| e != edge).map(|e| orders[e.index()]).filter(|&o| o > 0);
        let (highest, count) = fed.fold((0, 0), |(highest, count), order| match order.cmp(&highest) {
            std::cmp::Ordering::Greater => (order, 1),
            std::cmp::Ordering::Equal => (highest, count + 1),
            std::cmp::Ordering::Less => (highest, count),
        });
        orders[edge.index()] = if count == 1 { highest } else { highest + 1 };
    }
    orders
}

/// Radius limits between consecutive orders: midway between their means plus or minus a standard deviation. Empty
/// orders are skipped.
fn bounds(orders: &[u32], radii: &[f64]) -> Vec<f64> {
    let last = orders.iter().copied().max().unwrap_or(0);
    let mut usual: Vec<[f64; 2]> = Vec::new();
    for order in 1..=last {
        let own: Vec<f64> = orders.iter().zip(radii).filter(|(o, _)| **o == order).map(|(_, &r)| r).collect();
        if own.is_empty() {
            continue;
        }
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let deviation = (own.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / own.len() as f64).sqrt();
        usual.push([mean - deviation, mean + deviation]);
    }
    usual.windows(2).map(|pair| f64::midpoint(pair[0][1], pair[1][0])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::{network, tangle};

    fn orders(skeleton: &Skeleton) -> Orders {
        Orders::from_inlets(skeleton, [NodeId(0)]).unwrap()
    }

    #[test]
    fn a_full_binary_tree_has_an_order_per_level() {
        let tree = tangle(6, 5);
        let found = orders(&tree);
        let of_level = |k: u32| found.strahler.iter().filter(|&&o| o == k).count();
        assert_eq!((1..=7).map(of_level).collect::<Vec<_>>(), [64, 32, 16, 8, 4, 2, 1]);
    }

    #[test]
    fn a_thin_side_vessel_does_not_raise_the_order() {
        let points = [[0.0; 3], [0., 0., 5.], [0., 4., 9.], [0., -4., 9.], [3., 4., 14.], [-3., 4., 14.]];
        let tree = network(&points, 1.0, &[(0, 1), (1, 2), (1, 3), (2, 4), (2, 5)]);
        assert_eq!(orders(&tree).strahler, [2, 2, 1, 1, 1]);
    }

    #[test]
    fn a_wide_outlet_has_the_order_of_its_diameter() {
        let mut tree = tangle(5, 7);
        let levels = [6.0, 5.0, 4.0, 3.0, 2.0, 1.0];
        let strahler = orders(&tree).strahler;
        for (edge, order) in tree.edges.iter_mut().zip(&strahler) {
            edge.radii = [levels[6 - *order as usize]; 2];
        }
        // One of the tips was truncated early.
        let tip = strahler.iter().rposition(|&order| order == 1).unwrap();
        tree.edges[tip].radii = [3.0; 2];
        let found = orders(&tree);
        assert_eq!((found.strahler[tip], found.by_diameter[tip]), (1, 3));
        let others = found.by_diameter.iter().zip(&found.strahler).filter(|(a, b)| a != b).count();
        assert_eq!(others, 1);
    }
}
