//! Network data at each point of its mesh: the radius there, which vessel it is, how far along it.
//!
//! The vessel of a place is that whose wall is nearest, counted as negative inside.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::{tet_ratio, triangle_ratio};
use anastomesh_mesh::source::MeshSource;
use anastomesh_network::flow::{NotConverged, Orders, solve};
use anastomesh_skeleton::{Adjacency, NodeId, Skeleton, Tubes};
use rayon::prelude::*;

/// Something that can be known of a place in a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Datum {
    /// Radius of the vessel there.
    Radius,
    /// Distance along the branch from its upstream end.
    Distance,
    /// Number of the branch.
    Branch,
    /// Number of bifurcations between the vessel and the inlet.
    Generation,
    /// Strahler's order.
    Strahler,
    /// The nearer end of the edge, as the network numbers its nodes from 0.
    Node,
    /// Radius ratio of the cell itself.
    Ratio,
}

impl Datum {
    /// All, in their order.
    pub const ALL: [Self; 7] =
        [Self::Radius, Self::Distance, Self::Branch, Self::Generation, Self::Strahler, Self::Node, Self::Ratio];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        self.column().name
    }

    /// Point data vary along a vessel; cell data are constant per vessel or cell.
    fn column(self) -> Column {
        let (name, at_points, is_integer) = match self {
            Self::Radius => ("radius", true, false),
            Self::Distance => ("distance", true, false),
            Self::Branch => ("branch", false, true),
            Self::Generation => ("generation", false, true),
            Self::Strahler => ("strahler", false, true),
            Self::Node => ("node", false, true),
            Self::Ratio => ("ratio", false, false),
        };
        Column { name, at_points, is_integer }
    }
}

/// Data of an edge.
#[derive(Clone, Copy, Debug, Default)]
struct EdgeData {
    branch: u32,
    generation: u32,
    strahler: u32,
    /// The ends, as they were numbered in the file.
    nodes: [u32; 2],
    /// Arc length along the branch.
    distances: [f64; 2],
}

/// Requested data of a network and its mesh.
pub struct VesselData {
    data: Vec<Datum>,
    columns: Vec<Column>,
    tubes: Tubes,
    edges: Vec<EdgeData>,
}

impl VesselData {
    /// Of the network that was meshed. Inlets are known by the names of their patches.
    ///
    /// # Errors
    /// The pressures in the network cannot be found.
    pub fn new(data: Vec<Datum>, network: &Skeleton, mesh: &dyn MeshSource) -> Result<Self, NotConverged> {
        let columns = data.iter().map(|datum| datum.column()).collect();
        let edges = edges(network, &inlets(network, mesh))?;
        Ok(Self { data, columns, tubes: Tubes::of(network), edges })
    }

    fn at(&self, datum: Datum, place: &Point3) -> f64 {
        // There is no mesh without a vessel.
        let Some(near) = self.tubes.nearest_wall(place) else { return 0.0 };
        let edge = &self.edges[near.edge.index()];
        match datum {
            Datum::Radius => near.radius,
            Datum::Distance => edge.distances[0] + near.t * (edge.distances[1] - edge.distances[0]),
            Datum::Branch => f64::from(edge.branch),
            Datum::Generation => f64::from(edge.generation),
            Datum::Strahler => f64::from(edge.strahler),
            Datum::Node => f64::from(edge.nodes[usize::from(near.t > 0.5)]),
            Datum::Ratio => 0.0,
        }
    }

    fn in_cells<const N: usize>(
        &self,
        column: usize,
        cells: &[[Point3; N]],
        ratio: impl Fn(&[Point3; N]) -> f64 + Sync,
    ) -> Vec<f64> {
        let value = |cell: &[Point3; N]| match self.data[column] {
            Datum::Ratio => ratio(cell),
            datum => self.at(datum, &Point3::from(cell.iter().map(|p| p.coords).sum::<Vec3>() / N as f64)),
        };
        cells.par_iter().map(value).collect()
    }
}

impl Beside for VesselData {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn at_points(&self, column: usize, points: &[Point3]) -> Vec<f64> {
        points.par_iter().map(|p| self.at(self.data[column], p)).collect()
    }

    fn in_tets(&self, column: usize, tets: &[[Point3; 4]]) -> Vec<f64> {
        self.in_cells(column, tets, tet_ratio)
    }

    fn in_faces(&self, column: usize, faces: &[[Point3; 3]]) -> Vec<f64> {
        self.in_cells(column, faces, triangle_ratio)
    }
}

/// The inlets of a mesh; in a component without one nothing is upstream.
fn inlets(network: &Skeleton, mesh: &dyn MeshSource) -> BTreeSet<NodeId> {
    let caps = mesh.patches().iter().filter(|patch| patch.is_inlet()).filter_map(|patch| patch.cap);
    let meant: BTreeSet<u32> = caps.map(|cap| cap.node).collect();
    let terminals = network.adjacency().terminals();
    terminals.into_iter().filter(|&node| meant.contains(&network.node(node).original)).collect()
}

fn edges(network: &Skeleton, inlets: &BTreeSet<NodeId>) -> Result<Vec<EdgeData>, NotConverged> {
    let adjacency = network.adjacency();
    let inflow: BTreeMap<NodeId, f64> = inlets.iter().map(|&node| (node, 1.0)).collect();
    let pressure = solve(network, &inflow, 1.0)?.pressure;
    let strahler = Orders::of(network, &pressure).strahler;
    let generations = generations(network, &adjacency, inlets);
    let mut edges = vec![EdgeData::default(); network.edges.len()];
    for (number, branch) in (0..).zip(&network.branches(&adjacency).list) {
        let [start, end] = branch.ends().map(|node| pressure[node.index()]);
        let distance = |arc: f64| if start >= end { arc } else { branch.length() - arc };
        for (i, &id) in branch.edges.iter().enumerate() {
            let nodes = network.edge(id).nodes;
            let mut distances = [branch.arc[i], branch.arc[i + 1]].map(distance);
            if nodes[0] != branch.nodes[i] {
                distances.reverse();
            }
            edges[id.index()] = EdgeData {
                branch: number,
                generation: generations[id.index()],
                strahler: strahler[id.index()],
                nodes: nodes.map(|node| network.node(node).original),
                distances,
            };
        }
    }
    Ok(edges)
}

/// Number of bifurcations between each edge and the nearest inlet.
fn generations(network: &Skeleton, adjacency: &Adjacency, inlets: &BTreeSet<NodeId>) -> Vec<u32> {
    let mut found: Vec<Option<u32>> = vec![None; network.edges.len()];
    // Nodes by the generation of the vessel that leads to them, the lowest first.
    let mut front: VecDeque<(NodeId, u32)> = inlets.iter().map(|&node| (node, 0)).collect();
    while let Some((node, generation)) = front.pop_front() {
        let is_fork = adjacency.valence(node) > 2;
        for &edge in adjacency.edges(node) {
            let own = &mut found[edge.index()];
            if own.is_some() {
                continue;
            }
            *own = Some(generation + u32::from(is_fork));
            let next = (network.edge(edge).other(node), generation + u32::from(is_fork));
            if is_fork { front.push_back(next) } else { front.push_front(next) }
        }
    }
    found.into_iter().map(Option::unwrap_or_default).collect()
}
