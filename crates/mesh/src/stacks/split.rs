//! Prisms, pyramids and quadrilaterals of a mixed mesh, split into tetrahedra and triangles.

use super::mixed::sorted;
use rustc_hash::FxHashMap;

/// Polyhedra of a mixed mesh, each with the number of its first tetrahedron or triangle in the lists that receive them.
///
/// A prism is split with the diagonals that begin at the lowest vertices of its first triangle. This is the outer one in
/// the layers of this program. If two prisms disagree about a diagonal, all begin at the lowest vertices of
/// quadrilaterals. Source: Dompierre et al., 'How to subdivide pyramids, prisms and hexahedra into tetrahedra', 1999.
///
/// ```
/// use anastomesh_mesh::stacks::Polyhedra;
///
/// let polyhedra = Polyhedra { prisms: vec![(0, [0, 1, 2, 3, 4, 5])], ..Polyhedra::default() };
/// let mut tets = vec![[0; 4]; 3];
/// polyhedra.split(&mut tets, &mut []);
/// assert_eq!(tets, [[0, 1, 2, 5], [1, 0, 4, 5], [0, 3, 4, 5]]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polyhedra {
    /// Prisms, three tetrahedra each: a triangle, and the opposite vertices of the other.
    pub prisms: Vec<(usize, [u32; 6])>,
    /// Pyramids, two tetrahedra each: a quadrilateral, and the apex.
    pub pyramids: Vec<(usize, [u32; 5])>,
    /// Quadrilaterals, two triangles each.
    pub quads: Vec<(usize, [u32; 4])>,
}

/// Diagonals of quadrilaterals, by their sorted vertices.
type Diagonals = FxHashMap<[u32; 4], [u32; 2]>;

impl Polyhedra {
    /// Writes the tetrahedra and triangles to their places. Neighbours are split alike.
    ///
    /// # Panics
    /// If a list ends before the places of a polyhedron.
    pub fn split(&self, tets: &mut [[u32; 4]], triangles: &mut [[u32; 3]]) {
        let diagonals = self.diagonals();
        for &(first, prism) in &self.prisms {
            let three = if diagonals.is_some() { by_first_triangle(prism) } else { by_lowest(prism) };
            tets[first..first + 3].copy_from_slice(&three);
        }
        let diagonals = diagonals.unwrap_or_default();
        for &(first, [a, b, c, d, apex]) in &self.pyramids {
            let halves = halves([a, b, c, d], &diagonals);
            tets[first..first + 2].copy_from_slice(&halves.map(|[a, b, c]| [a, b, c, apex]));
        }
        for &(first, quad) in &self.quads {
            triangles[first..first + 2].copy_from_slice(&halves(quad, &diagonals));
        }
    }

    /// Diagonals by the first triangles of prisms; `None` if two prisms disagree.
    fn diagonals(&self) -> Option<Diagonals> {
        let mut known = Diagonals::default();
        for (_, v) in &self.prisms {
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                let diagonal = if v[i] < v[j] { [v[i], v[j + 3]] } else { [v[j], v[i + 3]] };
                let diagonal = [diagonal[0].min(diagonal[1]), diagonal[0].max(diagonal[1])];
                let quad = sorted([v[i], v[j], v[j + 3], v[i + 3]]);
                if *known.entry(quad).or_insert(diagonal) != diagonal {
                    return None;
                }
            }
        }
        Some(known)
    }
}

/// Triangles of a quadrilateral by its known diagonal, or by the one that begins at the lowest vertex.
fn halves(quad: [u32; 4], diagonals: &Diagonals) -> [[u32; 3]; 2] {
    let [a, b, c, d] = quad;
    let usual = || {
        let lowest = a.min(b).min(c).min(d);
        lowest == a || lowest == c
    };
    let first = diagonals.get(&sorted(quad)).map_or_else(usual, |diagonal| diagonal.contains(&a));
    if first { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}

/// Tetrahedra with the diagonals that begin at the lowest vertices of the first triangle.
pub(super) fn by_first_triangle(v: [u32; 6]) -> [[u32; 4]; 3] {
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&i| v[i]);
    let is_even = matches!(order, [0, 1, 2] | [1, 2, 0] | [2, 0, 1]);
    let [a, b, c] = order.map(|i| v[i]);
    let [a1, b1, c1] = order.map(|i| v[i + 3]);
    [[b, a, c, c1], [a, b, b1, c1], [a1, a, b1, c1]].map(|tet| super::plain(tet, is_even))
}

/// Tetrahedra with the diagonals that begin at the lowest vertices of the quadrilaterals.
fn by_lowest(v: [u32; 6]) -> [[u32; 4]; 3] {
    // Turned so that the lowest vertex is the first of all.
    let lowest = (0..6).min_by_key(|&i| v[i]).unwrap_or(0);
    let turned = match lowest {
        0 => [0, 1, 2, 3, 4, 5],
        1 => [1, 2, 0, 4, 5, 3],
        2 => [2, 0, 1, 5, 3, 4],
        3 => [3, 5, 4, 0, 2, 1],
        4 => [4, 3, 5, 1, 0, 2],
        _ => [5, 4, 3, 2, 1, 0],
    };
    let [a, b, c, a1, b1, c1] = turned.map(|i: usize| v[i]);
    let rest = if b.min(c1) < c.min(b1) { [[a, b, c, c1], [a, b, c1, b1]] } else { [[a, b, c, b1], [a, b1, c, c1]] };
    [rest[0], rest[1], [a, b1, c1, a1]]
}
