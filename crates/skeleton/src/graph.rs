//! Graph structure: adjacency, components, loops.

use super::{Edge, EdgeId, NodeId, Skeleton};

impl NodeId {
    /// Index into `Skeleton::nodes`.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl EdgeId {
    /// Index into `Skeleton::edges`.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl Edge {
    /// Node at the other end; `node` must be one of the two.
    #[inline]
    pub fn other(&self, node: NodeId) -> NodeId {
        if self.nodes[0] == node { self.nodes[1] } else { self.nodes[0] }
    }

    /// End (0 or 1) at `node`.
    #[inline]
    pub fn end(&self, node: NodeId) -> usize {
        usize::from(self.nodes[0] != node)
    }

    /// Mean of the radii at the two ends.
    pub fn mean_radius(&self) -> f64 {
        0.5 * (self.radii[0] + self.radii[1])
    }
}

/// Edges at each node, in ascending order. An edge from a node to itself is listed twice.
///
/// ```
/// use anastomesh_mesh::Point3;
/// use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};
///
/// let node = |x: f64, y: f64, original| Node { position: Point3::new(x, y, 0.0), radius: 1.0, original };
/// let nodes = vec![node(0.0, 0.0, 0), node(9.0, 0.0, 1), node(18.0, 9.0, 2), node(18.0, -9.0, 3)];
/// let edge = |a, b| Edge { nodes: [NodeId(a), NodeId(b)], radii: [1.0; 2] };
/// let fork = Skeleton { nodes, edges: vec![edge(0, 1), edge(1, 2), edge(1, 3)] };
/// let adjacency = fork.adjacency();
/// assert_eq!(adjacency.terminals(), [NodeId(0), NodeId(2), NodeId(3)]);
/// assert_eq!(adjacency.edges(NodeId(1)).len(), 3);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Adjacency {
    /// Start of each node's edges in `edges`, with an end marker.
    offsets: Vec<u32>,
    edges: Vec<EdgeId>,
}

impl Adjacency {
    /// Edges at `node`.
    #[inline]
    pub fn edges(&self, node: NodeId) -> &[EdgeId] {
        &self.edges[self.offsets[node.index()] as usize..self.offsets[node.index() + 1] as usize]
    }

    /// Number of edges at `node`.
    #[inline]
    pub fn valence(&self, node: NodeId) -> usize {
        self.edges(node).len()
    }

    /// Nodes with one edge: terminals and roots, in ascending order.
    pub fn terminals(&self) -> Vec<NodeId> {
        (0..self.offsets.len().saturating_sub(1) as u32).map(NodeId).filter(|&n| self.valence(n) == 1).collect()
    }
}

/// A connected component of a skeleton.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    /// Its nodes, in ascending order.
    pub nodes: Vec<NodeId>,
    /// Its edges, in ascending order.
    pub edges: Vec<EdgeId>,
}

impl Component {
    /// Number of independent loops: edges − nodes + 1.
    pub fn loops(&self) -> usize {
        (self.edges.len() + 1).saturating_sub(self.nodes.len())
    }
}

/// Connected components, in the order of their smallest node.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Components {
    /// The components.
    pub list: Vec<Component>,
    /// Index of each node's component in `list`.
    pub of_node: Vec<u32>,
}

impl Skeleton {
    /// Edges at each node. Edges must refer to existing nodes (`check`).
    pub fn adjacency(&self) -> Adjacency {
        let mut offsets = vec![0_u32; self.nodes.len() + 1];
        for node in self.edges.iter().flat_map(|e| e.nodes) {
            offsets[node.index() + 1] += 1;
        }
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut next = offsets.clone();
        let mut edges = vec![EdgeId(0); 2 * self.edges.len()];
        for (id, edge) in self.edges.iter().enumerate() {
            for node in edge.nodes {
                let slot = &mut next[node.index()];
                edges[*slot as usize] = EdgeId(id as u32);
                *slot += 1;
            }
        }
        Adjacency { offsets, edges }
    }

    /// Connected components.
    pub fn components(&self, adjacency: &Adjacency) -> Components {
        const NONE: u32 = u32::MAX;
        let mut of_node = vec![NONE; self.nodes.len()];
        let mut list: Vec<Component> = Vec::new();
        let mut pending = Vec::new();
        for seed in self.node_ids() {
            if of_node[seed.index()] != NONE {
                continue;
            }
            let id = list.len() as u32;
            list.push(Component { nodes: Vec::new(), edges: Vec::new() });
            of_node[seed.index()] = id;
            pending.push(seed);
            while let Some(node) = pending.pop() {
                for &edge in adjacency.edges(node) {
                    let next = self.edge(edge).other(node);
                    if of_node[next.index()] == NONE {
                        of_node[next.index()] = id;
                        pending.push(next);
                    }
                }
            }
        }
        for node in self.node_ids() {
            list[of_node[node.index()] as usize].nodes.push(node);
        }
        for (id, edge) in self.edges.iter().enumerate() {
            list[of_node[edge.nodes[0].index()] as usize].edges.push(EdgeId(id as u32));
        }
        Components { list, of_node }
    }

    /// The node.
    #[inline]
    pub fn node(&self, id: NodeId) -> &super::Node {
        &self.nodes[id.index()]
    }

    /// The edge.
    #[inline]
    pub fn edge(&self, id: EdgeId) -> &Edge {
        &self.edges[id.index()]
    }

    /// All node ids, in ascending order.
    pub fn node_ids(&self) -> impl ExactSizeIterator<Item = NodeId> + use<> {
        (0..self.nodes.len() as u32).map(NodeId)
    }

    /// All edge ids, in ascending order.
    pub fn edge_ids(&self) -> impl ExactSizeIterator<Item = EdgeId> + use<> {
        (0..self.edges.len() as u32).map(EdgeId)
    }

    /// Radius of the second thickest vessel at a node: that of the lumen shared by a thick side branch and its trunk.
    pub fn shared_radius(&self, adjacency: &Adjacency, node: NodeId) -> f64 {
        let (mut first, mut second) = (0.0_f64, 0.0_f64);
        for &id in adjacency.edges(node) {
            let edge = self.edge(id);
            let radius = edge.radii[edge.end(node)];
            (first, second) = if radius > first { (radius, first) } else { (first, second.max(radius)) };
        }
        second
    }

    /// Returns the length of an edge.
    pub fn length(&self, id: EdgeId) -> f64 {
        let [a, b] = self.edge(id).nodes;
        (self.node(b).position - self.node(a).position).norm()
    }

    /// Inlet of each component: its terminal of largest radius (the smallest id among equals); `None` without
    /// terminals.
    pub fn roots(&self, adjacency: &Adjacency, components: &Components) -> Vec<Option<NodeId>> {
        let mut roots: Vec<Option<NodeId>> = vec![None; components.list.len()];
        for node in adjacency.terminals() {
            let root = &mut roots[components.of_node[node.index()] as usize];
            let radius = |n: NodeId| self.edge(adjacency.edges(n)[0]).radii[self.edge(adjacency.edges(n)[0]).end(n)];
            if root.is_none_or(|best| radius(node) > radius(best)) {
                *root = Some(node);
            }
        }
        roots
    }
}
