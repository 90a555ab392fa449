//! Points for surfaces whose edge lengths differ much: corners and centres of the leaves of an octree. Leaves grow with
//! the edges of the surface nearby, and with the distance from it.

use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Vec3, point_triangle};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rustc_hash::FxHashSet;

/// Growth of cubes per distance from the surface.
const GROWTH: f64 = 0.35;
/// Maximum side of a leaf, in those of the lattice with the same spacing: sides are halved each time.
const SIDE: f64 = std::f64::consts::SQRT_2;
/// Maximum level of a leaf.
const DEEPEST: u32 = 30;
/// Cubes between two checks for cancellation and the budget, and operations per cube.
const ASKED_EVERY: usize = 1024;
const OPERATIONS: usize = 10;

/// Closed surface with the edge length at each vertex.
struct Sized<'a> {
    surface: &'a TriMesh,
    sizes: &'a [f64],
    tree: ImmutableKdTree<f64, 3>,
    /// Triangles of the vertices, and the offset of each.
    triangles: Vec<u32>,
    first: Vec<u32>,
    /// Sum of the normals of the triangles of each vertex.
    normals: Vec<Vec3>,
}

/// Surface as seen from a point.
struct Seen {
    /// Edge length for the point.
    size: f64,
    /// Distance from the surface, negative outside.
    depth: f64,
    /// Edge length of the surface there.
    edge: f64,
}

impl<'a> Sized<'a> {
    fn new(surface: &'a TriMesh, sizes: &'a [f64]) -> Option<Self> {
        let places: Vec<[f64; 3]> = surface.points.iter().map(|p| [p.x, p.y, p.z]).collect();
        let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&places).ok()?;
        let mut pairs: Vec<[u32; 2]> = (0..).zip(&surface.triangles).flat_map(|(i, t)| t.map(|v| [v, i])).collect();
        pairs.sort_unstable();
        let first = (0..=places.len() as u32).map(|v| pairs.partition_point(|pair| pair[0] < v) as u32).collect();
        let mut normals = vec![Vec3::zeros(); places.len()];
        for t in &surface.triangles {
            let [a, b, c] = t.map(|v| surface.points[v as usize]);
            let normal = (b - a).cross(&(c - a));
            for &v in t {
                normals[v as usize] += normal;
            }
        }
        Some(Self { surface, sizes, tree, triangles: pairs.into_iter().map(|pair| pair[1]).collect(), first, normals })
    }

    /// Judges by the nearest vertex and its triangles.
    fn seen_from(&self, p: &Point3) -> Seen {
        let near = self.tree.query(&[p.x, p.y, p.z]).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize;
        let triangles = &self.triangles[self.first[near] as usize..self.first[near + 1] as usize];
        let distance = |&t: &u32| {
            let corners = self.surface.triangles[t as usize].map(|v| self.surface.points[v as usize]);
            point_triangle(p, corners.each_ref()).1
        };
        let from_vertex = p - self.surface.points[near];
        let away = triangles.iter().map(distance).fold(from_vertex.norm(), f64::min);
        let edge = self.sizes[near];
        let depth = if from_vertex.dot(&self.normals[near]) < 0.0 { away } else { -away };
        Seen { size: edge + GROWTH * away, depth, edge }
    }
}

/// Points inside the closed `surface` with edges of lengths `sizes` at its vertices. Cubes have side `cell`, and points are
/// at least `clearance` from the surface, both in edge lengths there.
///
/// # Errors
/// [`Stop`] if the watch stops it.
pub(super) fn octree_points(
    surface: &TriMesh,
    sizes: &[f64],
    cell: f64,
    clearance: f64,
    watch: &Watch,
) -> Result<Vec<Point3>, Stop> {
    let Some(sized) = Sized::new(surface, sizes) else { return Ok(Vec::new()) };
    let (low, high) =
        surface.points.iter().fold((surface.points[0], surface.points[0]), |(low, high), p| (low.inf(p), high.sup(p)));
    let side = (high - low).max();
    let place = |at: [i64; 3], unit: f64| low + Vec3::from(at.map(|x| x as f64 * unit));
    // Corners and centres in half cubes of the deepest level.
    let mut seen = FxHashSet::default();
    let (mut points, mut pending, mut count) = (Vec::new(), vec![(0, [0_i64; 3])], 0);
    while let Some((level, at)) = pending.pop() {
        count += 1;
        if count % ASKED_EVERY == 0 {
            watch.spend(ASKED_EVERY * OPERATIONS)?;
        }
        let width = side / f64::from(1_u32 << level);
        let reach = width * 0.75_f64.sqrt();
        let middle = place(at.map(|x| 2 * x + 1), width / 2.0);
        let Seen { size, depth, edge } = sized.seen_from(&middle);
        // No part of the cube is inside.
        if -depth > reach + edge {
            continue;
        }
        // Sizes are smaller nearer to the surface.
        let least = (size - GROWTH * reach).max(edge);
        if width > SIDE * cell * least && level < DEEPEST {
            pending.extend((0..8).map(|c| (level + 1, std::array::from_fn(|k| 2 * at[k] + (c >> k & 1)))));
            continue;
        }
        let half = 1_i64 << (DEEPEST - level);
        let corners = (0..8).map(|c| std::array::from_fn(|k| 2 * half * (at[k] + (c >> k & 1))));
        for index in corners.chain([at.map(|x| half * (2 * x + 1))]) {
            if !seen.insert(index) {
                continue;
            }
            let p = place(index, side / f64::from(2_u32 << DEEPEST));
            let Seen { depth, edge, .. } = sized.seen_from(&p);
            if depth >= clearance * edge {
                points.push(p);
            }
        }
    }
    Ok(points)
}
