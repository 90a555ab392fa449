//! Exact intersection of triangles of a mesh.
//!
//! Two triangles of a valid surface share only their common vertices and the edge between them. The intersection of two
//! triangles is convex, and each of its corners lies on exactly one feature (vertex, edge or inside) of either
//! triangle. Such a pair of features is a *hit*. Exact predicates find the hits, and their number tells the kind of
//! intersection: none, a point, a segment, or an area.

use super::fans::Fans;
use super::predicates::{ORIENT3D_BOUND, collinear, orient2d, orient3d};
use super::{Aabb, Bvh, Point3};
use rayon::prelude::*;

/// Relation of two triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// No point in common.
    Apart,
    /// Only vertices shared by id in common, and the edge between two such.
    Neighbours,
    /// An intersection that no valid surface has.
    Improper(Improper),
}

/// Kind of an improper intersection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Improper {
    /// Only two vertices with different ids at one point.
    CoincidentPoint,
    /// Only a vertex on an edge.
    VertexOnEdge,
    /// Only a vertex inside the other triangle.
    VertexOnFace,
    /// Only two edges that cross in a point.
    EdgeOnEdge,
    /// A segment in common.
    Crossing,
    /// An area in common.
    CoplanarOverlap,
    /// One vertex shared by id, and a segment from there in common.
    BeyondSharedVertex,
    /// Two vertices shared by id; the triangles lie in one plane on one side of their edge.
    Folded,
    /// Three equal vertices.
    SameVertices,
    /// A triangle without area.
    Degenerate,
}

/// Corners of the intersection of two triangles, as a set of feature pairs. Bit 7 i + j stands for feature i of the
/// first and j of the second. Features 0 to 2 are the vertices, 3 to 5 the edges, 6 the inside. Edge 3 + i starts at
/// vertex i.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Hits(u64);

const INSIDE: usize = 6;

impl Hits {
    fn add(&mut self, first: usize, second: usize) {
        self.0 |= 1 << (7 * first + second);
    }

    fn count(self) -> u32 {
        self.0.count_ones()
    }

    /// Kind of a single hit.
    fn point_contact(self) -> Improper {
        let bit = self.0.trailing_zeros() as usize;
        match (bit / 7, bit % 7) {
            (0..=2, 0..=2) => Improper::CoincidentPoint,
            (0..=2, 3..=5) | (3..=5, 0..=2) => Improper::VertexOnEdge,
            (3..=5, 3..=5) => Improper::EdgeOnEdge,
            _ => Improper::VertexOnFace,
        }
    }
}

/// A triangle with the ids of its vertices.
#[derive(Clone, Copy, Debug)]
pub struct Triangle<'a> {
    /// Ids of the vertices, which identify neighbours.
    pub ids: [u32; 3],
    /// Positions of the vertices.
    pub corners: [&'a Point3; 3],
}

impl<'a> Triangle<'a> {
    fn new(points: &'a [Point3], ids: [u32; 3]) -> Self {
        Self { ids, corners: ids.map(|v| &points[v as usize]) }
    }

    /// Side of this triangle's plane on which a point lies: the sign of `orient3d`.
    fn side(&self, p: &Point3) -> i8 {
        let [a, b, c] = self.corners;
        sign(orient3d(a, b, c, p))
    }

    /// Sides of the vertices of another triangle; shared vertices are on the plane.
    fn sides(&self, other: &Self) -> [i8; 3] {
        std::array::from_fn(|i| if self.ids.contains(&other.ids[i]) { 0 } else { self.side(other.corners[i]) })
    }

    /// True if another triangle lies strictly on one side of this one's plane, beyond rounding errors: three filtered
    /// `orient3d` with one normal.
    fn clearly_beside(&self, other: &Self) -> bool {
        let [a, b, c] = self.corners;
        let (b, c) = (b - a, c - a);
        let normal = b.cross(&c);
        let across = b.abs().sup(&c.abs());
        let side = |p: &Point3| {
            let d = p - a;
            let bound = across.sup(&d.abs());
            let det = normal.dot(&d);
            if det.abs() > ORIENT3D_BOUND * bound.x * bound.y * bound.z { det } else { 0.0 }
        };
        let [p, q, r] = other.corners.map(side);
        (p > 0.0 && q > 0.0 && r > 0.0) || (p < 0.0 && q < 0.0 && r < 0.0)
    }

    /// Index of the corner with this id.
    fn index_of(&self, id: u32) -> Option<usize> {
        self.ids.iter().position(|&v| v == id)
    }
}

/// Relation of triangles `a` and `b` (vertex ids). Exact for finite coordinates in the range of the predicates;
/// symmetric in `a` and `b`.
pub fn classify(points: &[Point3], a: [u32; 3], b: [u32; 3]) -> Contact {
    classify_triangles(Triangle::new(points, a), Triangle::new(points, b))
}

/// As [`classify`], for triangles with vertices in separate arrays; equal ids must have equal positions.
pub fn classify_triangles(p: Triangle, q: Triangle) -> Contact {
    let (a, b) = (p.ids, q.ids);
    let shared = a.iter().filter(|v| b.contains(v)).count() as u32;
    if shared == 3 {
        return Contact::Improper(Improper::SameVertices);
    }
    let apart = if shared == 0 { Contact::Apart } else { Contact::Neighbours };
    if shared == 0 && (p.clearly_beside(&q) || q.clearly_beside(&p)) {
        return apart;
    }
    let q_sides = p.sides(&q);
    if separated(q_sides, shared) {
        return apart;
    }
    let p_sides = q.sides(&p);
    if separated(p_sides, shared) {
        return apart;
    }
    let hits = match (q_sides == [0; 3], p_sides == [0; 3]) {
        (false, false) => Some(hits_across(&p, &q, p_sides, q_sides)),
        (true, true) => hits_in_plane(&p, &q),
        // A degenerate triangle has no plane, so every point counts as on it.
        _ => None,
    };
    let Some(hits) = hits else { return Contact::Improper(Improper::Degenerate) };
    let improper = match (shared, hits.count()) {
        (shared, count) if shared == count => return apart,
        (0, 1) => hits.point_contact(),
        (0, 2) => Improper::Crossing,
        (1, 2) => Improper::BeyondSharedVertex,
        (2, _) => Improper::Folded,
        _ => Improper::CoplanarOverlap,
    };
    Contact::Improper(improper)
}

/// True if the vertices that are not shared lie strictly on one side, so that nothing else is in common.
fn separated(sides: [i8; 3], shared: u32) -> bool {
    let count = |s: i8| sides.iter().filter(|&&side| side == s).count() as u32;
    count(1) == 3 - shared || count(-1) == 3 - shared
}

/// Hits of two triangles in different planes: at each corner of the intersection, a vertex or edge of one meets the
/// other's plane.
fn hits_across(p: &Triangle, q: &Triangle, p_sides: [i8; 3], q_sides: [i8; 3]) -> Hits {
    let mut hits = Hits::default();
    half_across(p, q, p_sides, |of_p, of_q| hits.add(of_p, of_q));
    half_across(q, p, q_sides, |of_q, of_p| hits.add(of_p, of_q));
    hits
}

fn half_across(p: &Triangle, q: &Triangle, p_sides: [i8; 3], mut hit: impl FnMut(usize, usize)) {
    for i in 0..3 {
        let next = (i + 1) % 3;
        if p_sides[i] == 0 {
            if let Some(feature) = feature_at(q, p.ids[i], p.corners[i]) {
                hit(i, feature);
            }
        } else if p_sides[next] == -p_sides[i]
            && let Some(feature) = pierced_feature(q, p.corners[i], p.corners[next])
        {
            hit(3 + i, feature);
        }
    }
}

/// Feature of `q` pierced by the line through `a` and `b`, which lie strictly on either side.
fn pierced_feature(q: &Triangle, a: &Point3, b: &Point3) -> Option<usize> {
    let turn = |j: usize| sign(orient3d(a, b, q.corners[j], q.corners[(j + 1) % 3]));
    feature_of_turns([turn(0), turn(1), turn(2)])
}

/// Feature of `q` that contains a point of its plane; `None` outside.
fn feature_at(q: &Triangle, id: u32, point: &Point3) -> Option<usize> {
    if let Some(j) = q.index_of(id) {
        return Some(j);
    }
    let axes = projection(q)?;
    feature_in(q, axes, point)
}

fn feature_in(q: &Triangle, axes: [usize; 2], point: &Point3) -> Option<usize> {
    let turn = |j: usize| turn2(axes, q.corners[j], q.corners[(j + 1) % 3], point);
    feature_of_turns([turn(0), turn(1), turn(2)])
}

/// Feature of a triangle that contains a point of its plane, from the side of the point at each edge.
fn feature_of_turns(turns: [i8; 3]) -> Option<usize> {
    if turns.contains(&1) && turns.contains(&-1) {
        return None;
    }
    match turns.map(|t| t == 0) {
        [false, false, false] => Some(INSIDE),
        [true, false, false] => Some(3),
        [false, true, false] => Some(4),
        [false, false, true] => Some(5),
        // On two edges: at the vertex between them.
        [true, false, true] => Some(0),
        [true, true, false] => Some(1),
        [false, true, true] => Some(2),
        [true, true, true] => None,
    }
}

/// Hits of two coplanar triangles; `None` if one has no area.
fn hits_in_plane(p: &Triangle, q: &Triangle) -> Option<Hits> {
    let axes = projection(q)?;
    projection(p)?;
    let mut hits = Hits::default();
    for i in 0..3 {
        let of_q = q.index_of(p.ids[i]).or_else(|| feature_in(q, axes, p.corners[i]));
        if let Some(feature) = of_q {
            hits.add(i, feature);
        }
        let of_p = p.index_of(q.ids[i]).or_else(|| feature_in(p, axes, q.corners[i]));
        if let Some(feature) = of_p {
            hits.add(feature, i);
        }
        for j in 0..3 {
            if edges_cross(p, i, q, j, axes) {
                hits.add(3 + i, 3 + j);
            }
        }
    }
    Some(hits)
}

/// True if edge `i` of `p` and edge `j` of `q`, in one plane, cross inside both.
fn edges_cross(p: &Triangle, i: usize, q: &Triangle, j: usize, axes: [usize; 2]) -> bool {
    let (i2, j2) = ((i + 1) % 3, (j + 1) % 3);
    if [p.ids[i], p.ids[i2]].iter().any(|v| *v == q.ids[j] || *v == q.ids[j2]) {
        return false;
    }
    let (a, b, c, d) = (p.corners[i], p.corners[i2], q.corners[j], q.corners[j2]);
    let opposite = |s: i8, t: i8| s != 0 && s == -t;
    opposite(turn2(axes, a, b, c), turn2(axes, a, b, d)) && opposite(turn2(axes, c, d, a), turn2(axes, c, d, b))
}

/// Two coordinates in which the triangle has area; `None` if it has none.
fn projection(t: &Triangle) -> Option<[usize; 2]> {
    let [a, b, c] = t.corners;
    [[0, 1], [1, 2], [2, 0]].into_iter().find(|&axes| turn2(axes, a, b, c) != 0)
}

fn turn2([i, j]: [usize; 2], a: &Point3, b: &Point3, c: &Point3) -> i8 {
    sign(orient2d([a[i], a[j]], [b[i], b[j]], [c[i], c[j]]))
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// Pairs tested per batch.
const BATCH: usize = 1 << 16;

/// Minimum pairs per thread.
const SHARE: usize = 1 << 12;

/// All pairs `(i, j)`, i < j, of triangles that intersect improperly, ascending. A triangle without area gives only
/// `(i, i)`. Coordinates must be finite.
///
/// Neighbours are identified by the ids of their vertices. The result does not depend on the number of threads.
pub fn self_intersections(points: &[Point3], triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    self_contacts(points, triangles).into_iter().map(|(i, j, _)| (i, j)).collect()
}

/// As `self_intersections`, with the kind of each.
pub fn self_contacts(points: &[Point3], triangles: &[[u32; 3]]) -> Vec<(u32, u32, Improper)> {
    contacts_with(points, triangles, &Fans::of(points, triangles), &|| false)
}

/// As `self_contacts`, until `is_stopped` returns true. The contacts found until then are some of all.
pub fn self_contacts_until(
    points: &[Point3],
    triangles: &[[u32; 3]],
    is_stopped: &dyn Fn() -> bool,
) -> Vec<(u32, u32, Improper)> {
    contacts_with(points, triangles, &Fans::of(points, triangles), is_stopped)
}

/// As `self_contacts_until`, with the known fans of the triangles.
pub(crate) fn contacts_with(
    points: &[Point3],
    triangles: &[[u32; 3]],
    fans: &Fans,
    is_stopped: &dyn Fn() -> bool,
) -> Vec<(u32, u32, Improper)> {
    let mut found: Vec<(u32, u32, Improper)> = Vec::new();
    // On a smooth surface nearly all vertices are proved, and neighbours there need no test: the tree has one box for the
    // triangles of such a vertex. Boxes are in the order of `grouped`.
    let (grouped, ends) = fans.groups();
    let proved_or_none = |v: u32| if fans.proved[v as usize] { v } else { u32::MAX };
    let boxed = |&t: &u32| {
        let known = triangles[t as usize].map(proved_or_none);
        let [a, b, c] = triangles[t as usize].map(|v| &points[v as usize]);
        let is_degenerate = known == [u32::MAX; 3] && collinear(a, b, c);
        (if is_degenerate { Aabb::EMPTY } else { Aabb::of_points([a, b, c]) }, known, t)
    };
    let boxes: Vec<(Aabb, [u32; 3], u32)> = grouped.par_iter().with_min_len(BATCH).map(boxed).collect();
    let degenerate = boxes.iter().filter(|(aabb, ..)| aabb.min.x > aabb.max.x);
    found.extend(degenerate.map(|&(.., t)| (t, t, Improper::Degenerate)));
    let start = |group: u32| if group == 0 { 0 } else { ends[group as usize - 1] as usize };
    let group = |group: u32| &boxes[start(group)..ends[group as usize] as usize];
    let hull = |i: u32| group(i).iter().fold(Aabb::EMPTY, |sum, (aabb, ..)| sum.union(aabb));
    let hulls: Vec<Aabb> = (0..ends.len() as u32).into_par_iter().with_min_len(BATCH).map(hull).collect();
    let mut batch: Vec<(u32, u32)> = Vec::with_capacity(BATCH);
    let mut is_over = false;
    Bvh::new(&hulls).self_pairs(|p, q| {
        for (box_i, of_i, i) in group(p).iter().filter(|(aabb, ..)| aabb.overlaps(&hulls[q as usize])) {
            for (_, of_j, j) in group(q).iter().filter(|(aabb, ..)| aabb.overlaps(box_i)) {
                if !have_common(*of_i, *of_j) {
                    batch.push((*i.min(j), *i.max(j)));
                }
            }
        }
        if batch.len() >= BATCH {
            is_over |= is_stopped();
            if !is_over {
                test_pairs(points, triangles, &batch, &mut found);
            }
            batch.clear();
        }
    });
    test_pairs(points, triangles, &batch, &mut found);
    found.sort_unstable();
    found
}

/// True if two triangles have a common number other than the largest. Branch-free, since branches were unpredictable.
#[inline]
#[allow(clippy::needless_bitwise_bool)]
fn have_common(a: [u32; 3], b: [u32; 3]) -> bool {
    let is_in = |v: u32| ((v == b[0]) | (v == b[1]) | (v == b[2])) & (v != u32::MAX);
    is_in(a[0]) | is_in(a[1]) | is_in(a[2])
}

fn test_pairs(points: &[Point3], triangles: &[[u32; 3]], pairs: &[(u32, u32)], found: &mut Vec<(u32, u32, Improper)>) {
    let test = |&(i, j): &(u32, u32)| match classify(points, triangles[i as usize], triangles[j as usize]) {
        Contact::Improper(kind) => Some((i, j, kind)),
        Contact::Apart | Contact::Neighbours => None,
    };
    // Few pairs are tested without the thread pool, which could start unrelated work.
    if pairs.len() < SHARE {
        found.extend(pairs.iter().filter_map(test));
    } else {
        found.par_extend(pairs.par_iter().with_min_len(SHARE).filter_map(test));
    }
}

#[cfg(test)]
#[path = "tri_tri_tests.rs"]
mod tests;
