//! Net of the gyroid (K4, srs). Every node has three straight edges of equal length, in one plane at 120 degrees, and
//! the shortest loops have ten edges. Capillaries are similar: they meet in threes, form loops and fill space evenly
//! (Blinder et al., 'The cortical angiome', Nat. Neurosci. 16 (2013)).

use anastomesh_mesh::geometry::{Point3, Vec3};

/// Nodes of one cell, in cell edges.
const CELL: [[f64; 3]; 8] = [
    [0.125, 0.125, 0.125],
    [0.375, 0.875, 0.625],
    [0.875, 0.625, 0.375],
    [0.625, 0.375, 0.875],
    [0.625, 0.625, 0.625],
    [0.875, 0.375, 0.125],
    [0.375, 0.125, 0.875],
    [0.125, 0.875, 0.375],
];

/// Edge length in cell edges: √2 / 4.
const EDGE: f64 = 0.25 * std::f64::consts::SQRT_2;

/// Nodes per cubed edge length.
pub const DENSITY: f64 = 8.0 * EDGE * EDGE * EDGE;

/// Net in a box around the origin.
#[derive(Debug)]
pub struct Net {
    cell: f64,
    /// Number of cells from the origin to either side, along each axis.
    reach: [i64; 3],
    /// Neighbours of each node of a cell: node index and cell offset.
    joined: [[(usize, [i64; 3]); 3]; 8],
}

impl Net {
    /// Creates a net with this edge length in a box with these half extents.
    pub fn new(edge: f64, half: &Vec3) -> Self {
        let cell = edge / EDGE;
        let reach = [0, 1, 2].map(|axis| (half[axis] / cell).ceil() as i64);
        Self { cell, reach, joined: std::array::from_fn(neighbours) }
    }

    fn extent(&self, axis: usize) -> u64 {
        2 * self.reach[axis] as u64
    }

    /// Number of nodes in the box.
    pub fn len(&self) -> u64 {
        8 * self.extent(0) * self.extent(1) * self.extent(2)
    }

    fn cell_of(&self, place: u64) -> ([i64; 3], usize) {
        let (cell, node) = (place / 8, (place % 8) as usize);
        let (x, rest) = (cell % self.extent(0), cell / self.extent(0));
        let (y, z) = (rest % self.extent(1), rest / self.extent(1));
        let [a, b, c] = self.reach;
        ([x as i64 - a, y as i64 - b, z as i64 - c], node)
    }

    /// Position of a node.
    pub fn point(&self, place: u64) -> Point3 {
        let (cell, node) = self.cell_of(place);
        Point3::from([0, 1, 2].map(|axis| (cell[axis] as f64 + CELL[node][axis]) * self.cell))
    }

    /// The three neighbours of a node; `None` outside the box.
    pub fn joined(&self, place: u64) -> [Option<u64>; 3] {
        let (cell, node) = self.cell_of(place);
        self.joined[node].map(|(other, step)| {
            let at = [0, 1, 2].map(|axis| cell[axis] + step[axis] + self.reach[axis]);
            let inside = (0..3).all(|axis| (0..self.extent(axis) as i64).contains(&at[axis]));
            let [x, y, z] = at.map(|i| i as u64);
            inside.then(|| 8 * (x + self.extent(0) * (y + self.extent(1) * z)) + other as u64)
        })
    }
}

fn neighbours(node: usize) -> [(usize, [i64; 3]); 3] {
    let mut found = [(0, [0; 3]); 3];
    let mut count = 0;
    for (other, place) in CELL.iter().enumerate() {
        // Offset of the nearest copy.
        let step = [0, 1, 2].map(|axis| -(place[axis] - CELL[node][axis]).round() as i64);
        let way = [0, 1, 2].map(|axis| place[axis] + step[axis] as f64 - CELL[node][axis]);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (length - EDGE).abs() < 1e-9 && count < 3 {
            found[count] = (other, step);
            count += 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_edges_of_one_length_at_120_degrees_leave_each_node() {
        let net = Net::new(60.0, &Vec3::new(400.0, 300.0, 500.0));
        let mut inner = 0.0;
        for place in 0..net.len() {
            let here = net.point(place);
            let joined = net.joined(place);
            let ways: Vec<Vec3> = joined.iter().flatten().map(|&other| net.point(other) - here).collect();
            assert!(ways.iter().all(|way| (way.norm() - 60.0).abs() < 1e-9));
            assert!(joined.iter().flatten().all(|&other| net.joined(other).contains(&Some(place))));
            if let [a, b, c] = ways[..] {
                inner += 1.0;
                assert!((a + b + c).norm() < 1e-9);
            }
        }
        assert!(inner > 0.7 * net.len() as f64);
        let volume = (0..3).map(|axis| net.extent(axis) as f64 * net.cell).product::<f64>();
        assert!((net.len() as f64 / volume * 60.0_f64.powi(3) / DENSITY - 1.0).abs() < 1e-9);
    }
}
