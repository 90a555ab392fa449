//! Networks of vessels and their VTP files.

use crate::vector::Vector;
use std::fmt::Write as _;

/// Vessel network: nodes, and edges with a radius at both ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Network {
    /// Node positions.
    pub points: Vec<Vector>,
    /// Node radii.
    pub radii: Vec<f64>,
    /// Pairs of nodes.
    pub edges: Vec<[usize; 2]>,
    /// Constant radius of each edge, instead of the radii of nodes.
    pub edge_radii: Option<Vec<f64>>,
}

impl Network {
    /// Adds a node and returns its number.
    pub fn node(&mut self, point: Vector, radius: f64) -> usize {
        self.points.push(point);
        self.radii.push(radius);
        self.points.len() - 1
    }

    /// Adds an edge.
    pub fn edge(&mut self, a: usize, b: usize) {
        self.edges.push([a, b]);
        if let Some(radii) = &mut self.edge_radii {
            radii.push(self.radii[a].min(self.radii[b]));
        }
    }

    /// Adds a node at the end of an edge from `from`, and returns its number.
    pub fn tip(&mut self, from: usize, point: Vector, radius: f64) -> usize {
        let tip = self.node(point, radius);
        self.edge(from, tip);
        tip
    }

    /// Adds an edge with a radius of its own. Earlier edges have the smaller radius of their ends.
    pub fn edge_of_radius(&mut self, a: usize, b: usize, radius: f64) {
        if self.edge_radii.is_none() {
            let smaller = |&[a, b]: &[usize; 2]| self.radii[a].min(self.radii[b]);
            self.edge_radii = Some(self.edges.iter().map(smaller).collect());
        }
        self.edges.push([a, b]);
        self.edge_radii.get_or_insert_default().push(radius);
    }

    /// Adds a polyline along a curve with parameter 0 to 1, and returns its nodes.
    pub fn line(&mut self, count: u32, radius: f64, place: impl Fn(f64) -> Vector) -> Vec<usize> {
        let ids: Vec<usize> = (0..=count).map(|i| self.node(place(f64::from(i) / f64::from(count)), radius)).collect();
        ids.windows(2).for_each(|pair| self.edge(pair[0], pair[1]));
        ids
    }

    /// Multiplies positions and radii.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.points.iter_mut().for_each(|p| *p = p.map(|x| x * factor));
        self.radii.iter_mut().chain(self.edge_radii.iter_mut().flatten()).for_each(|r| *r *= factor);
        self
    }

    /// Network with the selected edges and their nodes.
    pub fn with_edges(&self, kept: &[bool]) -> Self {
        let mut used = vec![false; self.points.len()];
        let edges = || self.edges.iter().zip(kept).filter(|(_, kept)| **kept).map(|(edge, _)| edge);
        edges().flatten().for_each(|node| used[*node] = true);
        let mut out = Self { edge_radii: self.edge_radii.as_ref().map(|_| Vec::new()), ..Self::default() };
        let mut number = vec![usize::MAX; self.points.len()];
        for node in (0..self.points.len()).filter(|node| used[*node]) {
            number[node] = out.node(self.points[node], self.radii[node]);
        }
        out.edges = edges().map(|edge| edge.map(|node| number[node])).collect();
        if let Some(radii) = &self.edge_radii {
            out.edge_radii = Some(radii.iter().zip(kept).filter(|(_, kept)| **kept).map(|(r, _)| *r).collect());
        }
        out
    }

    /// Network in which node `b` is node `a`; edges between both are removed.
    pub fn merged(&self, a: usize, b: usize) -> Self {
        let mut out = self.clone();
        out.edges.iter_mut().flatten().filter(|node| **node == b).for_each(|node| *node = a);
        let kept: Vec<bool> = out.edges.iter().map(|[a, b]| a != b).collect();
        out.with_edges(&kept)
    }

    /// VTP file in text, with every bit of every number.
    pub fn vtp(&self) -> String {
        let (nodes, edges) = (self.points.len(), self.edges.len());
        let mut out = format!(
            "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"{nodes}\" NumberOfLines=\"{edges}\">\n"
        );
        let numbers = |list: &[f64]| list.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ");
        let (data, name, values) = match &self.edge_radii {
            Some(radii) => ("CellData", "EdgeRadius", numbers(radii)),
            None => ("PointData", "Radius", numbers(&self.radii)),
        };
        let _ = writeln!(
            out,
            "<{data}><DataArray type=\"Float64\" Name=\"{name}\" format=\"ascii\">{values}</DataArray></{data}>"
        );
        out += "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";
        self.points.iter().for_each(|p| out += &(numbers(p) + "\n"));
        out += "</DataArray></Points>\n<Lines><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n";
        for [a, b] in &self.edges {
            let _ = writeln!(out, "{a} {b}");
        }
        out += "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
        out += &(1..=edges).map(|i| (2 * i).to_string()).collect::<Vec<_>>().join(" ");
        out + "\n</DataArray></Lines></Piece></PolyData></VTKFile>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_removed_with_their_nodes() {
        let mut net = Network::default();
        let ids = net.line(3, 1.0, |t| [t, 0.0, 0.0]);
        net.edge_of_radius(ids[0], ids[3], 0.5);
        let fewer = net.with_edges(&[false, true, false, false]);
        assert_eq!((fewer.points.len(), fewer.edges.len()), (2, 1));
        assert_eq!(fewer.edge_radii, Some(vec![1.0]));
        assert_eq!(net.merged(ids[0], ids[1]).edges.len(), 3);
    }
}
