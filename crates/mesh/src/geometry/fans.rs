//! Proof, for most vertices of a smooth surface, that the adjacent triangles intersect only where connected.
//!
//! Suppose a linear map to the plane gives all triangles of a vertex one orientation, and together one turn around it.
//! Then the images do not overlap, nor do the triangles. Signs are those of the exact values; doubtful signs prove
//! nothing.

use super::{Point3, Vec3};
use rayon::prelude::*;

/// Relative error bound of a cross product of images, and an absolute bound against underflow. The margin is wide:
/// errors are below 30 units of 1.1e-16.
const RELATIVE: f64 = 1e-13;
const ABSOLUTE: f64 = 1e-280;

/// Maximum triangles at one vertex; larger fans are left to other tests.
const MOST: usize = 16;

/// Minimum vertices per thread. Small surfaces are examined without the thread pool, which could start unrelated work.
const SHARE: usize = 1 << 14;

/// Triangles around the vertices of a surface.
pub(crate) struct Fans {
    /// Corners, `3 · triangle + i`, grouped by vertex; the corners of vertex `v` end at `ends[v]`.
    corners: Vec<u32>,
    ends: Vec<u32>,
    /// True for vertices whose triangles provably share only the vertex and the edges between consecutive ones. None of
    /// these triangles is degenerate.
    pub(super) proved: Vec<bool>,
    /// True if every edge is provably in two triangles with opposite directions, and the triangles of each vertex form
    /// one fan.
    pub is_manifold: bool,
}

impl Fans {
    /// Examines the vertices one by one.
    pub fn of(points: &[Point3], triangles: &[[u32; 3]]) -> Self {
        let vertices = triangles.as_flattened();
        let mut ends = vec![0_u32; points.len() + 1];
        for &v in vertices {
            ends[v as usize + 1] += 1;
        }
        for i in 0..points.len() {
            ends[i + 1] += ends[i];
        }
        let mut corners = vec![0_u32; vertices.len()];
        for (corner, &v) in (0..).zip(vertices) {
            let slot = &mut ends[v as usize];
            corners[*slot as usize] = corner;
            *slot += 1;
        }
        // Filling moved each offset to the start of the next vertex.
        let mut fans = Self { corners, ends, proved: Vec::new(), is_manifold: true };
        let examine = |fan: &mut Vec<[u32; 2]>, (v, p): (usize, &Point3)| {
            fan.clear();
            fan.extend(fans.at(v).iter().map(|&corner| neighbors(triangles, corner)));
            let is_closed = sort_around(fan);
            let is_proved = is_closed && turns_once(points, p, fan);
            (is_proved, is_proved || fan.is_empty() || (is_closed && is_simple(v as u32, fan)))
        };
        let all = points.par_iter().enumerate().with_min_len(SHARE);
        let (proved, manifold): (Vec<bool>, Vec<bool>) = all.map_init(Vec::new, examine).unzip();
        fans.is_manifold = manifold.into_iter().all(|is_manifold| is_manifold);
        fans.proved = proved;
        fans
    }

    fn at(&self, v: usize) -> &[u32] {
        let start = if v == 0 { 0 } else { self.ends[v - 1] };
        &self.corners[start as usize..self.ends[v] as usize]
    }

    /// Partition of the triangles into groups with a common proved vertex, and single ones. Returns the triangles group
    /// by group, and the ends of the groups.
    pub(super) fn groups(&self) -> (Vec<u32>, Vec<u32>) {
        let count = self.corners.len() / 3;
        let mut is_taken = vec![false; count];
        let (mut triangles, mut ends) = (Vec::with_capacity(count), Vec::with_capacity(count / 3));
        for (v, _) in self.proved.iter().enumerate().filter(|(_, proved)| **proved) {
            let around = self.at(v).iter().map(|corner| corner / 3);
            triangles.extend(around.filter(|&t| !std::mem::replace(&mut is_taken[t as usize], true)));
            if ends.last().copied().unwrap_or(0) < triangles.len() as u32 {
                ends.push(triangles.len() as u32);
            }
        }
        for (t, _) in (0..).zip(is_taken).filter(|(_, taken)| !taken) {
            triangles.push(t);
            ends.push(triangles.len() as u32);
        }
        ends.dedup();
        (triangles, ends)
    }
}

/// The two other vertices of a corner's triangle, in its direction.
fn neighbors(triangles: &[[u32; 3]], corner: u32) -> [u32; 2] {
    let [a, b, c] = triangles[corner as usize / 3];
    [[b, c], [c, a], [a, b]][corner as usize % 3]
}

/// Sorts the triangles of a vertex so that each starts at the end of the previous one, the first at the end of the last.
/// Returns false if this fails, and for fans with too few or too many triangles.
fn sort_around(fan: &mut [[u32; 2]]) -> bool {
    if fan.len() < 3 || fan.len() > MOST {
        return false;
    }
    for i in 1..fan.len() {
        let end = fan[i - 1][1];
        let Some(next) = fan[i..].iter().position(|t| t[0] == end) else { return false };
        fan.swap(i, i + next);
    }
    fan[fan.len() - 1][1] == fan[0][0]
}

/// True if a sorted fan has each edge once, and its triangles have three vertices each.
fn is_simple(v: u32, fan: &[[u32; 2]]) -> bool {
    fan.iter().enumerate().all(|(i, t)| t[0] != v && fan[..i].iter().all(|u| u[0] != t[0]))
}

/// True if the images of a sorted fan are all positive and turn once around the vertex.
fn turns_once(points: &[Point3], p: &Point3, fan: &[[u32; 2]]) -> bool {
    let mut spokes = [Vec3::zeros(); MOST];
    for (spoke, t) in spokes.iter_mut().zip(fan) {
        *spoke = points[t[0] as usize] - p;
    }
    let spokes = &spokes[..fan.len()];
    let last = spokes[spokes.len() - 1];
    let (mut sum, mut a) = (Vec3::zeros(), &last);
    for b in spokes {
        sum += a.cross(b);
        a = b;
    }
    let Some(normal) = sum.try_normalize(0.0) else { return false };
    let mut axis = Vec3::zeros();
    axis[normal.iamin()] = 1.0;
    // Any two vectors are valid; these make the images as large as the triangles.
    let e = normal.cross(&axis);
    let f = normal.cross(&e);
    let image = |d: &Vec3| (d.dot(&e), d.dot(&f), d.x.abs() + d.y.abs() + d.z.abs());
    let mut turns = 0;
    let (mut ax, mut ay, mut a) = image(&last);
    for d in spokes {
        let (bx, by, b) = image(d);
        let cross = ax * by - ay * bx;
        // Formulated so that NaN fails.
        let certain = cross > RELATIVE * (a * b) + ABSOLUTE && cross < f64::MAX && by.abs() > RELATIVE * b + ABSOLUTE;
        if !certain {
            return false;
        }
        turns += u32::from(ay < 0.0 && by > 0.0);
        (ax, ay, a) = (bx, by, b);
    }
    turns == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Contact, classify};
    use proptest::prelude::*;

    proptest! {
        /// Proofs agree with the exact test of every pair of triangles.
        #[test]
        fn proved_fans_have_no_improper_contact(rim in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -0.3..0.3_f64), 3..9)) {
            let mut points = vec![Point3::origin()];
            points.extend(rim.iter().map(|&(x, y, z)| Point3::new(x, y, z)));
            let n = rim.len() as u32;
            let triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
            if Fans::of(&points, &triangles).proved[0] {
                for i in 0..triangles.len() {
                    for j in i + 1..triangles.len() {
                        prop_assert_eq!(classify(&points, triangles[i], triangles[j]), Contact::Neighbours);
                    }
                }
            }
        }
    }

    fn star(turns: f64, n: u32) -> (Vec<Point3>, Vec<[u32; 3]>) {
        let mut points = vec![Point3::origin()];
        points.extend((0..n).map(|i| {
            let angle = 0.1 + turns * std::f64::consts::TAU * f64::from(i) / f64::from(n);
            Point3::new(libm::cos(angle), libm::sin(angle), 0.1 * f64::from(i % 2))
        }));
        (points, (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect())
    }

    #[test]
    fn a_fan_that_turns_once_is_proved_and_one_that_turns_twice_or_is_open_is_not() {
        let (points, triangles) = star(1.0, 6);
        assert!(Fans::of(&points, &triangles).proved[0]);
        assert!(!Fans::of(&points, &triangles[..5]).proved[0]);
        let (points, triangles) = star(2.0, 12);
        assert!(!Fans::of(&points, &triangles).proved[0]);
    }
}
