//! How good a tetrahedron can be that stands on a triangle which stays. On a needle none is good: the last pass of the
//! thorough improvement weighs those there by what is possible, so that the others need not suffer with them.

use crate::complex::{Complex, face_key};
use anastomesh_mesh::geometry::Point3;
use rustc_hash::FxHashMap;

/// Needles are triangles with an angle whose sine is below this: 12 degrees.
const SHARP: f64 = 0.2079;

/// Radius ratios that the triangles which stay allow, where that is below 1.
#[derive(Clone, Debug, Default)]
pub(super) struct Allowance {
    /// Whether a vertex has such a triangle.
    marked: Vec<bool>,
    of_face: FxHashMap<[u32; 3], f64>,
}

impl Allowance {
    /// Of all boundary and frozen faces of a complex.
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
                        all.of_face.insert(face_key(f), allowed);
                    }
                }
            }
        }
        all
    }

    /// Whether no triangle is a needle.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.marked.is_empty()
    }

    /// Whether a vertex has a needle.
    #[inline]
    pub fn has_needle(&self, v: u32) -> bool {
        self.marked.get(v as usize).copied().unwrap_or(false)
    }

    /// The radius ratio that a tetrahedron can be wished to have of whose faces this alone may stay.
    #[inline]
    pub fn of_face(&self, f: [u32; 3]) -> f64 {
        if f.iter().all(|&v| self.has_needle(v)) { self.of_face.get(&face_key(f)).copied().unwrap_or(1.0) } else { 1.0 }
    }

    /// The radius ratio of a tetrahedron as a part of what is allowed.
    #[inline]
    pub fn relative(&self, v: &[u32; 4], ratio: f64) -> f64 {
        if self.is_empty() { ratio } else { ratio / self.of_tet(v) }
    }

    /// The radius ratio that a tetrahedron with these vertices can be wished to have.
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

/// About the best radius ratio of a tetrahedron on a triangle: the triangle's own for needles, which half as much again
/// is the most that there is; 1 for others.
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
            // The best of many places for the fourth corner.
            let mut best = 0.0_f64;
            for i in 0..4000 {
                let (y, z) = (f64::from(i % 40) / 30.0 - 0.2, f64::from(i / 40) / 60.0 + 0.01);
                best = best.max(radius_ratio(&a, &b, &c, &p(width / 2.0, y, -z)).abs());
            }
            assert!(best < 1.6 * allowed && best > 0.5 * allowed, "{width}: {best} {allowed}");
        }
    }
}
