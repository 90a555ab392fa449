//! Contouring on a sparse grid from seed cells along the wall. Only nodes of crossed cells are evaluated.
//!
//! The patches of marching-cubes cells form a closed 2-manifold for every sign field (`cases`). This module builds
//! their dual. It has one vertex per patch, at the mean of its crossings, and one quadrilateral per crossed grid edge,
//! split along its better diagonal. The dual has as many triangles as marching cubes and no slivers. It is a simplicial
//! manifold except if two patches share both segments of an ambiguous face. Each such edge gets a middle vertex, and
//! the adjacent quadrilaterals are split from a vertex at their crossing.

use rustc_hash::FxHashMap;

use super::SurfaceError;
use super::cases::{CASES, FACE_EDGES, NONE, edge_corners};
use super::relax::largest_cosine;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_tet::parts::Watch;

/// Grid node, or the cell of which it is the lowest corner.
pub(crate) type Node = [i32; 3];

/// Maximum absolute value of a coordinate.
pub(crate) const MAX_COORDINATE: i32 = 1 << 20;

/// Bits and mask of a coordinate within its tile, and cells per tile.
const BITS: u32 = 3;
const WITHIN: u64 = (1 << BITS) - 1;
const PLACES: usize = 1 << (3 * BITS);

/// Block of 8 × 8 × 8 grid nodes and cells.
struct Tile {
    value: [f64; PLACES],
    first_vertex: [u32; PLACES],
    mask: [u8; PLACES],
    evaluated: [u64; PLACES / 64],
    visited: [u64; PLACES / 64],
}

/// Function on the nodes of the grid, negative inside.
pub(crate) trait Sampled {
    /// Value at a node.
    fn value(&mut self, n: Node) -> f64;

    /// Operations of the evaluations since the last call, as counted by budgets.
    fn operations(&mut self) -> usize {
        0
    }
}

impl<F: FnMut(Node) -> f64> Sampled for F {
    fn value(&mut self, n: Node) -> f64 {
        self(n)
    }
}

/// Operations per crossed cell, as counted by budgets.
const OPERATIONS: usize = 10;

/// Crossed cells between two checks for cancellation and the budget.
const ASKED_EVERY: usize = 1024;

/// Contours the zero level of `value` (negative inside) from crossed `seeds`. Positions are in grid units. Also returns
/// a vertex in the cell of each seed.
///
/// # Errors
/// `TooLarge` if more than `max_cells` cells are crossed or the grid's coordinates overflow; `Stopped`.
pub(crate) fn contour(
    seeds: &[Node],
    max_cells: usize,
    value: impl Sampled,
    watch: &Watch,
) -> Result<(TriMesh, Vec<u32>), SurfaceError> {
    let mut grid = SparseGrid { tiles: Vec::new(), index: FxHashMap::default(), last: (u64::MAX, 0), value };
    let mut dual = DualMesh { mesh: TriMesh::default(), midpoints: FxHashMap::default() };
    let cells = grid.flood(seeds, max_cells, watch, &mut dual.mesh.points)?;
    for (i, &(cell, mask)) in cells.iter().enumerate() {
        if i.is_multiple_of(ASKED_EVERY) {
            watch.spend(ASKED_EVERY * OPERATIONS / 2)?;
        }
        for d in 0..3 {
            if (mask ^ mask >> (1 << d)) & 1 == 1 {
                dual.crossing(&mut grid, cell, d, mask & 1 == 1);
            }
        }
    }
    let at_seeds = seeds.iter().map(|&seed| grid.crossed(seed).0).collect();
    Ok((dual.mesh, at_seeds))
}

struct SparseGrid<F> {
    tiles: Vec<Tile>,
    index: FxHashMap<u64, u32>,
    last: (u64, u32),
    value: F,
}

impl<F: Sampled> SparseGrid<F> {
    /// Tile of a node and index within it.
    #[inline]
    fn locate(&mut self, n: Node) -> (usize, usize) {
        let c = n.map(|x| (x + 2 * MAX_COORDINATE) as u64);
        let key = (c[0] >> BITS) | (c[1] >> BITS) << 21 | (c[2] >> BITS) << 42;
        let place = (c[0] & WITHIN | (c[1] & WITHIN) << BITS | (c[2] & WITHIN) << (2 * BITS)) as usize;
        if self.last.0 != key {
            let tiles = &mut self.tiles;
            let tile = *self.index.entry(key).or_insert_with(|| {
                tiles.push(Tile {
                    value: [0.0; PLACES],
                    first_vertex: [u32::MAX; PLACES],
                    mask: [0; PLACES],
                    evaluated: [0; PLACES / 64],
                    visited: [0; PLACES / 64],
                });
                tiles.len() as u32 - 1
            });
            self.last = (key, tile);
        }
        (self.last.1 as usize, place)
    }

    #[inline]
    fn node(&mut self, n: Node) -> f64 {
        let (tile, place) = self.locate(n);
        self.value_at(tile, place, n)
    }

    #[inline]
    fn value_at(&mut self, tile: usize, place: usize, n: Node) -> f64 {
        let known = &mut self.tiles[tile].evaluated[place / 64];
        if *known >> (place % 64) & 1 == 0 {
            *known |= 1 << (place % 64);
            self.tiles[tile].value[place] = self.value.value(n);
        }
        self.tiles[tile].value[place]
    }

    /// Values at the corners of a cell.
    fn corners(&mut self, cell: Node) -> [f64; 8] {
        let mut v = [0.0; 8];
        let (tile, place) = self.locate(cell);
        let last = WITHIN as usize;
        let inner = place & last != last && place >> BITS & last != last && place >> (2 * BITS) != last;
        for (c, v) in v.iter_mut().enumerate() {
            let n = corner(cell, c);
            *v = if inner {
                let offset = (c & 1) | (c >> 1 & 1) << BITS | (c >> 2) << (2 * BITS);
                self.value_at(tile, place + offset, n)
            } else {
                self.node(n)
            };
        }
        v
    }

    /// Returns the crossed cells connected to the seeds through crossed faces, with sign masks. Appends the vertices of
    /// their patches to `points`.
    fn flood(
        &mut self,
        seeds: &[Node],
        max_cells: usize,
        watch: &Watch,
        points: &mut Vec<Point3>,
    ) -> Result<Vec<(Node, u8)>, SurfaceError> {
        let mut cells = Vec::new();
        let mut stack = Vec::new();
        for &seed in seeds {
            self.visit(seed, &mut stack)?;
            while let Some(cell) = stack.pop() {
                let value = self.corners(cell);
                let mask = (0..8).fold(0, |mask, c| mask | u8::from(value[c] < 0.0) << c);
                if mask == 0 || mask == u8::MAX {
                    continue;
                }
                if cells.len() == max_cells {
                    return Err(SurfaceError::TooLarge { cells: max_cells as f64 + 1.0, limit: max_cells });
                }
                if cells.len().is_multiple_of(ASKED_EVERY) {
                    watch.spend(ASKED_EVERY * OPERATIONS + self.value.operations())?;
                }
                let (tile, place) = self.locate(cell);
                self.tiles[tile].mask[place] = mask;
                self.tiles[tile].first_vertex[place] = points.len() as u32;
                patch_vertices(cell, mask, &value, points);
                cells.push((cell, mask));
                for (face, edges) in FACE_EDGES.iter().enumerate() {
                    let case = &CASES[mask as usize];
                    if edges.iter().any(|&e| case.patch_of_edge[e as usize] != NONE) {
                        let mut next = cell;
                        next[face / 2] += if face % 2 == 1 { 1 } else { -1 };
                        self.visit(next, &mut stack)?;
                    }
                }
            }
        }
        Ok(cells)
    }

    /// Pushes a cell unless it was visited before.
    fn visit(&mut self, cell: Node, stack: &mut Vec<Node>) -> Result<(), SurfaceError> {
        if cell.iter().any(|x| x.abs() >= MAX_COORDINATE) {
            return Err(SurfaceError::TooLarge { cells: f64::INFINITY, limit: MAX_COORDINATE as usize });
        }
        let (tile, place) = self.locate(cell);
        let visited = &mut self.tiles[tile].visited[place / 64];
        if *visited >> (place % 64) & 1 == 0 {
            *visited |= 1 << (place % 64);
            stack.push(cell);
        }
        Ok(())
    }

    /// Crossing of the level with the grid edge from `n` along axis `d`.
    fn crossing(&mut self, n: Node, d: usize) -> Point3 {
        let mut end = n;
        end[d] += 1;
        let (v0, v1) = (self.node(n), self.node(end));
        let mut p = position(n);
        p[d] += (v0 / (v0 - v1)).clamp(0.02, 0.98);
        p
    }

    /// First vertex and sign mask of a crossed cell.
    fn crossed(&mut self, cell: Node) -> (u32, u8) {
        let (tile, place) = self.locate(cell);
        (self.tiles[tile].first_vertex[place], self.tiles[tile].mask[place])
    }
}

/// One vertex per patch of a cell, at the mean of the patch's crossings.
fn patch_vertices(cell: Node, mask: u8, value: &[f64; 8], points: &mut Vec<Point3>) {
    let case = &CASES[mask as usize];
    let mut sums = [(Vec3::zeros(), 0.0); 4];
    for e in 0..12 {
        let patch = case.patch_of_edge[e];
        if patch != NONE {
            let [p, q] = edge_corners(e);
            let mut at = Vec3::new((p & 1) as f64, (p >> 1 & 1) as f64, (p >> 2 & 1) as f64);
            at[e / 4] += (value[p] / (value[p] - value[q])).clamp(0.02, 0.98);
            let sum = &mut sums[patch as usize];
            sum.0 += at;
            sum.1 += 1.0;
        }
    }
    points.extend(sums[..case.patches as usize].iter().map(|(sum, count)| position(cell) + sum / *count));
}

fn corner(cell: Node, c: usize) -> Node {
    [cell[0] + (c & 1) as i32, cell[1] + (c >> 1 & 1) as i32, cell[2] + (c >> 2 & 1) as i32]
}

fn position(n: Node) -> Point3 {
    Point3::new(f64::from(n[0]), f64::from(n[1]), f64::from(n[2]))
}

fn shifted(n: Node, axis: usize, by: i32) -> Node {
    let mut m = n;
    m[axis] += by;
    m
}

/// Corner of the polygon around a crossed grid edge.
#[derive(Clone, Copy)]
struct Around {
    cell: Node,
    mask: u8,
    vertex: u32,
}

struct DualMesh {
    mesh: TriMesh,
    /// Vertices in the middle of doubled edges, by face (cell, axis) and the inside node cut off by the segment.
    midpoints: FxHashMap<(Node, usize, Node), u32>,
}

impl DualMesh {
    /// Adds the polygon of the crossed grid edge from `n` along axis `d`; `inside` tells if `n` is inside.
    fn crossing<F: Sampled>(&mut self, grid: &mut SparseGrid<F>, n: Node, d: usize, inside: bool) {
        let (u, v) = ((d + 1) % 3, (d + 2) % 3);
        // Counter-clockwise seen from the far end of the edge.
        let cells = [n, shifted(n, u, -1), shifted(shifted(n, u, -1), v, -1), shifted(n, v, -1)];
        let edges = [4 * d, 4 * d + 1, 4 * d + 3, 4 * d + 2];
        let ring: [Around; 4] = std::array::from_fn(|i| {
            let (first, mask) = grid.crossed(cells[i]);
            let patch = CASES[mask as usize].patch_of_edge[edges[i]];
            Around { cell: cells[i], mask, vertex: first + u32::from(patch) }
        });
        // The faces between consecutive cells: axis across, and which of the two cells is the upper one.
        let across = [u, v, u, v];
        let upper_first = [true, true, false, false];
        let middles: [Option<u32>; 4] = std::array::from_fn(|i| {
            let (a, b) = (ring[i], ring[(i + 1) % 4]);
            let (upper, lower) = if upper_first[i] { (a, b) } else { (b, a) };
            doubled(upper, lower, across[i]).then(|| self.midpoint(grid, upper.cell, across[i], n, d, inside))
        });
        let mut quad = ring.map(|a| a.vertex);
        if middles.iter().all(Option::is_none) {
            if !inside {
                quad.reverse();
            }
            self.split_quad(quad);
            return;
        }
        let mut polygon: Vec<u32> = Vec::with_capacity(8);
        for i in 0..4 {
            polygon.push(quad[i]);
            polygon.extend(middles[i]);
        }
        if !inside {
            polygon.reverse();
        }
        let center = self.mesh.points.len() as u32;
        self.mesh.points.push(grid.crossing(n, d));
        for i in 0..polygon.len() {
            self.mesh.triangles.push([center, polygon[i], polygon[(i + 1) % polygon.len()]]);
        }
    }

    /// Returns the middle vertex of the segment that crosses edge (n, d) on the lower face of `cell` across `axis`.
    fn midpoint<F: Sampled>(
        &mut self,
        grid: &mut SparseGrid<F>,
        cell: Node,
        axis: usize,
        n: Node,
        d: usize,
        inside: bool,
    ) -> u32 {
        let corner = if inside { n } else { shifted(n, d, 1) };
        if let Some(&vertex) = self.midpoints.get(&(cell, axis, corner)) {
            return vertex;
        }
        // Other edge of the face at the inside corner that the segment cuts off.
        let other = 3 - axis - d;
        let start = if corner[other] == cell[other] { corner } else { shifted(corner, other, -1) };
        let p = nalgebra::center(&grid.crossing(n, d), &grid.crossing(start, other));
        let vertex = self.mesh.points.len() as u32;
        self.mesh.points.push(p);
        self.midpoints.insert((cell, axis, corner), vertex);
        vertex
    }

    /// Splits a quadrilateral along the diagonal with the larger minimum angle.
    fn split_quad(&mut self, [a, b, c, d]: [u32; 4]) {
        let cosine = |x: u32, y: u32, z: u32| {
            let p = |i: u32| self.mesh.points[i as usize];
            largest_cosine(&p(x), &p(y), &p(z))
        };
        let ac = cosine(a, b, c).max(cosine(a, c, d));
        let bd = cosine(a, b, d).max(cosine(b, c, d));
        let halves = if ac <= bd { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        self.mesh.triangles.extend(halves);
    }
}

/// True if two cells share both segments of their common face within one patch each.
fn doubled(upper: Around, lower: Around, axis: usize) -> bool {
    let (cu, cl) = (&CASES[upper.mask as usize], &CASES[lower.mask as usize]);
    if cu.ambiguous >> (2 * axis) & 1 == 0 {
        return false;
    }
    let one = |patches: &[u8; 12], face: usize| {
        let [a, b, c, d] = FACE_EDGES[face].map(|e| patches[e as usize]);
        a == b && b == c && c == d
    };
    one(&cu.patch_of_edge, 2 * axis) && one(&cl.patch_of_edge, 2 * axis + 1)
}
