//! Attainable quality of a tetrahedron on a fixed triangle. No tetrahedron on a needle is good. The last pass of the
//! thorough improvement weighs those by the attainable quality, so that their neighbours do not suffer.

use crate::complex::{Complex, face_key};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::quality::TET_EDGES;
use rustc_hash::FxHashMap;

/// Sine of the angle below which a triangle counts as a needle: 12 degrees.
const SHARP: f64 = 0.2079;

/// Part of the attainable ratio above which a tetrahedron at a needle is left.
const EXHAUSTED: f64 = 0.5;

/// Attainable radius ratios on fixed triangles, stored where below 1.
#[derive(Clone, Debug, Default)]
pub(super) struct Allowance {
    /// True for vertices of such a triangle.
    marked: Vec<bool>,
    of_face: FxHashMap<[u32; 3], f64>,
    /// Smallest ratio of the needles at each of their edges.
    of_edge: FxHashMap<[u32; 2], f64>,
}

impl Allowance {
    /// Collects all boundary and frozen faces of a complex.
    pub fn of(c: &Complex) -> Self {
        let mut all = Self::default();
        for t in c.real_tets() {
            for half in 4 * t..4 * t + 4 {
                if c.is_frozen(half) || c.is_ghost(c.mate(half) >> 2) {
                    let f = c.face(half);
                    let allowed = allowed_on(f.map(|v| &c.points[v as usize]));
                    if allowed < 1.0 {
                        all.marked.resize(c.points.len(), false);
                        for v in f {
                            all.marked[v as usize] = true;
                        }
                        for [v, w] in [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]] {
                            let least = all.of_edge.entry([v.min(w), v.max(w)]).or_insert(1.0);
                            *least = allowed.min(*least);
                        }
                        all.of_face.insert(face_key(f), allowed);
                    }
                }
            }
        }
        all
    }

    /// True if no triangle is a needle.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.marked.is_empty()
    }

    /// True if a vertex belongs to a needle.
    #[inline]
    pub fn has_needle(&self, v: u32) -> bool {
        self.marked.get(v as usize).copied().unwrap_or(false)
    }

    /// Attainable radius ratio of a tetrahedron on face `f`, with no other fixed face.
    #[inline]
    pub fn of_face(&self, f: [u32; 3]) -> f64 {
        if f.iter().all(|&v| self.has_needle(v)) { self.of_face.get(&face_key(f)).copied().unwrap_or(1.0) } else { 1.0 }
    }

    /// Radius ratio of a tetrahedron relative to the attainable one.
    #[inline]
    pub fn relative(&self, v: &[u32; 4], ratio: f64) -> f64 {
        if self.is_empty() { ratio } else { ratio / self.of_tet(v) }
    }

    /// True if a tetrahedron at a needle is about as good as the needle allows. The needle may be one of its faces, or share
    /// an edge with it. Then the short edge or the far corners of the needle are near.
    pub fn is_exhausted(&self, v: &[u32; 4], ratio: f64) -> bool {
        let marks = v.map(|w| self.has_needle(w));
        let edges = TET_EDGES.iter().filter(|[i, j]| marks[*i] && marks[*j]);
        let allowed = edges.filter_map(|&[i, j]| self.of_edge.get(&[v[i].min(v[j]), v[i].max(v[j])]));
        ratio > EXHAUSTED * allowed.fold(f64::INFINITY, |least, &a| least.min(a))
    }

    /// Attainable radius ratio of a tetrahedron with these vertices.
    #[inline]
    pub fn of_tet(&self, v: &[u32; 4]) -> f64 {
        let marks = v.map(|w| self.has_needle(w));
        if marks.iter().filter(|&&m| m).count() < 3 {
            return 1.0;
        }
        let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
        let allowed = faces.iter().filter(|f| f.iter().all(|&i| marks[i]));
        let allowed = allowed.filter_map(|f| self.of_face.get(&face_key(f.map(|i| v[i]))));
        allowed.fold(1.0, |least, &a| least.min(a))
    }
}

/// Approximate best radius ratio of a tetrahedron on a triangle. For needles, it is the triangle's own ratio; the true
/// optimum is at most 1.5 times that. For other triangles, it is 1.
fn allowed_on([a, b, c]: [&Point3; 3]) -> f64 {
    let (u, v, w) = (b - a, c - b, a - c);
    let (x, y, z) = (u.norm(), v.norm(), w.norm());
    // 2 r / R with r = 2 A / (x + y + z), R = x y z / (4 A).
    let area2 = u.cross(&v).norm_squared();
    let ratio = 4.0 * area2 / ((x + y + z) * (x * y * z));
    // The smallest angle lies opposite the shortest edge.
    let sine = area2.sqrt() * x.min(y).min(z) / (x * y * z);
    if sine < SHARP { ratio } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::quality::radius_ratio;

    #[test]
    fn needles_allow_about_their_own_ratio_and_good_triangles_everything() {
        let p = Point3::new;
        let base = |x: f64| [p(0.0, 0.0, 0.0), p(x, 0.0, 0.0), p(x / 2.0, 0.866, 0.0)];
        let [a, b, c] = base(1.0);
        assert!((allowed_on([&a, &b, &c]) - 1.0).abs() < 1e-12);
        for width in [1e-3, 1e-2, 0.1] {
            let [a, b, c] = base(width);
            let allowed = allowed_on([&a, &b, &c]);
            // Best of many positions of the fourth corner.
            let mut best = 0.0_f64;
            for i in 0..4000 {
                let (y, z) = (f64::from(i % 40) / 30.0 - 0.2, f64::from(i / 40) / 60.0 + 0.01);
                best = best.max(radius_ratio(&a, &b, &c, &p(width / 2.0, y, -z)).abs());
            }
            assert!(best < 1.6 * allowed && best > 0.5 * allowed, "{width}: {best} {allowed}");
        }
    }
}
