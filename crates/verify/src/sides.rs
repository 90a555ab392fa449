//! Faces of tetrahedra and edges of triangles, sorted so that equal ones are neighbours.

use itertools::Itertools as _;

/// Faces of a positive tetrahedron, oriented outwards.
pub const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
/// Edges of a triangle.
pub const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Side of a cell: its sorted vertices, and the number of the cell times the sides of a cell plus that of the side.
pub type Side<const N: usize> = ([u32; N], u32);

/// Sides of all cells, sorted. A side has `N` vertices, and a cell has `M` vertices and sides.
pub struct Sides<'a, const N: usize, const M: usize> {
    cells: &'a [[u32; M]],
    corners: [[usize; N]; M],
    sorted: Vec<Side<N>>,
}

impl<'a, const N: usize, const M: usize> Sides<'a, N, M> {
    pub fn new(cells: &'a [[u32; M]], corners: [[usize; N]; M]) -> Self {
        let mut sides = Self { cells, corners, sorted: Vec::new() };
        let side = |handle| (key(sides.vertices(handle)), handle);
        sides.sorted = (0..(M * cells.len()) as u32).map(side).sorted_unstable().collect();
        sides
    }

    /// Vertices of a side in the direction of its cell.
    pub fn vertices(&self, handle: u32) -> [u32; N] {
        self.corners[handle as usize % M].map(|i| self.cells[handle as usize / M][i])
    }

    /// True if the direction of a side is opposite to that of its sorted vertices.
    pub fn is_odd(&self, side: &Side<N>) -> bool {
        is_odd(self.vertices(side.1))
    }

    /// Sides with the same vertices, in ascending order.
    pub fn groups(&self) -> impl Iterator<Item = &[Side<N>]> {
        self.sorted.chunk_by(|a, b| a.0 == b.0)
    }

    /// Sides with these vertices.
    pub fn of(&self, vertices: [u32; N]) -> &[Side<N>] {
        let key = key(vertices);
        let from = &self.sorted[self.sorted.partition_point(|side| side.0 < key)..];
        &from[..from.partition_point(|side| side.0 == key)]
    }
}

/// Vertices in ascending order.
pub fn key<const N: usize>(mut vertices: [u32; N]) -> [u32; N] {
    vertices.sort_unstable();
    vertices
}

/// True if sorting the vertices is an odd permutation.
pub fn is_odd<const N: usize>(vertices: [u32; N]) -> bool {
    let pairs = (1..N).flat_map(|j| (0..j).map(move |i| [i, j]));
    pairs.fold(false, |is_odd, [i, j]| is_odd ^ (vertices[i] > vertices[j]))
}

#[cfg(test)]
mod tests {
    use super::is_odd;

    #[test]
    fn orders_of_vertices_are_odd_or_even() {
        assert_eq!([[1, 2, 3], [2, 3, 1], [3, 1, 2]].map(is_odd), [false; 3]);
        assert_eq!([[1, 3, 2], [3, 2, 1], [2, 1, 3]].map(is_odd), [true; 3]);
        // Equal vertices keep their order.
        assert_eq!(
            [[1, 1, 2], [2, 1, 2], [1, 2, 1], [1, 2, 2], [1, 1, 1]].map(is_odd),
            [false, true, true, false, false]
        );
    }
}
