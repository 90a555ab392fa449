//! Prisms and pyramids of layers as whole cells, between tetrahedra.

use super::split::by_first_triangle;
use super::{LayerCell, in_part};
use crate::geometry::predicates::orient3d;
use crate::source::FacePiece;
use crate::{TET_FACES, VolumeMesh, face_key};
use rustc_hash::{FxHashMap, FxHashSet};

/// Maximum passes that dissolve prisms at unmatched quadrilaterals. The meshes of this program need one or two.
const MAX_PASSES: usize = 32;

/// Mesh of tetrahedra, pyramids and prisms, bounded by triangles and quadrilaterals.
///
/// Each quadrilateral lies between two cells or on the boundary, so the mesh conforms. A prism whose neighbour has two
/// triangles at a quadrilateral stays three tetrahedra, unless the neighbour can be a pyramid. So does a prism that
/// readers could not split into positive tetrahedra.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MixedMesh {
    /// Cells, in the order of their tetrahedra.
    pub cells: Vec<MixedCell>,
    /// Faces of the boundary, in the order of their triangles.
    pub faces: Vec<MixedFace>,
}

/// Tetrahedron, pyramid or prism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MixedCell {
    vertices: [u32; 6],
    count: u8,
    /// Block or region.
    pub block: i32,
    /// Number of the layer, from 1 at the wall; 0 for cells in no layer.
    pub layer: i32,
}

impl MixedCell {
    fn new(vertices: &[u32], block: i32, layer: i32) -> Self {
        let mut all = [0; 6];
        all[..vertices.len()].copy_from_slice(vertices);
        Self { vertices: all, count: vertices.len() as u8, block, layer }
    }

    /// Vertices in Gmsh's order: four of a tetrahedron, five of a pyramid (quadrilateral, then apex), six of a prism
    /// (outer triangle, then inner triangle). The first face is counter-clockwise seen from the remaining vertices.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.vertices[..usize::from(self.count)]
    }

    /// Cell with other vertex numbers.
    #[must_use]
    pub fn renumbered(&self, number: impl Fn(u32) -> u32) -> Self {
        let mut cell = *self;
        cell.vertices[..usize::from(self.count)].iter_mut().for_each(|v| *v = number(*v));
        cell
    }
}

/// Triangle or quadrilateral of the boundary, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MixedFace {
    vertices: [u32; 4],
    count: u8,
    /// Patch.
    pub patch: i32,
    /// Block or region.
    pub block: i32,
}

impl MixedFace {
    /// Three or four vertices.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.vertices[..usize::from(self.count)]
    }

    /// Face with other vertex numbers.
    #[must_use]
    pub fn renumbered(&self, number: impl Fn(u32) -> u32) -> Self {
        let mut face = *self;
        face.vertices[..usize::from(self.count)].iter_mut().for_each(|v| *v = number(*v));
        face
    }
}

impl MixedMesh {
    /// Finds the prisms and pyramids of a mesh. Without layers, all cells are tetrahedra.
    #[must_use]
    pub fn of(mesh: &VolumeMesh) -> Self {
        let mut builder = Builder::new(mesh);
        for _ in 0..MAX_PASSES {
            if builder.match_quads() {
                return builder.finish();
            }
        }
        builder.layers.clear();
        builder.finish()
    }
}

/// Prism or pyramid under construction.
struct Candidate {
    first: usize,
    layer: i32,
    cell: LayerCell,
}

impl Candidate {
    /// Quadrilaterals, each in cyclic order.
    fn quads(&self) -> impl Iterator<Item = [u32; 4]> + use<'_> {
        let LayerCell { base, top, .. } = &self.cell;
        let pairs = [(0, 1), (1, 2), (2, 0)].into_iter();
        let solid = pairs.filter(|&(i, j)| base[i] != top[i] && base[j] != top[j]);
        solid.map(|(i, j)| [base[i], base[j], top[j], top[i]])
    }
}

struct Builder<'a> {
    mesh: &'a VolumeMesh,
    /// Prisms and pyramids of layers, by their first tetrahedra.
    layers: Vec<Candidate>,
    /// Boundary triangles by their vertices.
    outer: FxHashMap<[u32; 3], usize>,
    /// Pairs of boundary triangles that are quadrilaterals: the first one's number, with the second.
    pairs: FxHashMap<usize, usize>,
    /// Pyramids of two tetrahedra beside prisms: the first one's number, with the second and the vertices.
    pyramids: FxHashMap<usize, (usize, [u32; 5])>,
}

impl<'a> Builder<'a> {
    fn new(mesh: &'a VolumeMesh) -> Self {
        let piece = FacePiece {
            faces: mesh.boundary.as_slice().into(),
            patches: mesh.boundary_patch.as_slice().into(),
            ..FacePiece::default()
        };
        let mut layers: Vec<Candidate> = Vec::new();
        for (first, cell) in in_part(&mesh.mesh.tets, &piece).0 {
            let inside = |outer: &&Candidate| {
                outer.first + outer.cell.tets == first && face_key(outer.cell.top) == face_key(cell.base)
            };
            let layer = layers.last().filter(inside).map_or(1, |outer| outer.layer + 1);
            if can_be_split(mesh, &whole(&cell, mesh.mesh.tets[first], 0, layer)) {
                layers.push(Candidate { first, layer, cell });
            }
        }
        let outer = mesh.boundary.iter().zip(0..).map(|(face, i)| (face_key(*face), i)).collect();
        Self { mesh, layers, outer, pairs: FxHashMap::default(), pyramids: FxHashMap::default() }
    }

    /// Finds the other side of each quadrilateral. If one has none, dissolves its cell and returns false.
    fn match_quads(&mut self) -> bool {
        self.pairs.clear();
        self.pyramids.clear();
        let mut uses: FxHashMap<[u32; 4], u32> = FxHashMap::default();
        for quad in self.layers.iter().flat_map(Candidate::quads) {
            *uses.entry(sorted(quad)).or_default() += 1;
        }
        let mut inner = Vec::new();
        for (i, candidate) in self.layers.iter().enumerate() {
            for quad in candidate.quads().filter(|quad| uses[&sorted(*quad)] == 1) {
                match halves(quad).map(|half| self.outer.get(&face_key(half)).copied()) {
                    [Some(a), Some(b), ..] | [.., Some(a), Some(b)] if self.is_one_patch(a, b) => {
                        self.pairs.insert(a.min(b), a.max(b));
                    }
                    _ => inner.push((i, quad)),
                }
            }
        }
        let stuck = self.find_pyramids(&inner);
        let mut number = 0..;
        self.layers.retain(|_| number.next().is_none_or(|i| !stuck.contains(&i)));
        stuck.is_empty()
    }

    fn is_one_patch(&self, a: usize, b: usize) -> bool {
        self.mesh.boundary_patch.get(a) == self.mesh.boundary_patch.get(b)
    }

    /// Joins pairs of tetrahedra beside these quadrilaterals to pyramids. Returns the cells where this is impossible.
    fn find_pyramids(&mut self, quads: &[(usize, [u32; 4])]) -> FxHashSet<usize> {
        let wanted: FxHashSet<[u32; 3]> = quads.iter().flat_map(|(_, quad)| halves(*quad)).map(face_key).collect();
        let mut beside: FxHashMap<[u32; 3], usize> = FxHashMap::default();
        let mut layers = self.layers.iter().peekable();
        let mut end = 0;
        for (t, tet) in self.mesh.mesh.tets.iter().enumerate() {
            if let Some(layer) = layers.next_if(|layer| layer.first == t) {
                end = t + layer.cell.tets;
            }
            if t >= end && !wanted.is_empty() {
                let faces = TET_FACES.map(|face| face_key(face.map(|i| tet[i])));
                beside.extend(faces.into_iter().filter(|face| wanted.contains(face)).map(|face| (face, t)));
            }
        }
        let mut taken = FxHashSet::default();
        let mut stuck = FxHashSet::default();
        for &(layer, quad) in quads {
            let found = match halves(quad).map(|half| beside.get(&face_key(half)).copied()) {
                [Some(a), Some(b), ..] | [.., Some(a), Some(b)] => self.pyramid(quad, [a, b]).map(|v| ([a, b], v)),
                _ => None,
            };
            match found.filter(|([a, b], _)| !taken.contains(a) && !taken.contains(b)) {
                Some(([a, b], vertices)) => {
                    taken.extend([a, b]);
                    self.pyramids.insert(a.min(b), (a.max(b), vertices));
                }
                None => drop(stuck.insert(layer)),
            }
        }
        stuck
    }

    /// Pyramid on a quadrilateral of two tetrahedra with a common apex, in one block.
    fn pyramid(&self, quad: [u32; 4], [a, b]: [usize; 2]) -> Option<[u32; 5]> {
        let tets = &self.mesh.mesh.tets;
        let apex = |tet: usize| tets[tet].into_iter().find(|v| !quad.contains(v));
        let apex = apex(a).filter(|&v| a != b && apex(b) == Some(v) && self.block(a) == self.block(b))?;
        Some(oriented(quad, apex, tets[a]))
    }

    fn block(&self, tet: usize) -> i32 {
        self.mesh.tet_block.get(tet).copied().unwrap_or(0)
    }

    fn finish(&self) -> MixedMesh {
        MixedMesh { cells: self.cells(), faces: self.faces() }
    }

    fn cells(&self) -> Vec<MixedCell> {
        let tets = &self.mesh.mesh.tets;
        let second: FxHashSet<usize> = self.pyramids.values().map(|(second, _)| *second).collect();
        let mut layers = self.layers.iter().peekable();
        let mut cells = Vec::with_capacity(tets.len());
        let mut t = 0;
        while t < tets.len() {
            let block = self.block(t);
            if let Some(layer) = layers.next_if(|layer| layer.first == t) {
                cells.push(whole(&layer.cell, tets[t], block, layer.layer));
                t += layer.cell.tets;
                continue;
            }
            match self.pyramids.get(&t) {
                Some((_, vertices)) => cells.push(MixedCell::new(vertices, block, 0)),
                None if second.contains(&t) => {}
                None => cells.push(MixedCell::new(&tets[t], block, 0)),
            }
            t += 1;
        }
        cells
    }

    fn faces(&self) -> Vec<MixedFace> {
        let second: FxHashSet<usize> = self.pairs.values().copied().collect();
        let label = |labels: &[i32], i: usize| labels.get(i).copied().unwrap_or(0);
        let face = |(i, &triangle): (usize, &[u32; 3])| {
            let quad = self.pairs.get(&i).and_then(|&other| joined(triangle, self.mesh.boundary[other]));
            let [a, b, c] = triangle;
            MixedFace {
                vertices: quad.unwrap_or([a, b, c, c]),
                count: if quad.is_some() { 4 } else { 3 },
                patch: label(&self.mesh.boundary_patch, i),
                block: label(&self.mesh.boundary_block, i),
            }
        };
        self.mesh.boundary.iter().enumerate().filter(|(i, _)| !second.contains(i)).map(face).collect()
    }
}

/// True if readers get positive tetrahedra from a prism ([`Polyhedra`](super::Polyhedra)).
fn can_be_split(mesh: &VolumeMesh, cell: &MixedCell) -> bool {
    let Ok(prism) = <[u32; 6]>::try_from(cell.vertices()) else { return true };
    let point = |v: u32| mesh.mesh.points.get(v as usize);
    let is_positive = |tet: [u32; 4]| match tet.map(point) {
        [Some(a), Some(b), Some(c), Some(d)] => orient3d(a, b, c, d) > 0.0,
        _ => false,
    };
    by_first_triangle(prism).into_iter().all(is_positive)
}

/// Cell of a layer with the orientation of its first tetrahedron.
fn whole(cell: &LayerCell, tet: [u32; 4], block: i32, layer: i32) -> MixedCell {
    if let Some([a, b, c, d, apex]) = cell.pyramid() {
        return MixedCell::new(&oriented([a, b, c, d], apex, tet), block, layer);
    }
    // The first tetrahedron of a prism is its outer triangle with a vertex of the inner one.
    let inner = |v: &u32| (0..3).find(|&i| cell.base[i] == *v).map_or(*v, |i| cell.top[i]);
    let base = [tet[0], tet[1], tet[2]];
    MixedCell::new(&[base, base.map(|v| inner(&v))].concat(), block, layer)
}

/// Pyramid with the orientation of `tet`, which consists of the apex and three vertices of the quadrilateral.
fn oriented(quad: [u32; 4], apex: u32, tet: [u32; 4]) -> [u32; 5] {
    let [a, b, c, d] = quad;
    let mut three = quad.into_iter().filter(|v| tet.contains(v));
    let seen = [three.next(), three.next(), three.next(), Some(apex)];
    let places = seen.map(|v| tet.iter().position(|&w| Some(w) == v).unwrap_or(0));
    let inversions = (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|&(j, i)| places[j] > places[i]).count();
    if inversions % 2 == 0 { [a, b, c, d, apex] } else { [a, d, c, b, apex] }
}

/// Union of two triangles with a common edge, from its lowest vertex on.
fn joined(one: [u32; 3], other: [u32; 3]) -> Option<[u32; 4]> {
    let mut quad = (0..3).find_map(|i| {
        let [x, y, z] = [one[i], one[(i + 1) % 3], one[(i + 2) % 3]];
        let at = (0..3).find(|&j| [other[j], other[(j + 1) % 3]] == [y, x])?;
        Some([x, other[(at + 2) % 3], y, z])
    })?;
    let lowest = (0..4).min_by_key(|&i| quad[i]).unwrap_or(0);
    quad.rotate_left(lowest);
    Some(quad)
}

/// Triangles of a quadrilateral, by one diagonal and by the other.
fn halves([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 4] {
    [[a, b, c], [c, d, a], [b, c, d], [d, a, b]]
}

pub(super) fn sorted(mut quad: [u32; 4]) -> [u32; 4] {
    quad.sort_unstable();
    quad
}

#[cfg(test)]
mod tests {
    use super::super::Polyhedra;
    use super::*;
    use crate::{Point3, TetMesh, WALL};

    /// Prism at the wall triangle `[0, 1, 2]`, and tetrahedra beside the quadrilateral `[1, 2, 5, 4]`.
    fn layered(beside: &[[u32; 4]], sides: &[[u32; 3]]) -> VolumeMesh {
        let mut tets = vec![[1, 0, 2, 5], [0, 1, 4, 5], [3, 0, 4, 5]];
        tets.extend(beside);
        let mut boundary = vec![[0, 1, 2]];
        boundary.extend(sides);
        let mut boundary_patch = vec![WALL + 1; boundary.len()];
        boundary_patch[0] = WALL;
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let mut points: Vec<Point3> =
            (0..2).flat_map(|z| corners.map(|[x, y]| Point3::new(x, y, -f64::from(z)))).collect();
        points.extend([Point3::new(2.0, 2.0, -0.5), Point3::new(2.0, 2.0, -0.6)]);
        let mesh = TetMesh { points, tets };
        VolumeMesh { mesh, boundary, boundary_patch, ..VolumeMesh::default() }
    }

    /// Sides of the prism: the first two triangles have the vertices 1, 2, 4 and 5.
    const SIDES: [[u32; 3]; 6] = [[1, 5, 2], [1, 4, 5], [0, 4, 1], [0, 3, 4], [2, 5, 0], [5, 3, 0]];

    fn vertices<T>(all: &[T], of: fn(&T) -> &[u32]) -> Vec<&[u32]> {
        all.iter().map(of).collect()
    }

    #[test]
    fn triangles_of_caps_are_joined_beside_prisms() {
        let volume = layered(&[], &SIDES);
        let mixed = MixedMesh::of(&volume);
        assert_eq!(vertices(&mixed.cells, MixedCell::vertices), [[1, 0, 2, 4, 3, 5]]);
        assert_eq!(mixed.cells[0].layer, 1);
        let faces = vertices(&mixed.faces, MixedFace::vertices);
        assert_eq!(faces.iter().map(|face| face.len()).collect::<Vec<_>>(), [3, 4, 4, 4]);
        // Split again, these are the given tetrahedra and triangles.
        let mut polyhedra = Polyhedra { prisms: vec![(0, [1, 0, 2, 4, 3, 5])], ..Polyhedra::default() };
        let quads = mixed.faces[1..].iter().enumerate().map(|(i, face)| (1 + 2 * i, face.vertices));
        polyhedra.quads.extend(quads);
        let (mut tets, mut triangles) = (vec![[0; 4]; 3], vec![[0; 3]; 7]);
        polyhedra.split(&mut tets, &mut triangles);
        assert_eq!(tets, volume.mesh.tets);
        let keys = |faces: &[[u32; 3]]| faces.iter().map(|face| face_key(*face)).collect::<FxHashSet<_>>();
        assert_eq!(keys(&triangles[1..]), keys(&SIDES));
    }

    #[test]
    fn tetrahedra_beside_a_prism_become_a_pyramid_or_dissolve_it() {
        let beside = [[1, 5, 2, 6], [1, 4, 5, 6]];
        let mixed = MixedMesh::of(&layered(&beside, &SIDES[2..]));
        let cells = vertices(&mixed.cells, MixedCell::vertices);
        assert_eq!(cells, [&[1, 0, 2, 4, 3, 5][..], &[1, 4, 5, 2, 6]]);
        assert_eq!(mixed.cells[1].layer, 0);
        // Two apices.
        let mixed = MixedMesh::of(&layered(&[[1, 5, 2, 6], [1, 4, 5, 7]], &SIDES[2..]));
        assert!(mixed.cells.iter().all(|cell| cell.vertices().len() == 4));
        assert_eq!((mixed.cells.len(), mixed.faces.len()), (5, 5));
        // A prism turned inside out.
        let mut twisted = layered(&beside, &SIDES[2..]);
        twisted.mesh.points[3] = Point3::new(0.0, 0.0, 1.0);
        assert!(MixedMesh::of(&twisted).cells.iter().all(|cell| cell.vertices().len() == 4));
    }
}
