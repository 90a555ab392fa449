//! Distance of a segment from the faces of a cavity, in floating point. Exact predicates verify the result.

use super::space::Space;
use anastomesh_mesh::geometry::implicit::OnTriangle;
use anastomesh_mesh::geometry::{Point3, Vec3, unit_normal};

/// Maximum steps in the search for the deepest position. A handful is typical.
const EXCHANGES: usize = 64;

/// Rest of a segment beyond its current vertex.
pub(super) struct Course {
    start: Point3,
    along: Vec3,
    /// Fraction of the segment already covered.
    from: f64,
}

/// Position on a segment with the largest distance from all faces.
pub(super) struct Deepest {
    /// Position, as a fraction of the segment.
    share: f64,
    /// Distance from the nearest faces, relative to the size of the cavity; negative if no position sees all faces.
    pub depth: f64,
    /// Nearest faces, as half-faces of the cavity.
    pub tight: [Option<u32>; 2],
}

/// Distance from a face, `at + slope · share`.
#[derive(Clone, Copy)]
struct Height {
    at: f64,
    slope: f64,
    half: Option<u32>,
}

impl Height {
    /// Position of equal distance.
    fn meets(&self, other: &Self) -> f64 {
        (self.at - other.at) / (other.slope - self.slope)
    }
}

impl Course {
    pub(super) fn new(s: &Space, at: u32, [p, q]: [u32; 2]) -> Self {
        let (start, end) = (*s.point(p), *s.point(q));
        let along = end - start;
        let from = ((s.point(at) - start).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        Self { start, along, from }
    }

    /// Distance from a face along the segment.
    fn height(&self, s: &Space, half: u32) -> Height {
        let [a, b, c] = s.wall(half).map(|v| s.point(v) - self.start);
        let n = unit_normal(a, b, c);
        Height { at: -n.dot(&a), slope: n.dot(&self.along), half: Some(half) }
    }

    /// Finds the deepest position in a cavity. The minimum distance from the faces is concave along the segment. The
    /// face that limits it on either side is replaced until none is nearer.
    pub(super) fn deepest(&self, s: &Space, walls: &[u32]) -> Deepest {
        let size = self.along.norm();
        // The ends of the segment limit the position, too.
        let mut low = Height { at: -self.from * size, slope: size, half: None };
        let mut high = Height { at: size, slope: -size, half: None };
        s.count(2 * walls.len());
        let heights: Vec<Height> = walls.iter().map(|&half| self.height(s, half)).collect();
        let mut share = low.meets(&high);
        let mut depth = low.at + low.slope * share;
        for _ in 0..EXCHANGES {
            let value = |h: &Height| h.at + h.slope * share;
            let Some(nearest) = heights.iter().min_by(|x, y| value(x).total_cmp(&value(y))) else { break };
            let least = value(nearest);
            if least >= depth - 1e-12 * depth.abs() - f64::MIN_POSITIVE {
                break;
            }
            depth = least;
            let flat = nearest.slope == 0.0;
            if nearest.slope >= 0.0 {
                low = *nearest;
            }
            if nearest.slope <= 0.0 {
                high = *nearest;
            }
            if flat {
                break;
            }
            share = low.meets(&high).clamp(self.from, 1.0);
            depth = low.at + low.slope * share;
        }
        let room = self.size(s, walls, share);
        Deepest { share, depth: depth / room, tight: [low.half, high.half] }
    }

    /// Distance of the furthest corner of the faces from a position.
    fn size(&self, s: &Space, walls: &[u32], share: f64) -> f64 {
        let place = self.start + self.along * share;
        let far = |&half: &u32| s.wall(half).map(|v| (s.point(v) - place).norm_squared());
        walls.iter().flat_map(far).fold(f64::MIN_POSITIVE, f64::max).sqrt()
    }

    /// Minimum distance of a vertex from the faces without it, relative to the size of the cavity.
    pub(super) fn depth_from(&self, s: &Space, v: u32, walls: &[u32]) -> f64 {
        let p = s.point(v) - self.start;
        let mut least = f64::INFINITY;
        for &half in walls {
            let corners = s.wall(half);
            if !corners.contains(&v) {
                let [a, b, c] = corners.map(|v| s.point(v) - self.start);
                least = least.min(unit_normal(a, b, c).dot(&(p - a)));
            }
        }
        least / self.size(s, walls, self.from)
    }

    /// Weight of a position, with as few bits as accuracy allows, to keep exact arithmetic short.
    pub(super) fn weight(place: &Deepest) -> u128 {
        // Resolution of 1/16 of the depth, 10 to 52 bits.
        let bits = (-libm::log2(place.depth.max(1e-15) / 16.0)).ceil().clamp(10.0, 52.0) as u32;
        let steps = (place.share.clamp(0.0, 1.0) * (1_u64 << bits) as f64).round() as u128;
        steps * (OnTriangle::ONE >> bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deep_positions_have_short_weights() {
        let weight = |share: f64, depth: f64| Course::weight(&Deepest { share, depth, tight: [None; 2] });
        let of = |steps: u128, bits: u32| steps * (OnTriangle::ONE >> bits);
        assert_eq!(weight(0.5, 1.0), of(512, 10));
        assert_eq!(weight(0.3, 1e-3), of(4915, 14));
        assert_eq!(weight(0.3, -1.0), of((0.3 * (1_u64 << 52) as f64).round() as u128, 52));
        assert_eq!([weight(-0.1, 1.0), weight(1.1, 1.0)], [0, OnTriangle::ONE]);
    }

    #[test]
    fn distances_count_from_the_vertex_reached() {
        let s = Space::of_points([[1.0, 0.0, 0.0], [5.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        assert_eq!([0, 1, 2].map(|at| Course::new(&s, at, [0, 1]).from), [0.0, 1.0, 0.25]);
        let (rises, falls) = (Height { at: 1.0, slope: 2.0, half: None }, Height { at: 6.0, slope: -3.0, half: None });
        assert_eq!((rises.meets(&falls), falls.meets(&rises)), (1.0, 1.0));
    }
}
