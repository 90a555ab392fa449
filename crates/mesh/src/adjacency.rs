//! Adjacency: face neighbours of tetrahedra, the boundary, edge neighbours of triangles, and cells and vertices around
//! a vertex. Flat arrays of `u32`; a counting sort by the smallest vertex replaces a hash table.

use super::TET_FACES;
use super::face_key;

/// Marks a missing neighbour.
pub const NONE: u32 = u32::MAX;

/// Items around each of `n` others: the entries of item `i` are `items[offsets[i]..offsets[i + 1]]`, ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Incidence {
    offsets: Vec<u32>,
    items: Vec<u32>,
}

impl Incidence {
    /// Cells (rows of `cells`) at each of `vertices` vertices, in ascending order.
    pub fn of_cells<const N: usize>(cells: &[[u32; N]], vertices: usize) -> Self {
        let mut offsets = vec![0_u32; vertices + 1];
        for &v in cells.iter().flatten() {
            offsets[v as usize + 1] += 1;
        }
        for i in 0..vertices {
            offsets[i + 1] += offsets[i];
        }
        let mut items = vec![0; cells.len() * N];
        for (cell, corners) in cells.iter().enumerate() {
            for &v in corners {
                items[offsets[v as usize] as usize] = cell as u32;
                offsets[v as usize] += 1;
            }
        }
        // Filling moved each offset to the start of the next item.
        offsets.rotate_right(1);
        offsets[0] = 0;
        Self { offsets, items }
    }

    /// Distinct vertices that share a cell with each vertex, in ascending order.
    pub fn of_vertices<const N: usize>(cells: &[[u32; N]], vertices: usize) -> Self {
        let around = Self::of_cells(cells, vertices);
        let mut offsets = Vec::with_capacity(vertices + 1);
        let mut items = Vec::with_capacity(cells.len() * N);
        let mut row = Vec::new();
        offsets.push(0);
        for v in 0..vertices {
            row.clear();
            let corners = around.get(v as u32).iter().flat_map(|&cell| cells[cell as usize]);
            row.extend(corners.filter(|&w| w as usize != v));
            row.sort_unstable();
            row.dedup();
            items.extend_from_slice(&row);
            offsets.push(items.len() as u32);
        }
        Self { offsets, items }
    }

    /// Entries of item `i`.
    #[inline]
    pub fn get(&self, i: u32) -> &[u32] {
        &self.items[self.offsets[i as usize] as usize..self.offsets[i as usize + 1] as usize]
    }
}

/// Sides of cells matched in pairs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matching<const SIDES: usize> {
    /// Neighbour of side `i` of a cell: `SIDES · neighbour + its side`, or `NONE` if no other cell has the side. Sides
    /// of more than two cells are `NONE`, too, and listed in `crowded`.
    pub neighbors: Vec<[u32; SIDES]>,
    /// Sides (`SIDES · cell + side`) of more than two cells, in ascending order.
    pub crowded: Vec<u32>,
}

/// Face neighbours of tetrahedra; face `i` lies opposite vertex `i` (`TET_FACES`).
pub type TetAdjacency = Matching<4>;

/// Edge neighbours of triangles; edge `i` runs from vertex `i` to vertex `i + 1`.
pub type TriAdjacency = Matching<3>;

/// Matches the faces of tetrahedra over `vertices` vertices. Linear time, at most 24 bytes per face.
pub fn tet_adjacency(tets: &[[u32; 4]], vertices: usize) -> TetAdjacency {
    let numbered = is_scattered(tets, vertices).then(|| numbered_as_met(tets, vertices));
    let tets = numbered.as_deref().unwrap_or(tets);
    match_sides(tets.len(), vertices, |handle| {
        let [i, j, k] = TET_FACES[(handle & 3) as usize];
        let t = &tets[(handle >> 2) as usize];
        face_key([t[i], t[j], t[k]])
    })
}

/// True if consecutive cells have distant vertex numbers, estimated from about 1000 samples.
fn is_scattered(cells: &[[u32; 4]], vertices: usize) -> bool {
    const SAMPLE: usize = 1024;
    let pairs = || cells.windows(2).step_by((cells.len() / SAMPLE).max(1));
    let apart: usize = pairs().map(|pair| pair[0][0].abs_diff(pair[1][0]) as usize).sum();
    apart / pairs().count().max(1) > (vertices / 32).max(SAMPLE)
}

/// Copies cells with vertices numbered by first occurrence. Access is several times faster than with scattered numbers.
fn numbered_as_met(cells: &[[u32; 4]], vertices: usize) -> Vec<[u32; 4]> {
    let mut number = vec![NONE; vertices];
    let mut met = 0;
    let mut number_of = |v: u32| {
        let number = &mut number[v as usize];
        if *number == NONE {
            *number = met;
            met += 1;
        }
        *number
    };
    cells.iter().map(|cell| cell.map(&mut number_of)).collect()
}

/// Matches the edges of triangles over `vertices` vertices.
pub fn tri_adjacency(triangles: &[[u32; 3]], vertices: usize) -> TriAdjacency {
    match_sides(triangles.len(), vertices, |handle| {
        let t = &triangles[handle as usize / 3];
        let i = handle as usize % 3;
        let (a, b) = (t[i], t[(i + 1) % 3]);
        [a.min(b), a.max(b), 0]
    })
}

/// Matches sides by their vertices in ascending order (padded at the end).
fn match_sides<const SIDES: usize>(cells: usize, vertices: usize, key: impl Fn(u32) -> [u32; 3]) -> Matching<SIDES> {
    let sides = (cells * SIDES) as u32;
    let mut offsets = vec![0_u32; vertices + 1];
    for handle in 0..sides {
        offsets[key(handle)[0] as usize + 1] += 1;
    }
    for i in 0..vertices {
        offsets[i + 1] += offsets[i];
    }
    let mut bucketed = vec![0_u32; sides as usize];
    for handle in 0..sides {
        let slot = &mut offsets[key(handle)[0] as usize];
        bucketed[*slot as usize] = handle;
        *slot += 1;
    }
    let mut matching = Matching { neighbors: vec![[NONE; SIDES]; cells], crowded: Vec::new() };
    let mut bucket = Bucket { sides: Vec::new(), newest: vec![NONE; vertices] };
    let mut start = 0;
    for &end in &offsets[..vertices] {
        for &handle in &bucketed[start as usize..end as usize] {
            let [_, middle, last] = key(handle);
            bucket.link(middle, last, handle, &mut matching);
        }
        bucket.clear();
        start = end;
    }
    matching.crowded.sort_unstable();
    matching
}

/// Sides met so far with a common smallest vertex, chained by their middle vertex, which few share.
struct Bucket {
    sides: Vec<Side>,
    /// Newest side with each vertex as middle vertex.
    newest: Vec<u32>,
}

struct Side {
    middle: u32,
    last: u32,
    handle: u32,
    /// Preceding side in its chain.
    older: u32,
}

impl Bucket {
    /// Adds a side and links it to an equal one met before; lists sides of more than two cells.
    fn link<const SIDES: usize>(&mut self, middle: u32, last: u32, handle: u32, matching: &mut Matching<SIDES>) {
        let older = self.newest[middle as usize];
        let (mut equal, mut count) = ([NONE; 2], 0);
        let mut at = older;
        while let Some(side) = self.sides.get(at as usize) {
            if side.last == last {
                equal[count.min(1)] = side.handle;
                count += 1;
            }
            at = side.older;
        }
        let slot = |side: u32| (side as usize / SIDES, side as usize % SIDES);
        let mut glue = |side: u32, other: u32| matching.neighbors[slot(side).0][slot(side).1] = other;
        match count {
            0 => {}
            1 => {
                glue(equal[0], handle);
                glue(handle, equal[0]);
            }
            2 => {
                glue(equal[0], NONE);
                glue(equal[1], NONE);
                matching.crowded.extend([equal[0], equal[1], handle]);
            }
            _ => matching.crowded.push(handle),
        }
        self.newest[middle as usize] = self.sides.len() as u32;
        self.sides.push(Side { middle, last, handle, older });
    }

    fn clear(&mut self) {
        for side in &self.sides {
            self.newest[side.middle as usize] = NONE;
        }
        self.sides.clear();
    }
}

impl TetAdjacency {
    /// Faces (`4 · tet + face`) of only one tetrahedron, in ascending order.
    pub fn boundary(&self) -> impl Iterator<Item = u32> {
        let open = self.neighbors.iter().flatten().enumerate().filter(|&(_, &n)| n == NONE);
        open.map(|(handle, _)| handle as u32).filter(|handle| self.crowded.binary_search(handle).is_err())
    }
}

/// Vertices of face `handle` = `4 · tet + face`, counter-clockwise seen from outside the tetrahedron.
#[inline]
pub fn face_vertices(tets: &[[u32; 4]], handle: u32) -> [u32; 3] {
    TET_FACES[(handle & 3) as usize].map(|i| tets[(handle >> 2) as usize][i])
}

/// Boundary faces of a mesh, oriented outwards, in ascending order of tetrahedron and face.
pub fn boundary_faces(mesh: &super::TetMesh) -> Vec<[u32; 3]> {
    let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
    adjacency.boundary().map(|handle| face_vertices(&mesh.tets, handle)).collect()
}

/// True for each of `vertices` vertices that occurs in `faces`.
pub fn vertices_of<const N: usize>(faces: &[[u32; N]], vertices: usize) -> Vec<bool> {
    let mut on = vec![false; vertices];
    for &v in faces.iter().flatten() {
        on[v as usize] = true;
    }
    on
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube_lattice, sphere_surface};
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    #[test]
    fn two_tetrahedra_share_one_face() {
        let tets = [[0, 1, 2, 3], [1, 2, 3, 4]];
        let adjacency = tet_adjacency(&tets, 5);
        assert_eq!(adjacency.neighbors, vec![[4 + 3, NONE, NONE, NONE], [NONE, NONE, NONE, 0]]);
        assert_eq!(adjacency.boundary().collect::<Vec<_>>(), vec![1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn a_face_of_three_tetrahedra_is_crowded_and_not_boundary() {
        let tets = [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]];
        let adjacency = tet_adjacency(&tets, 6);
        assert_eq!(adjacency.crowded, vec![3, 7, 11]);
        assert_eq!(adjacency.boundary().count(), 9);
        assert!(adjacency.neighbors.iter().flatten().all(|&n| n == NONE));
    }

    #[test]
    fn the_boundary_of_a_cube_is_closed_and_points_outwards() {
        let mesh = cube_lattice(4);
        let faces = boundary_faces(&mesh);
        assert_eq!(faces.len(), 6 * 4 * 4 * 2);
        let volume: f64 = faces
            .iter()
            .map(|f| {
                let [a, b, c] = f.map(|v| mesh.points[v as usize].coords);
                a.cross(&b).dot(&c) / 6.0
            })
            .sum();
        assert!((volume - 1.0).abs() < 1e-12);
        let edges = tri_adjacency(&faces, mesh.points.len());
        assert!(edges.crowded.is_empty() && edges.neighbors.iter().flatten().all(|&n| n != NONE));
    }

    #[test]
    fn triangle_neighbors_run_along_the_shared_edge_the_other_way() {
        let mesh = sphere_surface(2);
        let adjacency = tri_adjacency(&mesh.triangles, mesh.points.len());
        for (t, row) in adjacency.neighbors.iter().enumerate() {
            for (i, &n) in row.iter().enumerate() {
                let (u, j) = (n as usize / 3, n as usize % 3);
                assert_eq!(mesh.triangles[t][i], mesh.triangles[u][(j + 1) % 3]);
                assert_eq!(mesh.triangles[t][(i + 1) % 3], mesh.triangles[u][j]);
            }
        }
    }

    #[test]
    fn incidence_lists_are_complete_and_ascending() {
        let mesh = cube_lattice(3);
        let around = Incidence::of_cells(&mesh.tets, mesh.points.len());
        assert_eq!(around.offsets.len(), mesh.points.len() + 1);
        let total: usize = (0..mesh.points.len()).map(|v| around.get(v as u32).len()).sum();
        assert_eq!(total, 4 * mesh.tets.len());
        for v in 0..mesh.points.len() as u32 {
            assert!(around.get(v).is_sorted());
            assert!(around.get(v).iter().all(|&t| mesh.tets[t as usize].contains(&v)));
        }
        let neighbors = Incidence::of_vertices(&mesh.tets, mesh.points.len());
        for v in 0..mesh.points.len() as u32 {
            assert!(neighbors.get(v).iter().all(|&w| neighbors.get(w).contains(&v)));
        }
    }

    proptest! {
        /// On arbitrary cells (manifold or not), the matching agrees with a map from faces to their cells.
        #[test]
        fn matching_agrees_with_a_map(tets in prop::collection::vec(prop::sample::subsequence((0..9_u32).collect::<Vec<_>>(), 4), 1..30)) {
            let tets: Vec<[u32; 4]> = tets.iter().map(|t| [t[0], t[1], t[2], t[3]]).collect();
            let mut map: BTreeMap<[u32; 3], Vec<u32>> = BTreeMap::new();
            for handle in 0..4 * tets.len() as u32 {
                map.entry(face_key(face_vertices(&tets, handle))).or_default().push(handle);
            }
            let adjacency = tet_adjacency(&tets, 9);
            for handles in map.values() {
                for &h in handles {
                    let expected = match handles[..] { [a, b] => if a == h { b } else { a }, _ => NONE };
                    prop_assert_eq!(adjacency.neighbors[h as usize / 4][h as usize % 4], expected);
                    prop_assert_eq!(adjacency.crowded.binary_search(&h).is_ok(), handles.len() > 2);
                }
            }
        }
    }
}
