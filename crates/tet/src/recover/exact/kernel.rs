//! Clearance that faces leave for a vertex, and its deepest point, from a linear program in four variables. The result
//! is a floating-point proposal that exact predicates verify.

use super::space::Space;
use anastomesh_mesh::geometry::{Point3, Vec3, unit_normal};
use nalgebra::{Matrix4, Vector4};

/// Minimum distances of a new vertex from the surrounding planes, relative to the size, in the order tried.
pub(super) const LEVELS: [f64; 6] = [1e-2, 1e-3, 1e-5, 1e-8, 1e-11, 0.0];

/// Fractions of the way from the segment to the deepest point at which a position is tried.
const SHARES: [f64; 9] = [1.0, 0.7, 0.5, 0.3, 0.15, 0.05, 0.01, 1e-3, 1e-4];

/// Roundoff error of distances, relative to the size.
const ROUNDOFF: f64 = 1e-14;

/// Work of a linear program, without constraints.
const LP: usize = 60;

/// Maximum pivots of a linear program. Ten are typical.
const EXCHANGES: usize = 100;

/// Replacement for a vertex in a sector.
#[derive(Clone, Copy, Debug)]
pub(super) enum Apex {
    /// An existing vertex of the sector.
    Vertex(u32),
    /// A new point.
    Point(Point3),
}

/// Room for a vertex that has to see all given faces counter-clockwise, in coordinates relative to a nearby origin.
pub(super) struct Kernel<'a> {
    origin: Point3,
    faces: &'a [[u32; 3]],
    /// Inward unit normal and height of the origin, per face.
    planes: Vec<(Vec3, f64)>,
    /// Largest distance of a corner from the origin.
    pub size: f64,
}

impl<'a> Kernel<'a> {
    pub(super) fn new(s: &Space, origin: Point3, faces: &'a [[u32; 3]]) -> Self {
        s.count(faces.len());
        let mut planes = Vec::with_capacity(faces.len());
        let mut size = 0.0_f64;
        for f in faces {
            let [a, b, c] = f.map(|x| s.point(x) - origin);
            size = size.max(a.norm()).max(b.norm()).max(c.norm());
            let n = unit_normal(a, b, c);
            planes.push((n, -n.dot(&a)));
        }
        Self { origin, faces, planes, size }
    }

    /// Minimum distance from the planes of the faces.
    pub(super) fn depth(&self, x: &Vec3) -> f64 {
        self.planes.iter().map(|(n, h)| n.dot(x) + h).fold(f64::INFINITY, f64::min)
    }

    /// Minimum distance of corner `w` from the planes of faces without it, if above `bound`.
    fn depth_of(&self, s: &Space, w: u32, bound: f64) -> Option<f64> {
        let x = s.point(w) - self.origin;
        let mut least = f64::INFINITY;
        for ((n, h), face) in self.planes.iter().zip(self.faces) {
            let d = n.dot(&x) + h;
            if d < least && !face.contains(&w) {
                if d <= bound {
                    return None;
                }
                least = d;
            }
        }
        Some(least)
    }

    /// Corner that sees all faces without it, with the largest distance from their planes, at least `least` times the
    /// size. The error is an upper bound on that distance, relative to the size.
    pub(super) fn neighbor(&self, s: &Space, least: f64) -> Result<u32, f64> {
        let mut rim: Vec<u32> = self.faces.iter().flatten().copied().collect();
        rim.sort_unstable();
        rim.dedup();
        // With `least` zero, exact predicates decide, not roundoff.
        let bound = (least - ROUNDOFF) * self.size;
        let mut near = f64::NEG_INFINITY;
        let mut deep: Vec<(f64, u32)> = Vec::new();
        for w in rim {
            match self.depth_of(s, w, near) {
                Some(d) if d > bound => deep.push((d, w)),
                Some(d) => near = d,
                None => {}
            }
        }
        deep.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let sees = |w: u32| self.faces.iter().all(|&[a, b, c]| [a, b, c].contains(&w) || s.orient([a, b, c, w]) > 0);
        deep.into_iter().map(|(_, w)| w).find(|&w| sees(w)).ok_or(near / self.size + ROUNDOFF)
    }

    /// Apex with a clearance of at least `least` times the size; a corner if possible.
    pub(super) fn apex(&self, s: &Space, least: f64) -> Result<Apex, f64> {
        self.neighbor(s, least)
            .map(Apex::Vertex)
            .or_else(|at_corners| self.place(s, least).map(Apex::Point).map_err(|inside| inside.max(at_corners)))
    }

    /// Faces closest to the deepest point, at most four, and the depth relative to the size.
    pub(super) fn bounds(&self, s: &Space) -> Option<(Vec<usize>, f64)> {
        s.count(LP + 10 * self.planes.len());
        let highest = highest(&constraints(&self.planes, self.size))?;
        let faces = highest.tight.iter().filter_map(|i| i.checked_sub(BOUNDS)).collect();
        Some((faces, highest.x[3]))
    }

    /// Point that sees all faces and lies as far as possible in direction `up`, with clearance of at least `least`
    /// times the size. Between steep faces it is higher than the deepest point and leaves more clearance below.
    pub(super) fn tallest(&self, s: &Space, up: &Vec3, least: f64) -> Option<Point3> {
        s.count(2 * (LP + 10 * self.planes.len()));
        let mut constraints = constraints(&self.planes, self.size);
        let deepest = highest(&constraints)?.x[3];
        let kept = least.max(KEPT * deepest);
        if deepest < least {
            return None;
        }
        for (a, b) in &mut constraints[BOUNDS..] {
            *b -= kept;
            a[3] = 0.0;
        }
        constraints.push((Vector4::new(-up.x, -up.y, -up.z, 1.0), 0.0));
        let aim = highest(&constraints)?.x.xyz() * self.size;
        let p = self.origin + aim;
        self.faces.iter().all(|f| s.orient_to(*f, &p) > 0).then_some(p)
    }

    /// Point that sees all faces with a clearance of at least `least` times the size. The error is the largest possible
    /// clearance relative to the size, if a search for less may succeed.
    pub(super) fn place(&self, s: &Space, least: f64) -> Result<Point3, f64> {
        s.count(LP + 10 * self.planes.len());
        let Highest { x, .. } = highest(&constraints(&self.planes, self.size)).ok_or(f64::NEG_INFINITY)?;
        let (aim, depth) = (x.xyz() * self.size, x[3]);
        if depth < least {
            return Err(depth);
        }
        let sees = |p: &Point3| self.faces.iter().all(|f| s.orient_to(*f, p) > 0);
        SHARES.iter().map(|share| self.origin + aim * *share).find(sees).ok_or(f64::NEG_INFINITY)
    }
}

/// Fraction of the depth that the tallest point keeps from the faces.
const KEPT: f64 = 0.1;

/// `a · x ≤ b`.
type Constraint = (Vector4<f64>, f64);

/// Number of constraints that bound all coordinates.
const BOUNDS: usize = 8;

/// Constraints that keep a point at distance `x[3]` or more from the planes `normal · x + height = 0`, on their
/// positive sides. Coordinates and distance are relative to `size`; normals have unit length.
fn constraints(planes: &[(Vec3, f64)], size: f64) -> Vec<Constraint> {
    let mut constraints = Vec::with_capacity(planes.len() + BOUNDS);
    constraints.extend((0..BOUNDS).map(|k| (Vector4::ith(k % 4, if k < 4 { 1.0 } else { -1.0 }), 1.0)));
    constraints.extend(planes.iter().map(|(n, h)| (Vector4::new(-n.x, -n.y, -n.z, 1.0), h / size)));
    constraints
}

/// Solution of a linear program.
struct Highest {
    x: Vector4<f64>,
    /// Indices of the tight constraints.
    tight: [usize; 4],
}

/// Returns the point with the largest last coordinate that satisfies all constraints, by the dual simplex method. It
/// starts with the first four constraints tight, which bound it from above. The most violated constraint replaces one
/// of the four until none is violated.
fn highest(constraints: &[Constraint]) -> Option<Highest> {
    let mut tight = [0, 1, 2, 3];
    for _ in 0..EXCHANGES {
        let rows = Matrix4::from_rows(&tight.map(|i: usize| constraints[i].0.transpose()));
        let lu = rows.lu();
        // Solved by LU, not by the inverse, so that tight constraints of thin wedges hold to the last bits.
        let x = lu.solve(&Vector4::from(tight.map(|i| constraints[i].1)))?;
        let inverse = lu.try_inverse()?;
        let mut worst = (1e-13, None);
        for (i, (a, b)) in constraints.iter().enumerate() {
            let excess = a.dot(&x) - b;
            if excess > worst.0 {
                worst = (excess, Some(i));
            }
        }
        let Some(enters) = worst.1 else { return Some(Highest { x, tight }) };
        // The gradient of the objective stays a combination of these rows with non-negative weights.
        let weight = inverse.row(3);
        let share = inverse.tr_mul(&constraints[enters].0);
        let slack = |k: usize| weight[k].max(0.0) / share[k];
        let leaves = (0..4)
            .filter(|&k| share[k] > 1e-12)
            .min_by(|&j, &k| slack(j).total_cmp(&slack(k)).then(share[k].total_cmp(&share[j])));
        tight[leaves?] = enters;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delaunay::hash;

    /// Deepest point between planes, and its distance from them.
    fn deepest(planes: &[(Vec3, f64)], size: f64) -> Option<(Vec3, f64)> {
        highest(&constraints(planes, size)).map(|h| (h.x.xyz() * size, h.x[3] * size))
    }

    #[test]
    fn the_deepest_point_of_a_box_is_its_middle() {
        let mut planes = Vec::new();
        for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
            planes.push((axis, 0.0));
            planes.push((-axis, 3.0));
        }
        planes.push((Vec3::new(1.0, 1.0, 1.0).normalize(), 0.0));
        let (x, depth) = deepest(&planes, 10.0).unwrap();
        assert!((depth - 1.5).abs() < 1e-9 && (x - Vec3::repeat(1.5)).norm() < 1e-9, "{x} {depth}");
    }

    #[test]
    fn a_thin_wedge_has_a_deepest_point() {
        let angle = 1e-7_f64;
        let planes = [
            (Vec3::y(), 0.0),
            (Vec3::new(libm::sin(angle), -libm::cos(angle), 0.0), 0.0),
            (-Vec3::x(), 1.0),
            (Vec3::z(), 0.5),
            (-Vec3::z(), 0.5),
        ];
        let (x, depth) = deepest(&planes, 2.0).unwrap();
        assert!((depth - angle / 2.0).abs() < 1e-9 && x.x > 0.9, "{x} {depth}");
    }

    #[test]
    fn random_kernels_hold_their_deepest_point() {
        for seed in 0..200 {
            let coin = |k: u64| (hash(seed * 1000 + k) >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
            let planes: Vec<(Vec3, f64)> = (0..60)
                .map(|k| (Vec3::new(coin(4 * k), coin(4 * k + 1), coin(4 * k + 2)).normalize(), coin(4 * k + 3).abs()))
                .collect();
            let (x, depth) = deepest(&planes, 4.0).unwrap();
            let worst = planes.iter().map(|(n, h)| n.dot(&x) + h).fold(f64::INFINITY, f64::min);
            assert!((worst - depth).abs() < 1e-9 && depth > 0.0, "{worst} {depth}");
        }
    }

    /// Corners of a box from the origin to `(2, 2, height)`, and its faces seen from inside.
    fn hollow(height: f64) -> (Space, Vec<[u32; 3]>) {
        let at = |k: u32, axis: u32| f64::from(k >> axis & 1);
        let corners: [[f64; 3]; 8] = std::array::from_fn(|k| {
            let k = k as u32;
            [2.0 * at(k, 0), 2.0 * at(k, 1), height * at(k, 2)]
        });
        let squares = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        let faces = squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        (Space::of_points(corners), faces)
    }

    #[test]
    fn a_new_point_is_as_deep_as_possible() {
        let (s, faces) = hollow(4.0);
        let kernel = Kernel::new(&s, Point3::new(0.5, 0.5, 2.0), &faces);
        let size = (1.5_f64 * 1.5 * 2.0 + 4.0).sqrt();
        assert!((kernel.size - size).abs() < 1e-14);
        assert!((kernel.depth(&Vec3::zeros()) - 0.5).abs() < 1e-14);
        let deepest = 1.0 / size;
        let p = kernel.place(&s, 0.999 * deepest).unwrap();
        assert!((p.x - 1.0).abs() < 1e-9 && (p.y - 1.0).abs() < 1e-9, "{p}");
        assert!((kernel.place(&s, 1.001 * deepest).unwrap_err() - deepest).abs() < 1e-9);
        let (walls, depth) = kernel.bounds(&s).unwrap();
        assert!((depth - deepest).abs() < 1e-9);
        assert_eq!(walls.len(), 4);
        // Only two corners have no triangles in their planes that do not contain them.
        assert_eq!(kernel.neighbor(&s, 0.0), Ok(0));
        assert!((kernel.apex(&s, 3.0 * deepest).unwrap_err() - 2.0 * deepest).abs() < 1e-9);
        assert!(matches!(Kernel::new(&s, *s.point(3), &faces[2..4]).neighbor(&s, 0.0), Ok(4)));
    }

    #[test]
    fn the_tallest_point_keeps_some_of_the_depth() {
        let (s, faces) = hollow(4.0);
        let kernel = Kernel::new(&s, Point3::new(0.5, 0.5, 2.0), &faces);
        let top = |least: f64| kernel.tallest(&s, &Vec3::z(), least / kernel.size).map(|p| p.z);
        assert!((top(0.0).unwrap() - 3.9).abs() < 1e-9);
        assert!((top(0.5).unwrap() - 3.5).abs() < 1e-9);
        assert_eq!(top(1.001), None);
        let low = kernel.tallest(&s, &-Vec3::z(), 0.0).unwrap();
        assert!((low.z - 0.1).abs() < 1e-9);
    }

    #[test]
    fn the_corner_with_most_clearance_is_the_apex() {
        // A pyramid over a square, and its base.
        let s = Space::of_points([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 3.0, 0.0], [0.0, 3.0, 0.0], [1.5, 1.5, 4.0]]);
        let faces = [[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]];
        let kernel = Kernel::new(&s, Point3::new(1.0, 1.0, 0.0), &faces);
        let size = 16.5_f64.sqrt();
        assert_eq!(kernel.neighbor(&s, 0.0), Ok(4));
        assert_eq!(kernel.neighbor(&s, 3.999 / size), Ok(4));
        assert!((kernel.neighbor(&s, 4.001 / size).unwrap_err() - 4.0 / size).abs() < 1e-9);
        assert!(matches!(kernel.apex(&s, 0.1), Ok(Apex::Vertex(4))));
        // Two corners that see all, the deeper one first.
        let faces = [[0, 1, 4]];
        let kernel = Kernel::new(&s, *s.point(2), &faces);
        assert!(kernel.neighbor(&s, 0.0).is_ok_and(|w| w == 0));
    }
}
