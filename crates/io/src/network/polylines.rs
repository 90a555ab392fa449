//! Polylines over points become nodes and edges, with the radii that the file has: for nodes, for lines, or for each point
//! of each line.

use super::content::{NetworkFile, NetworkNote};
use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::{Edge, LineGroup, Node, NodeId, Skeleton};

/// Vessels as lines through points.
#[derive(Debug, Default)]
pub(super) struct Polylines {
    pub points: Vec<Point3>,
    /// Where each line ends in `path`, ascending.
    pub ends: Vec<usize>,
    /// The points of all lines, one line after the other; each exists.
    pub path: Vec<u32>,
}

/// The radii that a file has; where there are several, those of `corners` go before those of `lines`, and these before those
/// of `nodes`.
#[derive(Debug, Default)]
pub(super) struct Radii {
    /// One per point.
    pub nodes: Option<Vec<f64>>,
    /// One per line.
    pub lines: Option<Vec<f64>>,
    /// One per entry of the path.
    pub corners: Option<Vec<f64>>,
}

/// A line that names a point that does not exist.
#[derive(Debug)]
pub(super) struct Astray {
    /// The line, from 0.
    pub line: usize,
    /// What it names.
    pub point: i64,
}

impl Polylines {
    /// Lines whose points are looked at first.
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

    /// Whether what this adds to a network can be numbered.
    pub(super) fn fits(&self, skeleton: &Skeleton) -> bool {
        let most = u32::MAX as usize;
        skeleton.nodes.len() + self.points.len() < most && skeleton.edges.len() + self.path.len() < most
    }

    /// The groups of the points, by those of the lines and whether these are blanked: of points on lines of several
    /// groups, none.
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

    /// Adds nodes and edges to a network.
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

/// Points on no line get any legal radius: cleaning drops them.
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

/// Tells which vessels the lines of a network are drawn for, if its file says so of any.
pub(super) fn tell_groups(network: &mut NetworkFile) {
    let mut vessels: Vec<i64> = network.groups.iter().flatten().filter(|g| !g.blanked).map(|g| g.group).collect();
    vessels.sort_unstable();
    vessels.dedup();
    if !vessels.is_empty() {
        network.notes.push(NetworkNote::Grouped { vessels: vessels.len() });
    }
}
