//! Conversion of polylines to nodes and edges. Radii belong to nodes, to lines, or to each point of each line.

use super::content::{NetworkFile, NetworkNote};
use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::{Edge, LineGroup, Node, NodeId, Skeleton};

/// Vessels as polylines.
#[derive(Debug, Default)]
pub(super) struct Polylines {
    pub points: Vec<Point3>,
    /// End offset of each line in `path`, ascending.
    pub ends: Vec<usize>,
    /// Valid point indices of all lines, one line after the other.
    pub path: Vec<u32>,
}

/// Radii of a file. If several exist, `corners` has priority over `lines`, and `lines` over `nodes`.
#[derive(Debug, Default)]
pub(super) struct Radii {
    /// One per point.
    pub nodes: Option<Vec<f64>>,
    /// One per line.
    pub lines: Option<Vec<f64>>,
    /// One per entry of the path.
    pub corners: Option<Vec<f64>>,
}

/// Line that refers to a missing point.
#[derive(Debug)]
pub(super) struct Astray {
    /// Line index, from 0.
    pub line: usize,
    /// Invalid point index.
    pub point: i64,
}

impl Polylines {
    /// Creates polylines after a check of the point indices.
    pub(super) fn checked(points: Vec<Point3>, ends: Vec<usize>, connectivity: &[i64]) -> Result<Self, Astray> {
        let mut path = Vec::with_capacity(connectivity.len());
        let mut start = 0;
        for (line, &end) in ends.iter().enumerate() {
            for &point in &connectivity[start..end] {
                if point < 0 || point >= points.len() as i64 {
                    return Err(Astray { line, point });
                }
                path.push(point as u32);
            }
            start = end;
        }
        Ok(Self { points, ends, path })
    }

    /// True if the network can hold these polylines without index overflow.
    pub(super) fn fits(&self, skeleton: &Skeleton) -> bool {
        let most = u32::MAX as usize;
        skeleton.nodes.len() + self.points.len() < most && skeleton.edges.len() + self.path.len() < most
    }

    /// Groups of the points, from the group and blanking of their lines. `None` for points on lines of several groups.
    pub(super) fn groups(&self, of_lines: &[[i64; 2]]) -> Vec<Option<LineGroup>> {
        let mut seen: Vec<Option<Option<LineGroup>>> = vec![None; self.points.len()];
        let mut start = 0;
        for (&end, &[group, blanked]) in self.ends.iter().zip(of_lines) {
            let group = Some(LineGroup { group, blanked: blanked != 0 });
            for &point in &self.path[start..end] {
                let seen = &mut seen[point as usize];
                *seen = Some(if seen.is_none_or(|s| s == group) { group } else { None });
            }
            start = end;
        }
        seen.into_iter().map(Option::flatten).collect()
    }

    /// Appends nodes and edges to a network.
    pub(super) fn append_to(&self, skeleton: &mut Skeleton, radii: &Radii) {
        let (base, first_edge) = (skeleton.nodes.len(), skeleton.edges.len());
        for (i, &position) in self.points.iter().enumerate() {
            let radius = radii.nodes.as_ref().map_or(0.0, |r| r[i]);
            skeleton.nodes.push(Node { position, radius, original: (base + i) as u32 });
        }
        let mut start = 0;
        for (line, &end) in self.ends.iter().enumerate() {
            for at in start..end.saturating_sub(1) {
                let nodes = [self.path[at], self.path[at + 1]].map(|p| NodeId(base as u32 + p));
                let radii = match (&radii.corners, &radii.lines) {
                    (Some(corners), _) => [corners[at], corners[at + 1]],
                    (None, Some(lines)) => [lines[line]; 2],
                    (None, None) => nodes.map(|n| skeleton.node(n).radius),
                };
                skeleton.edges.push(Edge { nodes, radii });
            }
            start = end;
        }
        if radii.nodes.is_none() {
            node_radii_from_edges(&mut skeleton.nodes[base..], base, &skeleton.edges[first_edge..]);
        }
    }
}

/// Sets node radii from edges. Points on no line keep any radius, as cleaning removes them.
fn node_radii_from_edges(nodes: &mut [Node], base: usize, edges: &[Edge]) {
    for edge in edges {
        for (id, radius) in edge.nodes.into_iter().zip(edge.radii) {
            let node = &mut nodes[id.index() - base];
            node.radius = node.radius.max(radius);
        }
    }
    for node in nodes.iter_mut().filter(|n| n.radius <= 0.0) {
        node.radius = 1.0;
    }
}

/// Notes the number of vessels if the file assigns lines to vessels.
pub(super) fn tell_groups(network: &mut NetworkFile) {
    let mut vessels: Vec<i64> = network.groups.iter().flatten().filter(|g| !g.blanked).map(|g| g.group).collect();
    vessels.sort_unstable();
    vessels.dedup();
    if !vessels.is_empty() {
        network.notes.push(NetworkNote::Grouped { vessels: vessels.len() });
    }
}
