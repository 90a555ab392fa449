//! Second-order meshes from elements with node numbers, as files have them.

use super::edges::{Edges, FACE_EDGES, TET_EDGES, edge_key};
use super::midpoints::SecondOrder;
use crate::geometry::Point3;

/// Elements with ten nodes and faces with six, in VTK's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuadraticMesh {
    /// Positions of all nodes.
    pub points: Vec<Point3>,
    /// Nodes of each element.
    pub tets: Vec<[u32; 10]>,
    /// Nodes of each face.
    pub faces: Vec<[u32; 6]>,
}

/// Linear mesh of the corners of a [`QuadraticMesh`], and its midpoints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuadraticParts {
    /// Corners, and nodes of no cell, in the order of the nodes.
    pub points: Vec<Point3>,
    /// Corners of each element.
    pub tets: Vec<[u32; 4]>,
    /// Corners of each face.
    pub faces: Vec<[u32; 3]>,
    /// Midpoints of the edges.
    pub second: SecondOrder,
}

impl QuadraticMesh {
    /// Separates corners and midpoints. `None` if a cell refers to a missing node.
    pub fn parts(&self) -> Option<QuadraticParts> {
        let count = self.points.len();
        let (mut is_corner, mut is_middle) = (vec![false; count], vec![false; count]);
        let mut middles = Vec::with_capacity(6 * self.tets.len() + 3 * self.faces.len());
        let mut add = |nodes: &[u32], corners: usize, edges: &[[usize; 2]]| -> Option<()> {
            for (i, &node) in nodes.iter().enumerate() {
                let mark = if i < corners { &mut is_corner } else { &mut is_middle };
                *mark.get_mut(node as usize)? = true;
            }
            let pair = |&[i, j]: &[usize; 2]| edge_key(nodes[i], nodes[j]);
            middles.extend(edges.iter().zip(&nodes[corners..]).map(|(ends, &node)| (pair(ends), node)));
            Some(())
        };
        self.tets.iter().try_for_each(|nodes| add(nodes, 4, &TET_EDGES))?;
        self.faces.iter().try_for_each(|nodes| add(nodes, 3, &FACE_EDGES))?;
        middles.sort_unstable();
        middles.dedup();
        let (numbers, points) = self.corners(&is_corner, &is_middle);
        let of = |v: u32| numbers[v as usize];
        let runs = || middles.chunk_by(|a, b| a.0 == b.0);
        // Corners keep their order, so that the edges stay ascending.
        let list = runs().map(|run| run[0].0.map(of)).collect();
        let second = SecondOrder {
            edges: Edges::of_sorted(list, points.len()),
            middles: runs().map(|run| self.points[run[0].1 as usize]).collect(),
            split: (0..).zip(runs()).filter(|(_, run)| run.len() > 1).map(|(edge, _)| edge).collect(),
        };
        let tets = self.tets.iter().map(|&[a, b, c, d, ..]| [a, b, c, d].map(of)).collect();
        let faces = self.faces.iter().map(|&[a, b, c, ..]| [a, b, c].map(of)).collect();
        Some(QuadraticParts { points, tets, faces, second })
    }

    /// New number of each corner and each unused node, and their positions.
    fn corners(&self, is_corner: &[bool], is_middle: &[bool]) -> (Vec<u32>, Vec<Point3>) {
        let mut points = Vec::new();
        let mut numbers = Vec::with_capacity(self.points.len());
        for (node, &point) in self.points.iter().enumerate() {
            numbers.push(points.len() as u32);
            if is_corner[node] || !is_middle[node] {
                points.push(point);
            }
        }
        (numbers, points)
    }
}
