//! Distinct edges of a mesh, numbered in ascending order.

use rayon::prelude::*;

/// Corners of the edges of a tetrahedron, in the order of its midpoints (VTK's order).
pub const TET_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Corners of the edges of a triangle, in the order of its midpoints.
pub const FACE_EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Ends of an edge in ascending order.
pub(super) fn edge_key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Distinct edges of tetrahedra and faces, with a search by their ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Edges {
    /// Ends of each edge, ascending; the edges are ascending, too.
    list: Vec<[u32; 2]>,
    /// First edge of each smaller end, and the number of all edges.
    starts: Vec<u32>,
}

impl Edges {
    /// Edges of cells over `vertices` vertices. Cells must refer to these vertices only.
    pub fn of_cells(tets: &[[u32; 4]], faces: &[[u32; 3]], vertices: usize) -> Self {
        let of_tets = tets.par_iter().flat_map_iter(|t| TET_EDGES.map(|[i, j]| edge_key(t[i], t[j])));
        let mut list: Vec<[u32; 2]> = of_tets.collect();
        list.par_extend(faces.par_iter().flat_map_iter(|f| FACE_EDGES.map(|[i, j]| edge_key(f[i], f[j]))));
        list.par_sort_unstable();
        list.dedup();
        list.shrink_to_fit();
        Self::of_sorted(list, vertices)
    }

    /// Edges from an ascending list without repetitions.
    pub fn of_sorted(list: Vec<[u32; 2]>, vertices: usize) -> Self {
        let mut starts = vec![0_u32; vertices + 1];
        for &[a, _] in &list {
            starts[a as usize + 1] += 1;
        }
        for v in 0..vertices {
            starts[v + 1] += starts[v];
        }
        Self { list, starts }
    }

    /// Ends of each edge.
    pub fn list(&self) -> &[[u32; 2]] {
        &self.list
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Number of the edge between two vertices.
    pub fn find(&self, a: u32, b: u32) -> Option<u32> {
        let [low, high] = edge_key(a, b);
        let range = *self.starts.get(low as usize)? as usize..*self.starts.get(low as usize + 1)? as usize;
        let at = self.list[range.clone()].binary_search_by_key(&high, |edge| edge[1]).ok()?;
        Some((range.start + at) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cube_lattice;

    #[test]
    fn edges_are_ascending_and_found_by_their_ends() {
        let mesh = cube_lattice(2);
        let edges = Edges::of_cells(&mesh.tets, &[], mesh.points.len());
        assert!(edges.list().is_sorted_by(|a, b| a < b));
        for (i, &[a, b]) in (0..).zip(edges.list()) {
            assert_eq!(edges.find(b, a), Some(i));
        }
        // Kuhn's cube has 19 edges; 26 opposite corners of the whole are not joined.
        assert_eq!(edges.find(0, 26), None);
        assert_eq!(edges.find(40, 41), None);
        assert_eq!(Edges::of_cells(&cube_lattice(1).tets, &[], 8).list().len(), 19);
    }
}
