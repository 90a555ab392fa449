//! Regions of a filled complex: their closed boundaries, and the constraints inside.

use crate::request::{Filled, Request};
use anastomesh_mesh::adjacency::{TetAdjacency, face_vertices, tet_adjacency};
use anastomesh_mesh::face_key;
use rustc_hash::{FxHashMap, FxHashSet};

/// Id of a single region without a seed.
const ONLY: i32 = 1;

/// Triangle of the input between a region and something else.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Number of the triangle in the input.
    pub triangle: u32,
    /// Its vertices, seen from outside the region.
    pub vertices: [u32; 3],
    /// True if the other side belongs to no region.
    pub is_outer: bool,
}

/// Region with its boundary and constraints. All numbers are those of the input.
#[derive(Clone, Debug, Default)]
pub(super) struct RegionShape {
    pub id: i32,
    /// Seed in the region.
    pub seed: Option<u32>,
    /// Points in the region and on its boundary, ascending.
    pub points: Vec<u32>,
    /// Closed boundary, in the order of the input.
    pub boundary: Vec<Side>,
    /// Triangles with the region on both sides, ascending.
    pub baffles: Vec<u32>,
    /// Segments inside, smaller end first, ascending.
    pub segments: Vec<[u32; 2]>,
    /// Segments along edges of triangles, smaller end first, ascending.
    pub edges: Vec<[u32; 2]>,
}

/// Finds the regions of a filled complex, in the order of their first tetrahedra.
pub(super) fn region_shapes(r: &Request, plain: &Filled) -> Vec<RegionShape> {
    let tets = &plain.mesh.tets;
    let adjacency = tet_adjacency(tets, plain.mesh.points.len());
    let facets: FxHashMap<[u32; 3], u32> = r.surface.triangles.iter().map(|&t| face_key(t)).zip(0..).collect();
    let facet = |half: u32| facets.get(&face_key(face_vertices(tets, half))).copied();
    let (of, count) = flood(&adjacency, |half| facet(half).is_some());
    let mut shapes = vec![RegionShape::default(); count];
    for (t, &region) in of.iter().enumerate() {
        let shape = &mut shapes[region as usize];
        if shape.points.is_empty() {
            shape.id = plain.regions.get(t).copied().unwrap_or(ONLY);
        }
        shape.points.extend(tets[t].iter().filter(|&&v| (v as usize) < r.surface.points.len()));
        for half in 4 * t as u32..4 * t as u32 + 4 {
            let Some(triangle) = facet(half) else { continue };
            let mate = adjacency.neighbors[t][half as usize % 4];
            if mate != u32::MAX && of[mate as usize / 4] == region {
                shape.baffles.extend((half < mate).then_some(triangle));
            } else {
                let vertices = outward(r.surface.triangles[triangle as usize], face_vertices(tets, half));
                shape.boundary.push(Side { triangle, vertices, is_outer: mate == u32::MAX });
            }
        }
    }
    add_segments(&mut shapes, r, tets, &of);
    for (i, shape) in shapes.iter_mut().enumerate() {
        shape.seed = plain.seeds.get(i).copied().flatten();
        shape.boundary.sort_unstable_by_key(|side| side.triangle);
        for numbers in [&mut shape.points, &mut shape.baffles] {
            numbers.sort_unstable();
            numbers.dedup();
        }
    }
    shapes
}

/// Triangle in the direction of a face with the same vertices.
fn outward(triangle: [u32; 3], face: [u32; 3]) -> [u32; 3] {
    let [a, b, c] = triangle;
    let has = |edge: [u32; 2]| (0..3).any(|i| [face[i], face[(i + 1) % 3]] == edge);
    if has([a, b]) { triangle } else { [a, c, b] }
}

/// Region of each tetrahedron, and the number of regions.
fn flood(adjacency: &TetAdjacency, is_wall: impl Fn(u32) -> bool) -> (Vec<u32>, usize) {
    let mut of = vec![u32::MAX; adjacency.neighbors.len()];
    let mut count = 0;
    let mut reached = Vec::new();
    for first in 0..of.len() as u32 {
        if of[first as usize] != u32::MAX {
            continue;
        }
        of[first as usize] = count;
        reached.push(first);
        while let Some(t) = reached.pop() {
            for (half, &mate) in (4 * t..).zip(&adjacency.neighbors[t as usize]) {
                if mate != u32::MAX && of[mate as usize / 4] == u32::MAX && !is_wall(half) {
                    of[mate as usize / 4] = count;
                    reached.push(mate / 4);
                }
            }
        }
        count += 1;
    }
    (of, count as usize)
}

/// Adds the segments of the input to the regions that have them.
fn add_segments(shapes: &mut [RegionShape], r: &Request, tets: &[[u32; 4]], of: &[u32]) {
    if r.segments.is_empty() {
        return;
    }
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    let segments: FxHashSet<[u32; 2]> = r.segments.iter().map(|&[a, b]| key(a, b)).collect();
    let sides = r.surface.triangles.iter().flat_map(|&[a, b, c]| [key(a, b), key(b, c), key(c, a)]);
    let on_facets: FxHashSet<[u32; 2]> = sides.filter(|edge| segments.contains(edge)).collect();
    for (tet, &region) in tets.iter().zip(of) {
        let pairs = (0..4).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| key(tet[i], tet[j]));
        for edge in pairs.filter(|edge| segments.contains(edge)) {
            let shape = &mut shapes[region as usize];
            if on_facets.contains(&edge) { shape.edges.push(edge) } else { shape.segments.push(edge) }
        }
    }
    for edges in shapes.iter_mut().flat_map(|shape| [&mut shape.segments, &mut shape.edges]) {
        edges.sort_unstable();
        edges.dedup();
    }
}
