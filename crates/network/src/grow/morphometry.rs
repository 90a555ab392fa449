//! Number, radius and length of the vessels per Strahler order: measured and published values.
//!
//! A vessel is a chain of edges of one order. Terminals have order 0. A parent of two vessels of equal order has the
//! next order.

use anastomesh_skeleton::{NodeId, Skeleton};

/// Published mean and standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Published {
    /// Number of vessels.
    pub count: [f64; 2],
    /// Radius, µm.
    pub radius: [f64; 2],
    /// Length, µm.
    pub length: [f64; 2],
}

const fn published(count: [f64; 2], radius: [f64; 2], length: [f64; 2]) -> Published {
    Published { count, radius, length }
}

/// The arteries of a rat's kidney by Strahler order, 0 first: means and standard deviations of Nordsletten et al.,
/// 'Structural morphology of renal vasculature', Am. J. Physiol. 291 (2006).
pub const RAT_KIDNEY: [Published; 11] = [
    published([29_566.0, 5965.0], [10.08, 0.14], [312.0, 285.0]),
    published([13_070.0, 2293.0], [13.9, 3.8], [423.0, 283.0]),
    published([4373.0, 664.0], [20.06, 6.9], [404.0, 390.0]),
    published([1245.0, 198.0], [29.87, 0.35], [656.0, 286.0]),
    published([578.0, 71.0], [39.29, 1.08], [1001.0, 216.0]),
    published([247.0, 23.0], [44.23, 9.81], [511.0, 0.0]),
    published([90.0, 6.0], [53.87, 12.51], [1031.0, 674.0]),
    published([21.0, 1.0], [86.15, 24.06], [2516.0, 2053.0]),
    published([6.0, 0.0], [139.83, 20.11], [8975.0, 1331.0]),
    published([3.0, 0.0], [191.42, 17.79], [1440.0, 647.0]),
    published([1.0, 0.0], [216.10, 4.74], [185.0, 0.0]),
];

/// Figures of the vessels of one order.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct OrderFigures {
    /// Number of vessels: chains of edges of this order.
    pub count: usize,
    /// Number of edges.
    pub edges: usize,
    /// Mean radius of the vessels, with equal weights; the radius of a vessel is the mean along it.
    pub radius: f64,
    /// Standard deviation of the radius.
    pub radius_deviation: f64,
    /// Mean length of the vessels.
    pub length: f64,
    /// Standard deviation of the length.
    pub length_deviation: f64,
}

/// Morphometry of a tree by Strahler order.
///
/// ```
/// use anastomesh_network::{GenerateParams, Morphometry, Organ, generate};
///
/// let tree = generate(&GenerateParams::new(Organ::Kidney, 50))?;
/// let orders = Morphometry::of(&tree).orders;
/// assert!(orders.len() > 2 && orders[0].count > orders[1].count);
/// # Ok::<(), anastomesh_network::GenerateError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Morphometry {
    /// Figures of each order, 0 first.
    pub orders: Vec<OrderFigures>,
}

/// Partially traversed vessel.
#[derive(Clone, Copy)]
struct Vessel {
    order: usize,
    length: f64,
    /// Integral of the radius along the vessel.
    area: f64,
}

impl Morphometry {
    /// Morphometry of a tree made by `generate`: edges lead from the inlet (node 0) to nodes of higher index.
    pub fn of(tree: &Skeleton) -> Self {
        let orders = strahler(tree);
        let count = orders.iter().max().map_or(0, |most| most + 1);
        let mut edges = vec![0; count];
        let mut vessel_of_node = vec![u32::MAX; tree.nodes.len()];
        let mut vessels: Vec<Vessel> = Vec::new();
        for (id, edge) in tree.edge_ids().zip(&tree.edges) {
            let [from, to] = edge.nodes.map(NodeId::index);
            let order = orders[to];
            edges[order] += 1;
            // At most one vessel after a bifurcation has the order of the parent.
            let goes_on = from != 0 && orders[from] == order;
            let vessel = if goes_on { vessel_of_node[from] } else { vessels.len() as u32 };
            if !goes_on {
                vessels.push(Vessel { order, length: 0.0, area: 0.0 });
            }
            vessel_of_node[to] = vessel;
            if let Some(vessel) = vessels.get_mut(vessel as usize) {
                vessel.length += tree.length(id);
                vessel.area += tree.length(id) * edge.mean_radius();
            }
        }
        let of_order = |order: usize| {
            let these: Vec<&Vessel> = vessels.iter().filter(|v| v.order == order).collect();
            let [radius, radius_deviation] = spread(these.iter().map(|v| v.area / v.length));
            let [length, length_deviation] = spread(these.iter().map(|v| v.length));
            OrderFigures { count: these.len(), edges: edges[order], radius, radius_deviation, length, length_deviation }
        };
        Self { orders: (0..count).map(of_order).collect() }
    }
}

/// Order of the vessel to each node.
fn strahler(tree: &Skeleton) -> Vec<usize> {
    let mut orders = vec![0; tree.nodes.len()];
    // Highest order among the branches of each node, and its number of occurrences.
    let mut best = vec![(0, 0_u32); tree.nodes.len()];
    for edge in tree.edges.iter().rev() {
        let [from, to] = edge.nodes.map(NodeId::index);
        let (most, times) = best[to];
        orders[to] = if times > 1 { most + 1 } else { most };
        let order = orders[to];
        let above = &mut best[from];
        if above.1 == 0 || order > above.0 {
            *above = (order, 1);
        } else if order == above.0 {
            above.1 += 1;
        }
    }
    orders
}

/// Mean and standard deviation.
fn spread(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
    [mean, variance.sqrt()]
}
