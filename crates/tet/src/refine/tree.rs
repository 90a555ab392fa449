//! Size field as a graded octree. Cubes are halved to shorten edges, and neighbours differ by at most one level, so
//! that sizes grow slowly away from fine parts.

use super::sizes::SizeLimit;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rustc_hash::FxHashSet;

/// Maximum side of a cube, in edge lengths wanted in it.
const SPLIT_ABOVE: f64 = 1.87;

/// Maximum split cubes; beyond it the mesh stays coarser.
const MAX_SPLITS: usize = 4_000_000;

/// Maximum levels below the coarsest.
const MAX_LEVEL: u32 = 12;

/// Upper bound of cube indices at the finest level.
const MAX_INDEX: f64 = 1_000_000.0;

/// Options of a size field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeOptions {
    /// Cube side relative to the edge length at mean surface edges. Sides are this times the mean, times a power of
    /// two.
    pub cell: f64,
    /// True if inner cubes may exceed the size asked for by the coarse parts of the surface.
    pub coarsen: bool,
}

impl Default for TreeOptions {
    fn default() -> Self {
        Self { cell: 1.4, coarsen: false }
    }
}

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
}

impl SizeTree {
    /// Builds the size field of a surface with edge lengths `sizes` at its vertices and further bounds. Returns `None`
    /// for a surface without extent or with sizes that are not positive.
    pub fn new(surface: &TriMesh, sizes: &[f64], limits: &[SizeLimit], options: &TreeOptions) -> Option<Self> {
        let mut wanted = sizes.to_vec();
        for limit in limits {
            match limit {
                SizeLimit::PerVertex(bound) => wanted.iter_mut().zip(*bound).for_each(|(w, b)| *w = w.min(*b)),
                SizeLimit::Constant(bound) => wanted.iter_mut().for_each(|w| *w = w.min(*bound)),
                SizeLimit::Function(_) => {}
            }
        }
        let reference = surface.mean_edge();
        let coarsest = coarsest(surface, &wanted);
        let usable = reference > 0.0 && coarsest > 0.0 && coarsest.is_finite() && options.cell > 0.0;
        if !usable {
            return None;
        }
        let (low, extent) = bounds(surface);
        let mut side = options.cell * reference;
        // Coarsest cubes: as large as the coarse parts of the surface allow, or up to the whole if coarsening is on.
        let limit = if options.coarsen { extent } else { SPLIT_ABOVE / options.cell * options.cell * coarsest };
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
        let mut tree = Self { origin: low, side, split, splits: 0, per_side: 1.0 / options.cell };
        for (p, &h) in surface.points.iter().zip(&wanted) {
            if h > 0.0 {
                tree.split_at(p, h);
            }
        }
        for limit in limits {
            if let SizeLimit::Function(f) = limit {
                tree.split_by(surface, f);
            }
        }
        tree.balance();
        Some(tree)
    }

    /// Side of the cubes of a level.
    pub fn side(&self, level: usize) -> f64 {
        self.side / (1_u64 << level) as f64
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

    /// Splits the cubes around a point until they are small enough for edge length `h`.
    fn split_at(&mut self, p: &Point3, h: f64) {
        for level in 0..self.levels() {
            if self.side(level) <= SPLIT_ABOVE * h {
                return;
            }
            let cube = self.cube_at(p, level);
            self.insert(level, cube);
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
        let split = h > 0.0 && side > SPLIT_ABOVE * h;
        if split && !self.is_split(level, cube) && !self.insert(level, cube) {
            return;
        }
        if self.is_split(level, cube) {
            stack.extend(children(cube).map(|c| (level + 1, c)));
        }
    }

    /// Splits cubes until neighbours, including those across corners, differ by at most one level.
    fn balance(&mut self) {
        for level in (1..self.levels()).rev() {
            let cubes: Vec<[i32; 3]> = self.split[level].iter().copied().collect();
            for [i, j, k] in cubes {
                for x in [(i - 1) >> 1, (i + 1) >> 1] {
                    for y in [(j - 1) >> 1, (j + 1) >> 1] {
                        for z in [(k - 1) >> 1, (k + 1) >> 1] {
                            self.insert(level - 1, [x, y, z]);
                        }
                    }
                }
            }
        }
    }
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
