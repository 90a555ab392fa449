//! Interior points on a graded body-centred lattice: the corners and centres of the leaves of a size field's octree.
//! (Labelle, Shewchuk, 'Isosurface stuffing', 2007: the background grid.)

use super::tree::{SizeTree, children};
use super::wall::Wall;
use crate::delaunay::hash;
use crate::progress::{Counter, Watch};
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

/// Jitter of a point, relative to the side of the smallest adjacent cube.
const JITTER: f64 = 0.02;

/// Maximum points made.
const MAX_POINTS: usize = 50_000_000;

/// Operations per site, as counted by budgets.
const OPERATIONS: usize = 20;

/// Sites that are tested in parallel between two checks for cancellation.
const BATCH: usize = 1 << 14;

/// Lattice position in half sides of the finest cubes, packed, with the level of the finest cube there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct LatticeSite {
    key: u64,
    /// Number of levels between the tree's finest and the finest cube here. Small values sort first.
    coarseness: u8,
    /// 0: known to lie inside; 1: must be tested.
    unknown: u8,
}

/// Points inside the surface of `wall` with the spacing of `tree`. They keep the clearance of the wall. The result is
/// deterministic.
///
/// # Errors
/// [`Stop`] if the watch stops it.
pub fn graded_points(tree: &SizeTree, wall: &Wall, watch: &Watch) -> Result<Vec<Point3>, Stop> {
    points_on(tree, wall, |p| wall.holds(p), watch)
}

/// As [`graded_points`], with points on both sides of the surface.
///
/// # Errors
/// See [`graded_points`].
pub fn surrounding_points(tree: &SizeTree, wall: &Wall, watch: &Watch) -> Result<Vec<Point3>, Stop> {
    points_on(tree, wall, |_| true, watch)
}

/// Points that `wanted` accepts, and those known to lie inside.
fn points_on(
    tree: &SizeTree,
    wall: &Wall,
    wanted: impl Fn(&Point3) -> bool + Sync,
    watch: &Watch,
) -> Result<Vec<Point3>, Stop> {
    let sites = sites(tree, wall);
    let finest = tree.levels();
    let mut points = Vec::new();
    let mut counter = Counter::new(watch);
    let groups: Vec<&[LatticeSite]> = sites.chunk_by(|x, y| x.key == y.key).collect();
    let point = |group: &&[LatticeSite]| {
        let side = tree.side(finest - usize::from(group[0].coarseness));
        let p = place(tree, group[0].key, side);
        let inside = group.iter().any(|s| s.unknown == 0);
        ((inside || wanted(&p)) && wall.is_clear(&p, side)).then_some(p)
    };
    for batch in groups.chunks(BATCH) {
        counter.add(OPERATIONS * batch.len())?;
        points.par_extend(batch.par_iter().filter_map(point));
    }
    counter.end()?;
    Ok(points)
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
fn sites(tree: &SizeTree, wall: &Wall) -> Vec<LatticeSite> {
    let mut touched: FxHashSet<[i32; 3]> = FxHashSet::default();
    for aabb in (0..wall.surface.triangles.len()).map(|place| wall.bvh.box_at(place)) {
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
    cubes.extend(inner_cubes(tree, wall, &touched).into_iter().map(|c| (c, 0)));
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

fn push_leaf(tree: &SizeTree, level: usize, cube: [i32; 3], unknown: u8, sites: &mut Vec<LatticeSite>) {
    let coarseness = (tree.levels() - level) as u8;
    // Width of a cube at this level, in half sides of the finest cubes.
    let width = 2_i64 << coarseness;
    let mut push = |offset: [i64; 3]| {
        let at: [i64; 3] = std::array::from_fn(|i| i64::from(cube[i]) * width + offset[i]);
        if at.iter().all(|x| (0..1 << 21).contains(x)) {
            let key = at[0] as u64 | (at[1] as u64) << 21 | (at[2] as u64) << 42;
            sites.push(LatticeSite { key, coarseness, unknown });
        }
    };
    push([width / 2; 3]);
    for n in 0..8 {
        push([(n & 1) * width, ((n >> 1) & 1) * width, (n >> 2) * width]);
    }
}

/// Coarsest cubes inside that no triangle touches.
fn inner_cubes(tree: &SizeTree, wall: &Wall, touched: &FxHashSet<[i32; 3]>) -> Vec<[i32; 3]> {
    let high = wall.surface.points.iter().fold(tree.origin, |m, p| m.sup(p));
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
