//! Edge lengths that grow linearly with the distance from points of a surface and inside.
//!
//! The length at a place is the least of h + slope · d over the points. Here h is the length at a point, and d its distance.

use anastomesh_mesh::geometry::hilbert::hilbert_keys;
use anastomesh_mesh::geometry::{Aabb, Point3};
use rayon::prelude::*;

/// Maximum points of a leaf of the search tree.
const LEAF: usize = 8;

/// Relative error of a length. Octree cubes are rounded to powers of two, so that it changes few of them.
const TOLERANCE: f64 = 0.02;

/// Depth of the stack of a search, sufficient for 2^32 points.
const STACK: usize = 64;

/// Places whose searches begin with the point before.
const CHUNK: usize = 1 << 10;

/// Index in place of a point.
const NONE: usize = usize::MAX;

/// Search tree over points with lengths. Node `i` has the children `2 i + 1` and `2 i + 2`, with a half of its points each.
#[derive(Clone, Debug)]
pub struct Grading {
    /// Points along a Hilbert curve, with their lengths.
    points: Vec<(Point3, f64)>,
    nodes: Vec<GradingNode>,
    slope: f64,
    /// Maximum length.
    most: f64,
}

/// Bounds of a part of the points.
#[derive(Clone, Copy, Debug)]
struct GradingNode {
    aabb: Aabb,
    /// Least length.
    least: f64,
}

impl GradingNode {
    /// Lower bound of the lengths at a place.
    fn bound(&self, p: &Point3, slope: f64) -> f64 {
        let Aabb { min, max } = &self.aabb;
        let beside = |p: f64, min: f64, max: f64| (min - p).max(p - max).max(0.0);
        let (x, y, z) = (beside(p.x, min.x, max.x), beside(p.y, min.y, max.y), beside(p.z, min.z, max.z));
        self.least + slope * (x * x + y * y + z * z).sqrt()
    }
}

impl Grading {
    /// Lengths up to `most` around points with a positive length.
    pub fn new<'a>(sources: impl IntoIterator<Item = (&'a [Point3], &'a [f64])>, slope: f64, most: f64) -> Self {
        let sources: Vec<(&[Point3], &[f64])> = sources.into_iter().collect();
        let used =
            || sources.iter().flat_map(|(points, lengths)| points.iter().zip(*lengths)).filter(|(_, h)| **h > 0.0);
        let mut keyed: Vec<(u64, usize)> = hilbert_keys(used().map(|(p, _)| *p)).zip(0..).collect();
        keyed.sort_unstable();
        let given: Vec<(Point3, f64)> = used().map(|(p, h)| (*p, *h)).collect();
        let points: Vec<(Point3, f64)> = keyed.into_iter().map(|(_, i)| given[i]).collect();
        let mut made = Self { points, nodes: Vec::new(), slope, most };
        let mut levels = 0;
        while made.points.len() >> levels > LEAF {
            levels += 1;
        }
        made.nodes = vec![GradingNode { aabb: Aabb::EMPTY, least: f64::INFINITY }; (2 << levels) - 1];
        made.measure(0, 0, made.points.len());
        made
    }

    /// Computes the bounds of a node and those below. The depth is logarithmic.
    fn measure(&mut self, node: usize, start: usize, end: usize) -> GradingNode {
        let own = if 2 * node + 2 < self.nodes.len() {
            let middle = start.midpoint(end);
            let (a, b) = (self.measure(2 * node + 1, start, middle), self.measure(2 * node + 2, middle, end));
            GradingNode { aabb: a.aabb.union(&b.aabb), least: a.least.min(b.least) }
        } else {
            let part = &self.points[start..end];
            let least = part.iter().map(|(_, h)| *h).fold(f64::INFINITY, f64::min);
            GradingNode { aabb: Aabb::of_points(part.iter().map(|(p, _)| p)), least }
        };
        self.nodes[node] = own;
        own
    }

    /// Increase of the length per distance.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Length at a place; the maximum without points.
    pub fn at(&self, p: &Point3) -> f64 {
        self.search(p, (self.most, NONE), 0.0).0
    }

    /// Lengths at places. Each search begins with the point that gave the length before, so places should be near each other.
    pub fn along(&self, places: &[Point3]) -> Vec<f64> {
        let in_turn = |places: &[Point3]| {
            let mut by = NONE;
            let next = |p: &Point3| {
                let first = self.points.get(by).map_or(f64::INFINITY, |from| self.grown(from, p));
                let found = self.search(p, if first < self.most { (first, by) } else { (self.most, NONE) }, 0.0);
                by = found.1;
                found.0
            };
            places.iter().map(next).collect::<Vec<f64>>()
        };
        places.par_chunks(CHUNK).flat_map_iter(in_turn).collect()
    }

    /// True if the length at a place is less than `limit`.
    pub fn is_below(&self, p: &Point3, limit: f64) -> bool {
        self.most < limit || self.search(p, (limit, NONE), limit).0 < limit
    }

    /// Length at a place due to one point.
    fn grown(&self, (q, h): &(Point3, f64), p: &Point3) -> f64 {
        h + self.slope * (p - q).norm()
    }

    /// Least length at a place with its point, or `best`. The search ends at a length below `enough`.
    fn search(&self, p: &Point3, mut best: (f64, usize), enough: f64) -> (f64, usize) {
        let mut stack = [(0.0, 0, 0, 0); STACK];
        stack[0] = (self.nodes[0].bound(p, self.slope), 0, 0, self.points.len());
        let mut depth = 1;
        while depth > 0 && best.0 >= enough {
            depth -= 1;
            let (bound, node, start, end) = stack[depth];
            if start == end || bound >= (1.0 - TOLERANCE) * best.0 {
                continue;
            }
            let left = 2 * node + 1;
            if left >= self.nodes.len() {
                let lengths = self.points[start..end].iter().map(|from| self.grown(from, p)).zip(start..);
                best = lengths.fold(best, |best, next| if next.0 < best.0 { next } else { best });
                continue;
            }
            let middle = start.midpoint(end);
            let [a, b] = [left, left + 1].map(|child| self.nodes[child].bound(p, self.slope));
            let (near, far) = ((a, left, start, middle), (b, left + 1, middle, end));
            // The nearer one is visited first.
            [stack[depth], stack[depth + 1]] = if a <= b { [far, near] } else { [near, far] };
            depth += 2;
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::sphere_surface;

    #[test]
    fn lengths_are_the_least_of_all_points() {
        let surface = sphere_surface(3);
        let lengths: Vec<f64> = surface.points.iter().map(|p| 0.02 + 0.1 * p.z.max(0.0)).collect();
        let grading = Grading::new([(&surface.points[..], &lengths[..])], 0.4, f64::INFINITY);
        for i in 0..200 {
            let part = |k: u32| libm::sin(f64::from(i) * 0.37 * f64::from(k)) * 2.0;
            let p = Point3::new(part(1), part(2), part(3));
            let all = surface.points.iter().zip(&lengths).map(|(q, h)| h + 0.4 * (p - q).norm());
            let exact = all.fold(f64::INFINITY, f64::min);
            let found = grading.at(&p);
            assert!(found >= exact && found <= exact / (1.0 - TOLERANCE), "{found} {exact}");
            let along = grading.along(&[p * 1.01, p])[1];
            assert!(along >= exact && along <= exact / (1.0 - TOLERANCE), "{along} {exact}");
            assert!(grading.is_below(&p, 1.1 * exact) && !grading.is_below(&p, 0.99 * exact));
        }
        let none = Grading::new([], 0.4, 2.0);
        assert_eq!(none.at(&Point3::origin()), 2.0);
    }
}
