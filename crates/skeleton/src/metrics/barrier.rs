//! Barrier potential of the paper (equations 1 to 6).

use super::super::{EdgeId, Skeleton};
use anastomesh_mesh::geometry::{Aabb, Bvh, Tube, Vec3};
use rayon::prelude::*;

/// Median radius of the network behind the paper's rates, in its unit of length (voxels of 22.7 µm).
const MEDIAN_RADIUS: f64 = 0.448;
/// Regularization of the kernel at distance 0, in that unit squared.
const EPSILON: f64 = 1e-5;
/// Maximum panels of the quadrature along one edge.
const MOST_PANELS: usize = 12;
/// Nodes and weights of the 6-point Gauss–Legendre rule on [0, 1].
const GAUSS: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_55, 0.233_956_967_286_345_52),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

/// Potential of a pair, and its derivatives by the ends of the first and second edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairGradient {
    /// The potential.
    pub potential: f64,
    /// Derivatives by a, b of the first tube, then of the second.
    pub by_end: [Vec3; 4],
}

/// Kernel of the barrier: K(d, h) = 3 B(2 d / h) / (2 (d / unit)² + ε). B is the cubic B-spline, h is `support` times
/// the sum of the radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barrier {
    /// Support of the kernel, in sums of the two radii.
    pub support: f64,
    /// The paper's unit of length in the unit of the skeleton.
    pub unit: f64,
}

impl Default for Barrier {
    fn default() -> Self {
        Self { support: 1.0, unit: 0.0 }
    }
}

/// Cubic B-spline and its derivative; 0 from 2 on.
fn spline(x: f64) -> (f64, f64) {
    if x < 1.0 {
        (2.0 / 3.0 - x * x + 0.5 * x * x * x, -2.0 * x + 1.5 * x * x)
    } else if x < 2.0 {
        let y = 2.0 - x;
        (y * y * y / 6.0, -0.5 * y * y)
    } else {
        (0.0, 0.0)
    }
}

/// Unit of length of the paper's rates: the one in which the median radius of an edge is 0.448.
pub fn paper_unit(skeleton: &Skeleton) -> f64 {
    let mut radii: Vec<f64> = skeleton.edges.iter().map(super::super::Edge::mean_radius).collect();
    if radii.is_empty() {
        return 1.0;
    }
    let middle = radii.len() / 2;
    let (_, median, _) = radii.select_nth_unstable_by(middle, f64::total_cmp);
    *median / MEDIAN_RADIUS
}

impl Barrier {
    /// Kernel and its derivative by the distance.
    fn kernel(&self, d: f64, h: f64) -> (f64, f64) {
        let (b, slope) = spline(2.0 * d / h);
        let below = 2.0 * (d / self.unit).powi(2) + EPSILON;
        let value = 3.0 * b / below;
        (value, 6.0 * slope / (h * below) - value * 4.0 * d / (self.unit * self.unit * below))
    }

    /// Double integral (5) over two tubes and its gradient; `None` if they are too far from each other.
    ///
    /// Only the parts within the support of each other are integrated, in panels of at most half of it, with six
    /// points.
    pub fn pair(&self, a: &Tube, b: &Tube) -> Option<PairGradient> {
        let reach = self.support * (a.max_radius() + b.max_radius());
        let on_a = within(a, b, reach)?;
        let on_b = within(b, a, reach)?;
        let (ends, radii) = ([a.a, a.b, b.a, b.b], self.support);
        let points = |tube: &Tube, [lo, hi]: [f64; 2]| -> Vec<(f64, f64)> {
            let panels = ((hi - lo) * tube.length() / (0.5 * reach)).ceil().clamp(1.0, MOST_PANELS as f64);
            let width = (hi - lo) / panels;
            (0..panels as usize).flat_map(|i| GAUSS.map(|(x, w)| (lo + (i as f64 + x) * width, w * width))).collect()
        };
        let (along_a, along_b) = (points(a, on_a), points(b, on_b));
        let mut sum = PairGradient { potential: 0.0, by_end: [Vec3::zeros(); 4] };
        for &(s, ws) in &along_a {
            let p = ends[0] + (ends[1] - ends[0]) * s;
            let mut force = Vec3::zeros();
            for &(t, wt) in &along_b {
                let way = p - (ends[2] + (ends[3] - ends[2]) * t);
                let (d, h) = (way.norm(), radii * (a.radius(s) + b.radius(t)));
                if d >= h {
                    continue;
                }
                let (value, slope) = self.kernel(d, h);
                sum.potential += ws * wt * value;
                if d > 0.0 {
                    let f = way * (slope / d * ws * wt);
                    force += f;
                    sum.by_end[2] -= f * (1.0 - t);
                    sum.by_end[3] -= f * t;
                }
            }
            sum.by_end[0] += force * (1.0 - s);
            sum.by_end[1] += force * s;
        }
        (sum.potential > 0.0).then_some(sum)
    }

    /// Potential (6) of a skeleton, with each pair once.
    pub fn potential(mut self, skeleton: &Skeleton) -> f64 {
        if self.unit <= 0.0 {
            self.unit = paper_unit(skeleton);
        }
        let tubes: Vec<Tube> = skeleton.edge_ids().map(|e| skeleton.tube(e)).collect();
        let boxes: Vec<Aabb> = tubes
            .iter()
            .map(|t| Aabb::of_points([&t.a, &t.b]).grown(0.5 * self.support.max(1.0) * 2.0 * t.max_radius()))
            .collect();
        let tree = Bvh::new(&boxes);
        let shares = |e: usize, f: usize| {
            let nodes = skeleton.edge(EdgeId(f as u32)).nodes;
            skeleton.edge(EdgeId(e as u32)).nodes.iter().any(|n| nodes.contains(n))
        };
        let of_edge: Vec<f64> = (0..tubes.len())
            .into_par_iter()
            .map(|e| {
                let mut near = Vec::new();
                tree.query(&boxes[e], |f| {
                    if f as usize > e && !shares(e, f as usize) {
                        near.push(f as usize);
                    }
                });
                near.sort_unstable();
                near.iter().filter_map(|&f| self.pair(&tubes[e], &tubes[f])).map(|p| p.potential).sum()
            })
            .collect();
        // Adding 0 turns the −0 of an empty sum into 0.
        of_edge.iter().sum::<f64>() + 0.0
    }
}

/// Range of parameters on `a` outside of which it is further than `reach` from `b`'s axis; `None` if all of it is.
fn within(a: &Tube, b: &Tube, reach: f64) -> Option<[f64; 2]> {
    let (d, e, w) = (a.b - a.a, b.b - b.a, a.a - b.a);
    let length = e.norm();
    let mut range = [0.0_f64, 1.0_f64];
    if length > 0.0 {
        let axis = e / length;
        // Between the planes across b's ends, each moved outwards by the reach.
        let (along, slope) = (w.dot(&axis), d.dot(&axis));
        if slope.abs() > 1e-12 * length {
            let [s, t] = [(-reach - along) / slope, (length + reach - along) / slope];
            range = [range[0].max(s.min(t)), range[1].min(s.max(t))];
        } else if along < -reach || along > length + reach {
            return None;
        }
        clip_to_ball(&mut range, w - axis * along, d - axis * slope, reach)?;
    } else {
        clip_to_ball(&mut range, w, d, reach)?;
    }
    (range[0] < range[1]).then_some(range)
}

/// Clips a range of s to |w + s d| < reach.
fn clip_to_ball(range: &mut [f64; 2], w: Vec3, d: Vec3, reach: f64) -> Option<()> {
    let (dd, dw, ww) = (d.norm_squared(), d.dot(&w), w.norm_squared() - reach * reach);
    let root = dw * dw - dd * ww;
    if dd <= 1e-24 * w.norm_squared().max(reach * reach) {
        return (ww < 0.0).then_some(());
    }
    if root <= 0.0 {
        return None;
    }
    let root = root.sqrt();
    *range = [range[0].max((-dw - root) / dd), range[1].min((-dw + root) / dd)];
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Point3;
    use proptest::prelude::*;

    fn tube(a: [f64; 3], b: [f64; 3], radius: f64) -> Tube {
        Tube { a: a.into(), b: b.into(), ra: radius, rb: radius }
    }

    const BARRIER: Barrier = Barrier { support: 1.2, unit: 1.0 };

    #[test]
    fn zero_exactly_from_the_support_on() {
        let a = tube([-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], 1.0);
        let at = |z: f64| BARRIER.pair(&a, &tube([0.0, -9.0, z], [0.0, 9.0, z], 1.0)).map_or(0.0, |p| p.potential);
        assert!(at(2.41) <= 0.0);
        assert!(at(2.3) > 0.0 && at(1.0) > at(1.5) && at(1.5) > at(2.3));
        // A long thin edge is not missed between points of the rule.
        let needle = tube([-500.0, 0.0, 0.0], [500.0, 0.3, 0.0], 0.1);
        assert!(BARRIER.pair(&needle, &tube([100.0, -50.0, 0.15], [100.0, 50.0, 0.15], 0.1)).is_some());
    }

    #[test]
    fn both_edges_are_driven_apart() {
        let pair = BARRIER
            .pair(&tube([-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], 1.0), &tube([0.0, -9.0, 1.0], [0.0, 9.0, 1.0], 1.0))
            .unwrap();
        let z = pair.by_end.map(|g| g.z);
        // Down the gradient: the first one goes down, the second up.
        assert!(z[0] > 0.0 && z[1] > 0.0 && z[2] < 0.0 && z[3] < 0.0);
        assert!((z.iter().sum::<f64>()).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn gradient_is_that_of_the_potential(
            ends in prop::array::uniform4(prop::array::uniform3(-3.0..3.0_f64)),
            radii in prop::array::uniform4(0.6..1.5_f64),
        ) {
            let tubes = |e: &[[f64; 3]; 4]| (
                Tube { a: e[0].into(), b: e[1].into(), ra: radii[0], rb: radii[1] },
                Tube { a: e[2].into(), b: e[3].into(), ra: radii[2], rb: radii[3] },
            );
            let (a, b) = tubes(&ends);
            let apart = anastomesh_mesh::geometry::segment_segment([&a.a, &a.b], [&b.a, &b.b]).distance;
            // Close to an intersection the rule does not resolve the kernel, which then only needs the right direction.
            prop_assume!(apart > 0.5 && a.length() > 0.5 && b.length() > 0.5);
            let Some(pair) = BARRIER.pair(&a, &b) else { return Ok(()) };
            let scale = pair.by_end.iter().map(Vec3::norm).fold(0.0, f64::max);
            for i in 0..4 {
                for k in 0..3 {
                    let h = 1e-5;
                    let value = |d: f64| {
                        let mut moved = ends;
                        moved[i][k] += d;
                        let (a, b) = tubes(&moved);
                        BARRIER.pair(&a, &b).map_or(0.0, |p| p.potential)
                    };
                    let slope = (value(h) - value(-h)) / (2.0 * h);
                    let wrong = (slope - pair.by_end[i][k]).abs();
                    prop_assert!(wrong < 0.03 * scale + 1e-4, "{slope} {} of {scale}", pair.by_end[i][k]);
                }
            }
        }

        #[test]
        fn the_unit_of_length_makes_no_difference(
            ends in prop::array::uniform4(prop::array::uniform3(-3.0..3.0_f64)),
        ) {
            let scaled = |f: f64| {
                let p = |i: usize| Point3::from(ends[i].map(|x| x * f));
                let (a, b) = (Tube { a: p(0), b: p(1), ra: f, rb: f }, Tube { a: p(2), b: p(3), ra: f, rb: f });
                Barrier { support: 1.2, unit: f }.pair(&a, &b).map_or(0.0, |p| p.potential)
            };
            let (one, metre) = (scaled(1.0), scaled(1e-6));
            prop_assert!((one - metre).abs() <= 1e-9 * one.max(1e-12), "{one} {metre}");
        }
    }
}
