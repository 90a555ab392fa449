//! Results of a flow solver along the vessels of its network.
//!
//! Each cell belongs to the vessel whose wall is nearest. The flow rate at a station is the sum of the fluxes through the
//! faces between cells before and after it. It conserves the flow as the solver does.

use super::vessels::poiseuille_shear;
use anastomesh_io::results::{FlowResult, Near};
use anastomesh_mesh::units::counted;
use anastomesh_network::flow::{NotConverged, solve_between};
use anastomesh_skeleton::{EdgeId, NodeId, Skeleton, Tubes};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Number of stations per branch.
const STATIONS: usize = 9;
/// Distance of stations from terminals and from bifurcations, in the largest radius there. Closer stations differ by up to 3 %.
const CLEAR: [f64; 2] = [1.0, 2.5];
/// Largest part of a branch without stations, at each end.
const END_PART: f64 = 0.3;
/// Largest distance of a cell from an axis, in radii. Cells of a mesh of the network are within about 1.2.
const INSIDE: f64 = 1.5;
/// Part of the cells that may be outside: cells in the webs of wide bifurcations.
const OUTSIDE: f64 = 0.02;
/// Length of a branch that must have cells, in radii. Shorter ones may lie within their neighbours.
const LONG: f64 = 4.0;
/// Largest distance of a cap from its terminal, in radii.
const AT_TERMINAL: f64 = 3.0;
/// Largest distance of a wall cell from the wall for the correction of shear, in radii.
const NEAR_WALL: f64 = 0.5;

/// Width of the kernel for the pressure at a node, in radii.
const KERNEL: f64 = 1.5;

/// Flow along the vessels.
#[derive(Clone, Debug, PartialEq)]
pub struct Along {
    /// Values by branch.
    pub branches: Vec<BranchFlow>,
    /// Branch of each edge.
    pub of_edge: Vec<u32>,
    /// True for edges against the direction of their branch.
    pub is_reversed: Vec<bool>,
    /// Mean wall shear stress by edge; NaN without wall faces.
    pub shear: Vec<f64>,
    /// Pressure by node, from the cells of its edges; NaN without cells.
    pub pressure: Vec<f64>,
    /// Pressures of the one-dimensional solution, by node.
    pub expected_pressure: Vec<f64>,
    /// Flow rates into inlets and out of outlets.
    pub of_terminal: BTreeMap<NodeId, f64>,
    /// Flow rate into all inlets.
    pub inflow: f64,
}

/// Flow through a branch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BranchFlow {
    /// Nodes at both ends, by their index.
    pub nodes: [u32; 2],
    /// Arc length.
    pub length: f64,
    /// Mean radius.
    pub radius: f64,
    /// Number of cells.
    pub cells: usize,
    /// Median flow rate of the stations, along the branch; NaN without stations.
    pub flow: f64,
    /// Difference of the largest and smallest flow rate of the stations.
    pub spread: f64,
    /// Number of stations with faces.
    pub stations: usize,
    /// Flow rate of the one-dimensional solution.
    pub expected_flow: f64,
    /// Mean wall shear stress.
    pub shear: f64,
    /// Wall shear stress of the one-dimensional solution.
    pub expected_shear: f64,
}

/// Reason why a result does not fit a network.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Misfit {
    /// Cells lie outside the vessels.
    #[error(
        "{} of {cells} lie outside the vessels, the first at {place:?}; give the network of this mesh, with the same units \
         and the same options", counted(*outside, "cell")
    )]
    Outside {
        /// Number of cells outside.
        outside: usize,
        /// Number of cells.
        cells: usize,
        /// Centre of the first cell outside.
        place: [f64; 3],
    },
    /// A vessel has no cells.
    #[error("the mesh has no cells in the vessel from node {} to node {}; give the network of this mesh", nodes[0], nodes[1])]
    Empty {
        /// Nodes at both ends.
        nodes: [u32; 2],
    },
    /// A terminal has no cap.
    #[error("the boundary has no cap at terminal {node}; give the network of this mesh")]
    NoCap {
        /// Node of the terminal.
        node: u32,
    },
    /// A cap is not at a terminal.
    #[error(
        "the boundary has an open face at {place:?}, far from every terminal; give the network of this mesh, and a result \
         whose wall is a patch of type wall"
    )]
    Open {
        /// Centre of the face.
        place: [f64; 3],
    },
    /// An inlet has outflow.
    #[error("the flow rate {rate:e} leaves through the inlet at node {node}; name the inlets of the result")]
    Outflow {
        /// Node of the inlet.
        node: u32,
        /// Flow rate out of the mesh.
        rate: f64,
    },
    /// The pressures cannot be found.
    #[error(transparent)]
    NotConverged(#[from] NotConverged),
}

/// Position of a cell.
#[derive(Clone, Copy, Debug)]
struct Spot {
    edge: EdgeId,
    branch: u32,
    /// Parameter along the edge.
    t: f64,
    /// Arc length along the branch.
    arc: f64,
    radius: f64,
    is_outside: bool,
}

/// Fluid of a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResultFluid {
    /// Mass per volume.
    pub density: f64,
    /// Dynamic viscosity.
    pub viscosity: f64,
}

impl Along {
    /// Maps a result to the network of its mesh, and solves for the one-dimensional flow with the inflow rates and outlet
    /// pressures of the result.
    ///
    /// # Errors
    /// The result is not one of this network.
    pub fn of(
        network: &Skeleton,
        inlets: &BTreeSet<NodeId>,
        result: &FlowResult,
        fluid: ResultFluid,
    ) -> Result<Self, Misfit> {
        let scale = if result.is_kinematic { fluid.density } else { 1.0 };
        let mut along = Self::empty(network);
        let spots = along.spots(network, result)?;
        for spot in &spots {
            along.branches[spot.branch as usize].cells += 1;
        }
        let is_missing = |branch: &&BranchFlow| branch.cells == 0 && branch.length > LONG * branch.radius;
        if let Some(branch) = along.branches.iter().find(is_missing) {
            return Err(Misfit::Empty { nodes: branch.nodes.map(|node| network.nodes[node as usize].original) });
        }
        along.add_flow(network, &spots, result);
        along.add_shear(network, &spots, result, scale, fluid.viscosity);
        along.pressure = node_pressures(network, &spots, result, scale);
        let pressures = along.add_terminals(network, inlets, &spots, result, scale)?;
        for (node, pressure) in &pressures {
            along.pressure[node.index()] = *pressure;
        }
        along.add_expected(network, inlets, &pressures, fluid.viscosity)?;
        Ok(along)
    }

    fn empty(network: &Skeleton) -> Self {
        let list = network.branches(&network.adjacency()).list;
        let mut of_edge = vec![0; network.edges.len()];
        let mut is_reversed = vec![false; network.edges.len()];
        let mut branches = Vec::with_capacity(list.len());
        for (number, branch) in (0..).zip(&list) {
            for (&edge, &start) in branch.edges.iter().zip(&branch.nodes) {
                of_edge[edge.index()] = number;
                is_reversed[edge.index()] = network.edge(edge).nodes[0] != start;
            }
            let radius = branch.mean_radius(network);
            let nodes = branch.ends().map(|node| node.0);
            branches.push(BranchFlow { nodes, length: branch.length(), radius, ..BranchFlow::default() });
        }
        let (shear, pressure, expected_pressure, of_terminal) = Default::default();
        Self { branches, of_edge, is_reversed, shear, pressure, expected_pressure, of_terminal, inflow: 0.0 }
    }

    /// Finds the vessel of each cell.
    fn spots(&self, network: &Skeleton, result: &FlowResult) -> Result<Vec<Spot>, Misfit> {
        let tubes = Tubes::of(network);
        let arcs = arcs(network);
        let spot = |place: &_| {
            let near = tubes.nearest_wall(place)?;
            let [start, end] = arcs[near.edge.index()];
            Some(Spot {
                edge: near.edge,
                branch: self.of_edge[near.edge.index()],
                t: near.t,
                arc: start + near.t * (end - start),
                radius: near.radius,
                is_outside: near.distance > INSIDE * near.radius,
            })
        };
        let spots: Vec<Spot> = result.cells.par_iter().filter_map(spot).collect();
        let outside = spots.iter().filter(|spot| spot.is_outside).count();
        if outside as f64 > OUTSIDE * spots.len() as f64 {
            let first = spots.iter().position(|spot| spot.is_outside).unwrap_or(0);
            let place = result.cells[first].into();
            return Err(Misfit::Outside { outside, cells: spots.len(), place });
        }
        Ok(spots)
    }

    /// Sums fluxes between the cells on both sides of each station.
    fn add_flow(&mut self, network: &Skeleton, spots: &[Spot], result: &FlowResult) {
        let clear = clearances(network);
        let stations =
            self.branches.iter().map(|branch| stations(branch, branch.nodes.map(|node| clear[node as usize])));
        let stations: Vec<[f64; STATIONS]> = stations.collect();
        let mut sums = vec![[(0.0, 0_u32); STATIONS]; self.branches.len()];
        for face in &result.inner {
            let [a, b] = face.cells.map(|cell| spots[cell as usize]);
            if a.branch != b.branch {
                continue;
            }
            let (low, high, flux) = if a.arc <= b.arc { (a.arc, b.arc, face.flux) } else { (b.arc, a.arc, -face.flux) };
            let here = &stations[a.branch as usize];
            let between = here.partition_point(|&s| s <= low)..here.partition_point(|&s| s <= high);
            for (sum, count) in &mut sums[a.branch as usize][between] {
                (*sum, *count) = (*sum + flux, *count + 1);
            }
        }
        for (branch, sums) in self.branches.iter_mut().zip(&sums) {
            let mut rates: Vec<f64> = sums.iter().filter(|(_, count)| *count > 0).map(|(sum, _)| *sum).collect();
            rates.sort_unstable_by(f64::total_cmp);
            branch.stations = rates.len();
            branch.flow = rates.get(rates.len() / 2).copied().unwrap_or(f64::NAN);
            branch.spread = rates.last().zip(rates.first()).map_or(f64::NAN, |(last, first)| last - first);
        }
    }

    /// Averages the wall shear stress over the wall of each edge and branch.
    fn add_shear(&mut self, network: &Skeleton, spots: &[Spot], result: &FlowResult, scale: f64, viscosity: f64) {
        let mut of_edge = vec![[0.0; 2]; network.edges.len()];
        for face in result.outer.iter().filter(|face| face.is_wall) {
            let spot = spots[face.cell as usize];
            let shear = face
                .shear
                .map_or_else(|| viscosity * near_gradient(face.near, spot.radius, result.is_nodal), |s| scale * s);
            let (area, sum) = (face.area.norm(), &mut of_edge[spot.edge.index()]);
            *sum = [sum[0] + area * shear, sum[1] + area];
        }
        let mean = |[sum, area]: [f64; 2]| if area > 0.0 { sum / area } else { f64::NAN };
        let mut of_branch = vec![[0.0; 2]; self.branches.len()];
        for (edge, sum) in of_edge.iter().enumerate() {
            let own = &mut of_branch[self.of_edge[edge] as usize];
            *own = [own[0] + sum[0], own[1] + sum[1]];
        }
        self.shear = of_edge.into_iter().map(mean).collect();
        self.branches.iter_mut().zip(of_branch).for_each(|(branch, sum)| branch.shear = mean(sum));
    }

    /// Sums the flow through the caps, and returns the mean pressure of each.
    fn add_terminals(
        &mut self,
        network: &Skeleton,
        inlets: &BTreeSet<NodeId>,
        spots: &[Spot],
        result: &FlowResult,
        scale: f64,
    ) -> Result<BTreeMap<NodeId, f64>, Misfit> {
        let adjacency = network.adjacency();
        let terminals = adjacency.terminals();
        let mut sums: BTreeMap<NodeId, [f64; 3]> = BTreeMap::new();
        for face in result.outer.iter().filter(|face| !face.is_wall) {
            let spot = spots[face.cell as usize];
            let ends = self.branches[spot.branch as usize].nodes.map(NodeId);
            let distance = |node: &NodeId| (network.node(*node).position - face.center).norm();
            let nearest = |nodes: &[NodeId]| nodes.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let own: Vec<NodeId> = ends.into_iter().filter(|&node| adjacency.valence(node) == 1).collect();
            // Cells of a short vessel may belong to its neighbour.
            let near = nearest(&own).or_else(|| nearest(&terminals));
            let near = near.filter(|node| distance(node) <= AT_TERMINAL * spot.radius);
            let node = near.ok_or(Misfit::Open { place: face.center.into() })?;
            let (area, sum) = (face.area.norm(), sums.entry(node).or_default());
            *sum = [sum[0] + face.flux, sum[1] + area * scale * face.pressure, sum[2] + area];
        }
        let mut pressures = BTreeMap::new();
        for node in terminals {
            let number = network.node(node).original;
            let [flux, pressure, area] = sums.get(&node).copied().ok_or(Misfit::NoCap { node: number })?;
            let is_inlet = inlets.contains(&node);
            if is_inlet && flux > 0.0 {
                return Err(Misfit::Outflow { node: number, rate: flux });
            }
            self.of_terminal.insert(node, if is_inlet { -flux } else { flux });
            self.inflow += if is_inlet { -flux } else { 0.0 };
            pressures.insert(node, pressure / area.max(f64::MIN_POSITIVE));
        }
        Ok(pressures)
    }

    /// Solves for the one-dimensional flow.
    fn add_expected(
        &mut self,
        network: &Skeleton,
        inlets: &BTreeSet<NodeId>,
        pressures: &BTreeMap<NodeId, f64>,
        viscosity: f64,
    ) -> Result<(), Misfit> {
        let rates =
            self.of_terminal.iter().filter(|(node, _)| inlets.contains(node)).map(|(&node, &rate)| (node, rate));
        let solved = solve_between(network, &rates.collect(), pressures, viscosity)?;
        let list = network.branches(&network.adjacency()).list;
        for (own, branch) in self.branches.iter_mut().zip(&list) {
            let resistance: f64 =
                branch.edges.iter().map(|&edge| anastomesh_network::flow::resistance(network, edge, viscosity)).sum();
            let [start, end] = branch.ends().map(|node| solved.pressure[node.index()]);
            own.expected_flow = (start - end) / resistance;
            let shear = branch.edges.iter().map(|&edge| {
                network.length(edge) * poiseuille_shear(viscosity, own.expected_flow, network.edge(edge).mean_radius())
            });
            own.expected_shear = shear.sum::<f64>() / branch.length().max(f64::MIN_POSITIVE);
        }
        self.expected_pressure = solved.pressure;
        Ok(())
    }

    /// Flow rate of an edge, from its first to its second node, and that of the one-dimensional solution.
    pub fn edge_flow(&self, edge: usize) -> [f64; 2] {
        let branch = &self.branches[self.of_edge[edge] as usize];
        let sign = if self.is_reversed[edge] { -1.0 } else { 1.0 };
        [sign * branch.flow, sign * branch.expected_flow]
    }
}

/// Arc length along the branch at both ends of each edge.
fn arcs(network: &Skeleton) -> Vec<[f64; 2]> {
    let mut arcs = vec![[0.0; 2]; network.edges.len()];
    for branch in &network.branches(&network.adjacency()).list {
        for (i, &edge) in branch.edges.iter().enumerate() {
            let mut ends = [branch.arc[i], branch.arc[i + 1]];
            if network.edge(edge).nodes[0] != branch.nodes[i] {
                ends.reverse();
            }
            arcs[edge.index()] = ends;
        }
    }
    arcs
}

/// Distance of stations from each node.
fn clearances(network: &Skeleton) -> Vec<f64> {
    let mut widest = vec![(0_u32, 0.0_f64); network.nodes.len()];
    for edge in &network.edges {
        for (node, radius) in edge.nodes.iter().zip(edge.radii) {
            let here = &mut widest[node.index()];
            *here = (here.0 + 1, here.1.max(radius));
        }
    }
    widest.into_iter().map(|(edges, radius)| radius * CLEAR[usize::from(edges > 1)]).collect()
}

/// Stations along a branch, ascending.
fn stations(branch: &BranchFlow, clear: [f64; 2]) -> [f64; STATIONS] {
    let [from, behind] = clear.map(|clear| clear.min(END_PART * branch.length));
    let step = (branch.length - from - behind) / (STATIONS - 1) as f64;
    std::array::from_fn(|i| from + step * i as f64)
}

/// Gradient of the velocity at a wall.
///
/// A finite volume solver balances forces with the difference of a cell and its wall. Nodes are on a parabolic profile
/// between the wall and the axis.
fn near_gradient(near: Near, radius: f64, is_nodal: bool) -> f64 {
    let share = if is_nodal { (near.height / radius).min(NEAR_WALL) } else { 0.0 };
    if near.height > 0.0 { near.speed / (near.height * (1.0 - 0.5 * share)) } else { 0.0 }
}

/// Pressure by node.
///
/// A line is fitted to the cells near each end of each edge. The ends at a node are averaged by the volume of their cells.
fn node_pressures(network: &Skeleton, spots: &[Spot], result: &FlowResult, scale: f64) -> Vec<f64> {
    // Sums of 1, x, x², p and x p for the distance x from each end, weighted by volume and a Gaussian kernel.
    let mut sums = vec![[[0.0; 5]; 2]; network.edges.len()];
    for ((spot, pressure), volume) in spots.iter().zip(&result.pressures).zip(&result.volumes) {
        let (length, p) = (network.length(spot.edge) / (KERNEL * spot.radius), scale * pressure);
        for (sums, x) in sums[spot.edge.index()].iter_mut().zip([length * spot.t, length * (1.0 - spot.t)]) {
            let weight = volume * libm::exp(-0.5 * x * x);
            for (sum, term) in sums.iter_mut().zip([1.0, x, x * x, p, x * p]) {
                *sum += weight * term;
            }
        }
    }
    let mut nodes = vec![[0.0; 2]; network.nodes.len()];
    for (edge, ends) in network.edges.iter().zip(sums) {
        for (node, [w, x, xx, p, xp]) in edge.nodes.iter().zip(ends).filter(|(_, sums)| sums[0] > 0.0) {
            let (mean_x, mean_p) = (x / w, p / w);
            let variance = xx / w - mean_x * mean_x;
            // Cells of short edges may all be at one place.
            let slope = if variance > 1e-3 { (xp / w - mean_x * mean_p) / variance } else { 0.0 };
            let sum = &mut nodes[node.index()];
            *sum = [sum[0] + w * (mean_p - slope * mean_x), sum[1] + w];
        }
    }
    nodes.into_iter().map(|[sum, weight]| if weight > 0.0 { sum / weight } else { f64::NAN }).collect()
}

#[cfg(test)]
mod tests;
