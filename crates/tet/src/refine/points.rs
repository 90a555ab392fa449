//! Interior points on a graded body-centred lattice: the corners and centres of the leaves of a size field's octree.
//! (Labelle, Shewchuk, 'Isosurface stuffing', 2007: the background grid.)

use super::tree::{SizeTree, children};
use crate::delaunay::hash;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Vec3, point_triangle};
use rustc_hash::FxHashSet;

/// Jitter of a point, relative to the side of the smallest adjacent cube.
const JITTER: f64 = 0.02;

/// Maximum points made.
const MAX_POINTS: usize = 50_000_000;

/// Lattice position in half sides of the finest cubes, packed, with the level of the finest cube there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Site {
    key: u64,
    /// Number of levels between the tree's finest and the finest cube here. Small values sort first.
    coarseness: u8,
    /// 0: known to lie inside; 1: must be tested.
    unknown: u8,
}

/// Points inside the closed `surface` with the spacing of `tree`. They keep at least `clearance` times the local edge
/// length from the wall; `sizes` are the edge lengths at the surface's vertices. The result is deterministic.
pub fn graded_points(surface: &TriMesh, sizes: &[f64], tree: &SizeTree, clearance: f64) -> Vec<Point3> {
    let boxes: Vec<Aabb> =
        surface.triangles.iter().map(|t| Aabb::of_points(t.map(|v| &surface.points[v as usize]))).collect();
    let bvh = Bvh::new(&boxes);
    let wall = Wall { surface, sizes, bvh: &bvh, clearance };
    let sites = sites(surface, tree, &boxes, &wall);
    let finest = tree.levels();
    let mut points = Vec::new();
    for group in sites.chunk_by(|x, y| x.key == y.key) {
        let level = finest - usize::from(group[0].coarseness);
        let side = tree.side(level);
        let p = place(tree, group[0].key, side);
        let inside = group.iter().any(|s| s.unknown == 0);
        if (inside || wall.holds(&p)) && wall.is_clear(&p, side) {
            points.push(p);
        }
    }
    points
}

/// Jittered position of a site.
fn place(tree: &SizeTree, key: u64, side: f64) -> Point3 {
    let half = tree.side(tree.levels()) / 2.0;
    let part = |shift: u32| ((key >> shift) & 0x1f_ffff) as f64;
    let h = hash(key);
    let coin = |shift: u32| ((h >> shift) & 0x1f_ffff) as f64 / f64::from(0x10_0000) - 1.0;
    tree.origin
        + Vec3::new(part(0), part(21), part(42)) * half
        + Vec3::new(coin(0), coin(21), coin(42)) * (JITTER * side)
}

/// Sorted corners and centres of all leaves in or near the surface, repeated where several leaves meet.
fn sites(surface: &TriMesh, tree: &SizeTree, boxes: &[Aabb], wall: &Wall) -> Vec<Site> {
    let mut touched: FxHashSet<[i32; 3]> = FxHashSet::default();
    for aabb in boxes {
        let (low, high) = (tree.cube_at(&aabb.min, 0), tree.cube_at(&aabb.max, 0));
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                touched.extend((low[2]..=high[2]).map(|k| [i, j, k]));
            }
        }
        if touched.len() > MAX_POINTS {
            break;
        }
    }
    let mut cubes: Vec<([i32; 3], u8)> = touched.iter().map(|&c| (c, 1)).collect();
    cubes.extend(inner_cubes(surface, tree, wall, &touched).into_iter().map(|c| (c, 0)));
    cubes.sort_unstable();
    let mut sites = Vec::new();
    let mut stack = Vec::new();
    for (cube, unknown) in cubes {
        stack.push((0, cube));
        while let Some((level, cube)) = stack.pop() {
            if tree.is_split(level, cube) {
                stack.extend(children(cube).map(|c| (level + 1, c)));
            } else {
                push_leaf(tree, level, cube, unknown, &mut sites);
            }
        }
        if sites.len() > 9 * MAX_POINTS {
            break;
        }
    }
    sites.sort_unstable();
    sites.dedup();
    sites
}

fn push_leaf(tree: &SizeTree, level: usize, cube: [i32; 3], unknown: u8, sites: &mut Vec<Site>) {
    let coarseness = (tree.levels() - level) as u8;
    // Width of a cube at this level, in half sides of the finest cubes.
    let width = 2_i64 << coarseness;
    let mut push = |offset: [i64; 3]| {
        let at: [i64; 3] = std::array::from_fn(|i| i64::from(cube[i]) * width + offset[i]);
        if at.iter().all(|x| (0..1 << 21).contains(x)) {
            let key = at[0] as u64 | (at[1] as u64) << 21 | (at[2] as u64) << 42;
            sites.push(Site { key, coarseness, unknown });
        }
    };
    push([width / 2; 3]);
    for n in 0..8 {
        push([(n & 1) * width, ((n >> 1) & 1) * width, (n >> 2) * width]);
    }
}

/// Coarsest cubes inside that no triangle touches.
fn inner_cubes(surface: &TriMesh, tree: &SizeTree, wall: &Wall, touched: &FxHashSet<[i32; 3]>) -> Vec<[i32; 3]> {
    let high = surface.points.iter().fold(tree.origin, |m, p| m.sup(p));
    let last = tree.cube_at(&high, 0);
    let mut seen: FxHashSet<[i32; 3]> = FxHashSet::default();
    let mut inner = Vec::new();
    let mut stack = Vec::new();
    let mut starts: Vec<[i32; 3]> = touched.iter().copied().collect();
    starts.sort_unstable();
    let around = |c: [i32; 3]| {
        [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]]
            .map(|d: [i32; 3]| [c[0] + d[0], c[1] + d[1], c[2] + d[2]])
    };
    let in_box = |c: &[i32; 3]| (0..3).all(|i| (0..=last[i]).contains(&c[i]));
    for start in starts {
        for seed in around(start) {
            if !in_box(&seed) || touched.contains(&seed) || seen.contains(&seed) {
                continue;
            }
            // A component of untouched cubes is all inside or all outside. Outer ones are not traversed.
            let center = Vec3::new(f64::from(seed[0]), f64::from(seed[1]), f64::from(seed[2])).add_scalar(0.5);
            seen.insert(seed);
            if !wall.holds(&(tree.origin + center * tree.side)) {
                continue;
            }
            stack.push(seed);
            while let Some(cube) = stack.pop() {
                inner.push(cube);
                for n in around(cube) {
                    if in_box(&n) && !touched.contains(&n) && seen.insert(n) {
                        stack.push(n);
                    }
                }
                if inner.len() > MAX_POINTS {
                    return inner;
                }
            }
        }
    }
    inner
}

/// The surface with a bounding volume hierarchy.
struct Wall<'a> {
    surface: &'a TriMesh,
    sizes: &'a [f64],
    bvh: &'a Bvh,
    clearance: f64,
}

impl Wall<'_> {
    /// True if a point lies inside: a vertical ray meets an odd number of triangles. A ray that grazes an edge may give
    /// a wrong result; carving drops such points.
    fn holds(&self, p: &Point3) -> bool {
        let mut top = *p;
        top.z = f64::INFINITY;
        let mut odd = false;
        self.bvh.query(&Aabb { min: *p, max: top }, |t| {
            let [a, b, c] = self.surface.triangles[t as usize].map(|v| self.surface.points[v as usize] - p);
            let side = |u: &Vec3, v: &Vec3| u.x * v.y - u.y * v.x;
            let (w, u, v) = (side(&a, &b), side(&b, &c), side(&c, &a));
            let hit = (w > 0.0 && u > 0.0 && v > 0.0) || (w < 0.0 && u < 0.0 && v < 0.0);
            odd ^= hit && (u * a.z + v * b.z + w * c.z) / (u + v + w) > 0.0;
        });
        odd
    }

    /// True if a point is far enough from the wall. `side` is that of its smallest cube.
    fn is_clear(&self, p: &Point3, side: f64) -> bool {
        let reach = self.clearance * 2.0 * side;
        let mut clear = true;
        self.bvh.query(&Aabb { min: *p, max: *p }.grown(reach), |t| {
            if clear {
                let t = self.surface.triangles[t as usize];
                let corners = t.map(|v| self.surface.points[v as usize]);
                let (foot, distance) = point_triangle(p, corners.each_ref());
                clear = distance >= self.clearance * self.size_on(&t, &corners, &foot).min(2.0 * side);
            }
        });
        clear
    }

    /// Edge length at a point of a triangle, interpolated from its corners.
    fn size_on(&self, t: &[u32; 3], corners: &[Point3; 3], foot: &Point3) -> f64 {
        let [h0, h1, h2] = t.map(|v| self.sizes.get(v as usize).copied().unwrap_or(0.0));
        let [a, b, c] = corners.map(|p| p - foot);
        let normal = (b - a).cross(&(c - a));
        let total = normal.norm_squared();
        if total == 0.0 {
            return h0.min(h1).min(h2);
        }
        let part = |u: &Vec3, v: &Vec3| (u.cross(v).dot(&normal) / total).clamp(0.0, 1.0);
        part(&b, &c) * h0 + part(&c, &a) * h1 + part(&a, &b) * h2
    }
}
