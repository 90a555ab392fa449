//! Prisms between a wall and its inner positions, cut into layers of tetrahedra.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::{TetMesh, TriMesh};
use rayon::prelude::*;

/// Indices of the copies of vertices: first the vertices of the surface, then the copies of each, from the wall
/// inwards. A vertex without copies is its own copy in each layer.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    /// Number of preceding vertices with copies; `None` for vertices without.
    slot: Vec<Option<u32>>,
    /// True for wall vertices that also have triangles off the wall.
    is_rim: Vec<bool>,
    layers: u32,
    /// Vertices with copies.
    of_slot: Vec<u32>,
}

impl Numbers {
    /// Numbers of the vertices of a surface, some of which have copies in each layer.
    pub fn new(copied: impl IntoIterator<Item = bool>, is_rim: Vec<bool>, layers: u32) -> Self {
        let mut of_slot = Vec::new();
        let mut slot = |(v, copied): (u32, bool)| {
            copied.then(|| {
                of_slot.push(v);
                of_slot.len() as u32 - 1
            })
        };
        let slot = (0..).zip(copied).map(&mut slot).collect();
        Self { slot, is_rim, layers, of_slot }
    }

    /// Copy of a vertex in a layer, counted from the wall.
    pub fn copy(&self, v: u32, layer: u32) -> u32 {
        match self.slot[v as usize] {
            Some(slot) if layer > 0 => self.slot.len() as u32 + slot * self.layers + layer - 1,
            _ => v,
        }
    }

    /// Ring around a flat cap, from its rim outwards: the sides of the prisms at the rim. Each triangle has its layer, and
    /// is oriented like those of the cap.
    pub fn ring(&self, cap: &[[u32; 3]]) -> Vec<(u32, [u32; 3])> {
        let mut out = Vec::new();
        for [a, b] in rim(cap) {
            for layer in 0..self.layers {
                out.extend(self.side([b, a], layer).into_iter().map(|triangle| (layer, triangle)));
            }
        }
        out
    }

    /// Vertex of the surface that a vertex or copy belongs to.
    pub fn origin(&self, copy: u32) -> u32 {
        match copy.checked_sub(self.slot.len() as u32) {
            Some(copy) => self.of_slot[(copy / self.layers) as usize],
            None => copy,
        }
    }

    /// Number of layers.
    pub fn layers(&self) -> u32 {
        self.layers
    }

    /// Number of vertices including all copies.
    pub fn len(&self) -> u32 {
        (self.slot.len() + self.of_slot.len() * self.layers as usize) as u32
    }

    /// Returns `true` if the number of vertices is zero.
    pub fn is_empty(&self) -> bool {
        self.slot.is_empty()
    }

    /// Positions of the surface's vertices and their copies, which lie at fraction `depths[i]` of the offset. Vertices
    /// without copies are at their inner position.
    pub fn points(&self, outer: &[Point3], inner: &[Point3], depths: &[f64]) -> Vec<Point3> {
        let own =
            self.slot.iter().zip(outer.iter().zip(inner)).map(|(slot, (o, i))| if slot.is_some() { *o } else { *i });
        let both = self.slot.iter().zip(outer.iter().zip(inner)).filter(|(slot, _)| slot.is_some());
        own.chain(both.flat_map(|(_, (o, i))| depths.iter().map(|&depth| toward(o, i, depth)))).collect()
    }

    /// Sort key of two vertices that decides the diagonal between their copies. Rims come first, so that no tetrahedron
    /// has a face on the wall and one beside it.
    fn rank(&self, v: u32) -> (bool, u32) {
        (!self.is_rim[v as usize], v)
    }

    /// A flat cap of the wall, given by its triangles without layers: the inner cap with the layers around it.
    pub fn disc(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let inner = |v: u32| self.copy(v, self.layers);
        let mut out: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(inner)).collect();
        for edge in rim(triangles) {
            let sides = (0..self.layers).flat_map(|layer| self.side(edge, layer));
            out.extend(sides.filter(|[a, b, c]| a != b && b != c && c != a));
        }
        out
    }

    /// Side of a prism at a directed edge of the wall: two triangles that have the edge in its direction.
    fn side(&self, [a, b]: [u32; 2], layer: u32) -> [[u32; 3]; 2] {
        let [a0, a1, b0, b1] = [(a, layer), (a, layer + 1), (b, layer), (b, layer + 1)].map(|(v, i)| self.copy(v, i));
        if self.rank(a) < self.rank(b) { [[a0, b0, b1], [a0, b1, a1]] } else { [[a0, b0, a1], [b0, b1, a1]] }
    }

    /// Tetrahedra at a wall triangle seen from outside, from the wall inwards.
    pub fn tets_at(&self, triangle: [u32; 3]) -> impl Iterator<Item = [u32; 4]> {
        (0..self.layers).flat_map(move |layer| self.prism(triangle, layer))
    }

    /// Layer of each tetrahedron at these wall triangles in their order, counted from 1 at the wall.
    pub fn layers_at(&self, wall: &[[u32; 3]]) -> Vec<i32> {
        let layer = |(triangle, layer): ([u32; 3], u32)| self.prism(triangle, layer).map(move |_| layer as i32 + 1);
        wall.iter().flat_map(|&triangle| (0..self.layers).map(move |i| (triangle, i))).flat_map(layer).collect()
    }

    /// Wall triangles, seen from outside, with a tetrahedron that is not positive at these positions of all copies.
    pub fn turned(&self, wall: &[[u32; 3]], points: &[Point3]) -> Vec<[u32; 3]> {
        let is_turned = |triangle: &&[u32; 3]| {
            self.tets_at(**triangle).any(|tet| {
                let [a, b, c, d] = tet.map(|v| &points[v as usize]);
                orient3d(a, b, c, d) <= 0.0
            })
        };
        wall.par_iter().filter(is_turned).copied().collect()
    }

    /// Tetrahedra of a layer at a wall triangle seen from outside. Vertices without copies leave fewer than three.
    fn prism(&self, triangle: [u32; 3], layer: u32) -> impl Iterator<Item = [u32; 4]> {
        let mut sorted = triangle;
        sorted.sort_unstable_by_key(|&v| self.rank(v));
        let [a, b, c] = sorted;
        let turned = (0..3).all(|i| [triangle[i], triangle[(i + 1) % 3], triangle[(i + 2) % 3]] != sorted);
        let [a0, b0, c0] = sorted.map(|v| self.copy(v, layer));
        let [a1, b1, c1] = [a, b, c].map(|v| self.copy(v, layer + 1));
        let three = [(c0 != c1, [b0, a0, c0, c1]), (b0 != b1, [a0, b0, b1, c1]), (a0 != a1, [a1, a0, b1, c1])];
        let set = move |[p, q, r, s]: [u32; 4]| if turned { [q, p, r, s] } else { [p, q, r, s] };
        three.into_iter().filter(|(there, _)| *there).map(move |(_, tet)| set(tet))
    }
}

/// A surface and the inner positions of its vertices.
#[derive(Clone, Debug)]
pub struct Stack<'a> {
    /// Triangles with layers, seen from outside.
    wall: &'a [[u32; 3]],
    pub numbers: Numbers,
    points: Vec<Point3>,
}

impl<'a> Stack<'a> {
    /// Creates the stack of `wall`, the surface triangles with layers, counter-clockwise seen from outside. Vertices
    /// off the wall, or with zero offset, have no copies.
    pub fn new(outer: &[Point3], wall: &'a [[u32; 3]], is_rim: Vec<bool>, inner: &[Point3], depths: &[f64]) -> Self {
        let mut on_wall = vec![false; outer.len()];
        wall.iter().flatten().for_each(|&v| on_wall[v as usize] = true);
        let copied = on_wall.iter().zip(outer.iter().zip(inner)).map(|(&on_wall, (o, i))| on_wall && o != i);
        let numbers = Numbers::new(copied, is_rim, depths.len() as u32);
        let points = numbers.points(outer, inner, depths);
        Self { wall, numbers, points }
    }

    /// Wall triangles with a tetrahedron that is not positive.
    pub fn turned(&self) -> Vec<[u32; 3]> {
        self.numbers.turned(self.wall, &self.points)
    }

    /// Joins all layers with the `core` mesh inside, whose points begin with the inner positions. The result's points
    /// begin with the surface's, those off the wall at their inner position. Returns the number of layer tetrahedra,
    /// the first ones.
    pub fn around(self, core: &TetMesh) -> (TetMesh, usize) {
        let given = self.numbers.slot.len() as u32;
        let mut tets: Vec<[u32; 4]> = self.wall.iter().flat_map(|&triangle| self.numbers.tets_at(triangle)).collect();
        let of_layers = tets.len();
        let Self { numbers, mut points, .. } = self;
        let name = |v: u32| if v < given { numbers.copy(v, numbers.layers) } else { numbers.len() + v - given };
        tets.extend(core.tets.iter().map(|tet| tet.map(name)));
        points.extend_from_slice(&core.points[given as usize..]);
        (TetMesh { points, tets }, of_layers)
    }
}

/// Directed edges that only one of some triangles has, in ascending order.
fn rim(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut sides: Vec<[u32; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    sides.sort_unstable();
    sides.iter().filter(|[a, b]| sides.binary_search(&[*b, *a]).is_err()).copied().collect()
}

/// Point at a fraction of the way between two points; exactly `to` at 1.
pub fn toward(from: &Point3, to: &Point3, share: f64) -> Point3 {
    if share == 1.0 { *to } else { from + (to - from) * share }
}

/// True for vertices of both wall triangles and others.
pub fn rims(surface: &TriMesh, is_wall: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut sides = vec![[false; 2]; surface.points.len()];
    for (i, triangle) in surface.triangles.iter().enumerate() {
        for &v in triangle {
            sides[v as usize][usize::from(is_wall(i))] = true;
        }
    }
    sides.into_iter().map(|both| both == [true; 2]).collect()
}
