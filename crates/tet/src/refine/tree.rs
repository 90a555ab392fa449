//! Size field as a graded octree. Cubes are halved to shorten edges, and neighbours differ by at most one level, so
//! that sizes grow slowly away from fine parts.

use super::grading::Grading;
use super::sizes::SizeLimit;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use std::f64::consts::TAU;
use std::ops::Range;

/// Maximum side of a cube, relative to the side that gives the mean edge length wanted in it.
const SPLIT_ABOVE: f64 = 1.414;

/// Maximum side of a cube, relative to the side that gives the shortest edge length wanted in it.
const SPLIT_ABOVE_LEAST: f64 = 2.0 * SPLIT_ABOVE;

/// As [`SPLIT_ABOVE`], away from the surface, for cubes whose points are selected.
const SPLIT_ABOVE_FINE: f64 = 0.8;

/// As [`SPLIT_ABOVE`], for lengths from a function of the position.
const SPLIT_ABOVE_FUNCTION: f64 = 1.2;

/// Edge length of a body-centred lattice: sides of its cubes.
const EDGE: f64 = 1.0 / 1.08;

/// Height of a layer of tetrahedra, in edge lengths.
const LAYER: f64 = 0.75;

/// Maximum split cubes; some 400 MB.
const MAX_SPLITS: usize = 4_000_000;

/// Maximum levels below the coarsest.
const MAX_LEVEL: u32 = 20;

/// Upper bound of cube indices at the finest level.
const MAX_INDEX: f64 = 1_000_000.0;

/// Options of a size field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeOptions {
    /// Side of the cubes, in edge lengths wanted.
    pub cell: f64,
    /// Edge length wanted at the surface, in edge lengths of the surface.
    pub first: f64,
    /// Distance over which the side of inner cubes doubles, in sides; at least 1. `None`: inner cubes do not exceed the
    /// size asked for by the coarse parts of the surface.
    pub doubling: Option<f64>,
    /// Increase of the edge length per distance from the surface.
    pub slope: f64,
    /// True if the cubes are to be smaller than the edge lengths wanted, so that points can be selected.
    pub is_fine: bool,
}

impl Default for TreeOptions {
    fn default() -> Self {
        Self { cell: 1.4, first: 1.0, doubling: None, slope: 0.0, is_fine: false }
    }
}

impl TreeOptions {
    /// Edge length of a body-centred lattice with cubes of this side.
    pub fn edge_of(side: f64) -> f64 {
        side * EDGE
    }

    /// Options for a ratio of edge lengths in adjacent layers of tetrahedra. The first layer is longer than the edges
    /// of the surface by the same ratio.
    pub fn growing(growth: f64) -> Self {
        let slope = (growth - 1.0).max(0.0) / LAYER;
        let doubling = Some((EDGE / slope).clamp(1.0, MAX_DOUBLING));
        Self { cell: 1.0 / EDGE, first: growth, doubling, slope, is_fine: false }
    }
}

/// Maximum distance over which sides double, in sides. Reached at a growth of 1.09.
const MAX_DOUBLING: f64 = 8.0;

/// Octree of a size field. Levels count from the coarsest cubes. Cube `[i, j, k]` of level `l` has its lowest corner at
/// `origin + [i, j, k] * side / 2^l`.
#[derive(Clone, Debug)]
pub struct SizeTree {
    pub(super) origin: Point3,
    pub(super) side: f64,
    /// Split cubes of each level.
    split: Vec<FxHashSet<[i32; 3]>>,
    splits: usize,
    /// Edge length wanted, relative to the side of the cube.
    per_side: f64,
    /// Distance from a split cube within which cubes twice as large are split, in its sides.
    doubling: f64,
    /// Lengths away from the surface; `None` if they do not grow, or are also those of a function.
    grading: Option<Grading>,
    /// Maximum edge length of cubes, relative to that of the grading.
    coarsest: f64,
}

impl SizeTree {
    /// Builds the size field of a surface with edge lengths `sizes` at its vertices and further bounds. Returns `None`
    /// for a surface without extent or with sizes that are not positive.
    pub fn new(surface: &TriMesh, sizes: &[f64], limits: &[SizeLimit], options: &TreeOptions) -> Option<Self> {
        let mut wanted: Vec<f64> = sizes.iter().map(|h| options.first * h).collect();
        for limit in limits {
            match limit {
                SizeLimit::PerVertex(bound) => wanted.iter_mut().zip(*bound).for_each(|(w, b)| *w = w.min(*b)),
                SizeLimit::Constant(bound) => wanted.iter_mut().for_each(|w| *w = w.min(*bound)),
                SizeLimit::Inside(_) | SizeLimit::Function(_) => {}
            }
        }
        let inside = inside(limits);
        let percentile = coarsest(surface, &wanted);
        let constant = limits.iter().filter_map(SizeLimit::constant).fold(f64::INFINITY, f64::min);
        let reference = match options.doubling {
            // Cubes of exactly this size, where the bound is the smallest length.
            Some(_) => middle(wanted.iter().chain(&inside.1))?.min(constant),
            None => surface.mean_edge(),
        };
        let usable = reference > 0.0 && percentile > 0.0 && percentile.is_finite() && options.cell > 0.0;
        if !usable {
            return None;
        }
        let (low, extent) = bounds(surface);
        let mut side = options.cell * reference;
        // Coarsest cubes: as large as the coarse parts of the surface or the bound allow.
        let limit = match options.doubling {
            Some(_) => extent.min(1.001 * options.cell * constant),
            None => SPLIT_ABOVE * options.cell * percentile,
        };
        while side * 2.0 <= limit && side < extent {
            side *= 2.0;
        }
        while side > limit {
            side *= 0.5;
        }
        if extent / side >= MAX_INDEX {
            return None;
        }
        let mut levels = 0;
        while levels < MAX_LEVEL && extent / side * f64::from(1_u32 << (levels + 1)) < MAX_INDEX {
            levels += 1;
        }
        let split = vec![FxHashSet::default(); levels as usize];
        let doubling = options.doubling.unwrap_or(1.0);
        // A function may ask for fine cubes far from the surface.
        let is_free = limits.iter().any(|limit| matches!(limit, SizeLimit::Function(_)));
        let is_graded = options.doubling.is_some_and(|doubling| !is_free && (options.is_fine || doubling > 1.0));
        let sources = || [(surface.points.as_slice(), wanted.as_slice()), (&inside.0, &inside.1)];
        let grading = is_graded.then(|| Grading::new(sources(), options.slope, constant));
        let coarsest = if options.is_fine { SPLIT_ABOVE_FINE } else { SPLIT_ABOVE };
        let per_side = 1.0 / options.cell;
        let mut tree = Self { origin: low, side, split, splits: 0, per_side, doubling, grading, coarsest };
        tree.split_at(&surface.points, &wanted);
        // Between the points of a surface are its edges. Points inside need as fine cubes as other places.
        let share = if options.is_fine { SPLIT_ABOVE_FINE / SPLIT_ABOVE } else { 1.0 };
        tree.split_at(&inside.0, &inside.1.iter().map(|h| share * h).collect::<Vec<f64>>());
        for limit in limits {
            if let SizeLimit::Function(f) = limit {
                tree.split_by(surface, f);
            }
        }
        tree.balance();
        Some(tree)
    }

    /// Lengths away from the surface, if they grow.
    pub fn grading(&self) -> Option<&Grading> {
        self.grading.as_ref()
    }

    /// Side of the cubes of a level.
    pub fn side(&self, level: usize) -> f64 {
        self.side / (1_u64 << level) as f64
    }

    /// True if the limit of split cubes left some cubes too large.
    pub fn is_truncated(&self) -> bool {
        self.splits >= MAX_SPLITS
    }

    /// Split cubes of a level, in a deterministic order.
    pub fn split_cubes(&self, level: usize) -> impl Iterator<Item = [i32; 3]> {
        self.split[level].iter().copied()
    }

    /// Number of split cubes of a level.
    pub fn split_count(&self, level: usize) -> usize {
        self.split.get(level).map_or(0, FxHashSet::len)
    }

    /// Number of levels.
    pub fn levels(&self) -> usize {
        self.split.len()
    }

    /// True if a cube is split into eight.
    pub fn is_split(&self, level: usize, cube: [i32; 3]) -> bool {
        self.split.get(level).is_some_and(|s| s.contains(&cube))
    }

    /// True if all cubes have one size.
    #[cfg(test)]
    pub fn is_uniform(&self) -> bool {
        self.splits == 0
    }

    /// Cube of a level that contains a point.
    pub fn cube_at(&self, p: &Point3, level: usize) -> [i32; 3] {
        let d = (p - self.origin) / self.side(level);
        // Saturates for points far outside.
        [d.x.floor() as i32, d.y.floor() as i32, d.z.floor() as i32]
    }

    /// Edge length wanted at a point.
    pub fn size_at(&self, p: &Point3) -> f64 {
        let mut level = 0;
        while self.is_split(level, self.cube_at(p, level)) {
            level += 1;
        }
        self.side(level) * self.per_side
    }

    fn insert(&mut self, level: usize, cube: [i32; 3]) -> bool {
        if self.splits >= MAX_SPLITS {
            return false;
        }
        let fresh = self.split[level].insert(cube);
        self.splits += usize::from(fresh);
        fresh
    }

    /// Splits the cubes around points until they are small enough for the edge lengths `wanted` there.
    fn split_at(&mut self, points: &[Point3], wanted: &[f64]) {
        let used = |v: &u32| wanted[*v as usize] > 0.0;
        let mut list: Vec<u32> = (0..points.len().min(wanted.len()) as u32).filter(used).collect();
        let mut stack = Vec::new();
        self.push_groups(points, 0, &mut list, 0, &mut stack);
        while let Some((level, range)) = stack.pop() {
            let group: &mut [u32] = &mut list[range.clone()];
            let (mut sum, mut least) = (0.0, f64::INFINITY);
            for &v in group.iter() {
                let h = wanted[v as usize];
                sum += libm::log(h);
                least = h.min(least);
            }
            let size = self.side(level) * self.per_side;
            let mean = libm::exp(sum / group.len() as f64);
            if level < self.levels() && (size > SPLIT_ABOVE * mean || size > SPLIT_ABOVE_LEAST * least) {
                let cube = self.cube_at(&points[group[0] as usize], level);
                self.insert(level, cube);
                self.push_groups(points, level + 1, group, range.start, &mut stack);
            }
        }
    }

    /// Sorts points by their cubes of a level, and adds a range for each cube to the stack. The list begins at `start`.
    fn push_groups(
        &self,
        points: &[Point3],
        level: usize,
        list: &mut [u32],
        start: usize,
        stack: &mut Vec<(usize, Range<usize>)>,
    ) {
        let cube = |v: &u32| self.cube_at(&points[*v as usize], level);
        list.sort_by_cached_key(cube);
        let mut at = start;
        for group in list.chunk_by(|v, w| cube(v) == cube(w)) {
            stack.push((level, at..at + group.len()));
            at += group.len();
        }
    }

    /// Splits the cubes in the surface's bounding box as the size function asks.
    fn split_by(&mut self, surface: &TriMesh, f: &dyn Fn(&Point3) -> f64) {
        let (_, extent) = bounds(surface);
        let high = surface.points.iter().fold(self.origin, |m, p| m.sup(p));
        let last = self.cube_at(&high, 0);
        // Largest cube side at which one sample of the function suffices.
        let look = extent / 16.0;
        let mut stack: Vec<(usize, [i32; 3])> = Vec::new();
        for i in 0..=last[0] {
            for j in 0..=last[1] {
                for k in 0..=last[2] {
                    stack.push((0, [i, j, k]));
                    while let Some((level, cube)) = stack.pop() {
                        self.split_one(f, look, level, cube, &mut stack);
                    }
                }
            }
            if self.splits >= MAX_SPLITS {
                return;
            }
        }
    }

    fn split_one(
        &mut self,
        f: &dyn Fn(&Point3) -> f64,
        look: f64,
        level: usize,
        cube: [i32; 3],
        stack: &mut Vec<(usize, [i32; 3])>,
    ) {
        if level >= self.levels() {
            return;
        }
        let side = self.side(level);
        let corner = Vec3::new(f64::from(cube[0]), f64::from(cube[1]), f64::from(cube[2]));
        let at = |x: f64, y: f64, z: f64| f(&(self.origin + (corner + Vec3::new(x, y, z)) * side));
        let mut h = at(0.5, 0.5, 0.5);
        if side > look {
            for (x, y, z) in [(0.2, 0.2, 0.2), (0.8, 0.8, 0.2), (0.8, 0.2, 0.8), (0.2, 0.8, 0.8)] {
                h = h.min(at(x, y, z));
            }
        }
        let split = h > 0.0 && side * self.per_side > SPLIT_ABOVE_FUNCTION * h;
        if split && !self.is_split(level, cube) && !self.insert(level, cube) {
            return;
        }
        if self.is_split(level, cube) {
            stack.extend(children(cube).map(|c| (level + 1, c)));
        }
    }

    /// Splits cubes until sizes grow slowly enough. Neighbours, including those across corners, then differ by at most
    /// one level. Others near a split cube are split if they are too large for the lengths of a grading at their centres.
    fn balance(&mut self) {
        // Distance between cubes of two levels whose size is that of the grading, and a cube more.
        let reach = self.grading.as_ref().map_or(self.doubling, |_| self.doubling / self.coarsest + 1.0);
        for level in (1..self.levels()).rev() {
            let cubes: Vec<[i32; 3]> = self.split[level].iter().copied().collect();
            let mut open: FxHashSet<[i32; 3]> = FxHashSet::default();
            for cube in cubes {
                for parent in parents(cube, 1.0) {
                    self.insert(level - 1, parent);
                }
                // Without a doubling of its own, balance alone splits cubes.
                if self.doubling > 1.0 {
                    open.extend(parents(cube, reach).filter(|parent| !self.is_split(level - 1, *parent)));
                }
            }
            let open: Vec<[i32; 3]> = open.into_iter().collect();
            let is_coarse = |parent: &[i32; 3]| self.is_coarse(level - 1, *parent);
            let coarse: Vec<[i32; 3]> = open.into_par_iter().filter(is_coarse).collect();
            for parent in coarse {
                self.insert(level - 1, parent);
            }
        }
    }

    /// True if a cube exceeds the length of the grading at its centre.
    fn is_coarse(&self, level: usize, cube: [i32; 3]) -> bool {
        let Some(grading) = &self.grading else { return true };
        let side = self.side(level);
        let centre = self.origin + Vec3::from(cube.map(|i| f64::from(i) + 0.5)) * side;
        grading.is_below(&centre, side * self.per_side / self.coarsest)
    }
}

/// Cubes of the coarser level within a distance of a cube, in its sides.
fn parents(cube: [i32; 3], reach: f64) -> impl Iterator<Item = [i32; 3]> {
    // The margin excludes cubes that only touch.
    let reach = reach - 1e-9;
    let [x, y, z] = cube.map(|i| {
        let end = |x: f64| (x / 2.0).floor() as i32;
        end(f64::from(i) - reach)..=end(f64::from(i) + 1.0 + reach)
    });
    x.flat_map(move |x| {
        let z = z.clone();
        y.clone().flat_map(move |y| z.clone().map(move |z| [x, y, z]))
    })
}

/// The eight cubes of the next level.
pub(super) fn children([i, j, k]: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    (0..8).map(move |n| [2 * i + (n & 1), 2 * j + ((n >> 1) & 1), 2 * k + (n >> 2)])
}

/// Lowest corner of a surface's bounding box and its longest side.
fn bounds(surface: &TriMesh) -> (Point3, f64) {
    let Some(first) = surface.points.first() else { return (Point3::origin(), 0.0) };
    let (low, high) = surface.points.iter().fold((*first, *first), |(l, h), p| (l.inf(p), h.sup(p)));
    (low, (high - low).max())
}

/// Points inside with a bound, and the bounds.
fn inside(limits: &[SizeLimit]) -> (Vec<Point3>, Vec<f64>) {
    let of_limit = |limit: &SizeLimit| match limit {
        SizeLimit::Inside(points) => points.to_vec(),
        _ => Vec::new(),
    };
    limits.iter().flat_map(of_limit).unzip()
}

/// Edge length of the coarse parts of a surface: the 90th percentile by area.
fn coarsest(surface: &TriMesh, sizes: &[f64]) -> f64 {
    let mut parts: Vec<(f64, f64)> = Vec::with_capacity(surface.triangles.len());
    for t in &surface.triangles {
        let [a, b, c] = t.map(|v| surface.points[v as usize]);
        let size = t.iter().map(|&v| sizes.get(v as usize).copied().unwrap_or(0.0)).sum::<f64>() / 3.0;
        parts.push((size, (b - a).cross(&(c - a)).norm()));
    }
    parts.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
    let total: f64 = parts.iter().map(|p| p.1).sum();
    let mut sum = 0.0;
    for (size, area) in parts {
        sum += area;
        if sum >= 0.9 * total {
            return size;
        }
    }
    0.0
}

/// Edge length in the middle of the octaves of given lengths: the circular mean of their logarithms. Cubes whose sides
/// are powers of two times this length deviate least from the lengths.
fn middle<'a>(sizes: impl Iterator<Item = &'a f64>) -> Option<f64> {
    let (mut x, mut y, mut sum, mut count) = (0.0, 0.0, 0.0, 0.0);
    for &h in sizes.filter(|&&h| h > 0.0 && h.is_finite()) {
        let (sine, cosine) = libm::sincos(TAU * libm::log2(h));
        (x, y) = (x + cosine, y + sine);
        (sum, count) = (sum + libm::log2(h), count + 1.0);
    }
    if count == 0.0 {
        return None;
    }
    let (mean, phase) = (sum / count, libm::atan2(y, x) / TAU);
    Some(libm::exp2(phase + (mean - phase).round()))
}
