//! Exact crossings of a missing edge or triangle with the complex.

use crate::complex::Complex;
use crate::star::{EdgeRing, Star};
use anastomesh_mesh::geometry::predicates::orient3d;

/// First crossing of a segment after its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crossing {
    /// The segment is an edge.
    Exists,
    /// Crosses the interior of a face; half-face of the tetrahedron at the start.
    Face(u32),
    /// Crosses an edge: tetrahedron, both ends.
    Edge(u32, u32, u32),
    /// Passes through a vertex.
    Vertex(u32),
    /// No tetrahedron at the start opens towards the end.
    Nothing,
}

/// Finds the first crossing of the segment from `a` to `b`.
pub(super) fn first_crossing(c: &Complex, star: &mut Star, a: u32, b: u32) -> Crossing {
    if star.find_edge(c, a, b).is_some() {
        return Crossing::Exists;
    }
    star.find(c, a, |t| ahead(c, t, [a, b])).unwrap_or(Crossing::Nothing)
}

/// Crossing of the line from corner `a` of a tetrahedron to `b` with the opposite side.
fn ahead(c: &Complex, t: u32, [a, b]: [u32; 2]) -> Option<Crossing> {
    let i = c.slot_of(t, a)?;
    if c.is_ghost(t) {
        return None;
    }
    let (pa, pb) = (&c.points[a as usize], &c.points[b as usize]);
    let half = 4 * t + i as u32;
    let f = c.face(half);
    let p = f.map(|v| &c.points[v as usize]);
    let mut s = [0.0; 3];
    for k in 0..3 {
        s[k] = orient3d(pa, pb, p[(k + 1) % 3], p[(k + 2) % 3]);
        if s[k] < 0.0 {
            return None;
        }
    }
    // The opposite cone has all signs reversed, so this is the right cone. If two signs vanish, the line runs along an
    // edge at `a`, and the direction decides.
    let zeros: Vec<usize> = (0..3).filter(|&k| s[k] == 0.0).collect();
    match zeros[..] {
        [] => Some(Crossing::Face(half)),
        [k] => Some(Crossing::Edge(t, f[(k + 1) % 3], f[(k + 2) % 3])),
        [k, l] => {
            let v = f[3 - k - l];
            let along = (c.points[v as usize] - pa).dot(&(pb - pa)) > 0.0;
            along.then_some(Crossing::Vertex(v))
        }
        _ => None,
    }
}

/// Maximum crossings listed for one segment.
const FAR: usize = 64;

/// Lists all crossings of the segment from `a` to `b` between its ends, in order. Stops early at a vertex, at a ghost,
/// and after [`FAR`] crossings. Empty if the segment is an edge.
pub(super) fn crossings(c: &Complex, star: &mut Star, ring: &mut EdgeRing, a: u32, b: u32, found: &mut Vec<Crossing>) {
    found.clear();
    let mut next = first_crossing(c, star, a, b);
    while found.len() < FAR {
        found.push(next);
        next = match next {
            Crossing::Face(half) => match beyond_face(c, c.mate(half), a, b) {
                Some(next) => next,
                None => return,
            },
            Crossing::Edge(t, p, q) => match beyond_edge(c, ring, [t, p, q], a, b) {
                Some(next) => next,
                None => return,
            },
            Crossing::Exists | Crossing::Vertex(_) | Crossing::Nothing => return,
        };
    }
}

/// Next crossing of the line from `a` to `b` after it enters a tetrahedron through the interior of face `entry`.
fn beyond_face(c: &Complex, entry: u32, a: u32, b: u32) -> Option<Crossing> {
    let t = entry >> 2;
    if c.is_ghost(t) || c.apex(entry) == b {
        return None;
    }
    (4 * t..4 * t + 4).filter(|&half| half != entry).find_map(|half| through_face(c, half, [a, b]))
}

/// Crossing of the line from `a` to `b` with a face that does not contain it.
fn through_face(c: &Complex, half: u32, [a, b]: [u32; 2]) -> Option<Crossing> {
    let f = c.face(half);
    let at = |v: u32| &c.points[v as usize];
    let s: [f64; 3] = std::array::from_fn(|i| orient3d(at(a), at(b), at(f[i]), at(f[(i + 1) % 3])));
    if s.iter().any(|&x| x > 0.0) && s.iter().any(|&x| x < 0.0) {
        return None;
    }
    let zero = |i: usize| s[i] == 0.0;
    match (0..3).filter(|&i| zero(i)).count() {
        0 => Some(Crossing::Face(half)),
        1 => (0..3).find(|&i| zero(i)).map(|i| Crossing::Edge(half >> 2, f[i], f[(i + 1) % 3])),
        2 => (0..3).find(|&i| zero(i) && zero((i + 2) % 3)).map(|i| Crossing::Vertex(f[i])),
        _ => None,
    }
}

/// Next crossing of the line from `a` to `b` beyond the interior of edge `p, q` of tetrahedron `t`.
fn beyond_edge(c: &Complex, ring: &mut EdgeRing, [t, p, q]: [u32; 3], a: u32, b: u32) -> Option<Crossing> {
    if !ring.collect(c, t, p, q, usize::MAX) || ring.touches_ghost() || ring.rim.contains(&b) {
        return None;
    }
    let at = |v: u32| &c.points[v as usize];
    let (pp, pq, pa, pb) = (at(p), at(q), at(a), at(b));
    for i in 0..ring.len() {
        let (u, v) = (ring.rim[i], ring.rim[(i + 1) % ring.len()]);
        let low = orient3d(pp, pq, at(u), pb);
        if low > 0.0 && orient3d(pp, pq, pb, at(v)) > 0.0 {
            let t = ring.tets[i];
            let ends = [p, q].map(|x| c.slot_of(t, x).map(|k| 4 * t + k as u32));
            return ends.into_iter().flatten().find_map(|half| through_face(c, half, [a, b]));
        }
        // Along the face p, q, u: in its plane, u and b lie on the same side of p q if v sees them alike.
        if low == 0.0 && (orient3d(pp, pq, at(v), pb) > 0.0) == (orient3d(pp, pq, at(v), at(u)) > 0.0) {
            // v lies off the plane that contains the line, so signs of orient3d with v give sides in the plane.
            let (su, sp) = (orient3d(pa, pb, at(u), at(v)), orient3d(pa, pb, pp, at(v)));
            if su == 0.0 {
                return Some(Crossing::Vertex(u));
            }
            let end = if (su > 0.0) == (sp > 0.0) { q } else { p };
            return Some(Crossing::Edge(ring.tets[i], end, u));
        }
    }
    None
}

/// Edge that pierces triangle `a, b, d` nearest to its edge `a, b`: a tetrahedron and both ends.
pub(super) fn piercing_edge(
    c: &Complex,
    star: &mut Star,
    ring: &mut EdgeRing,
    [a, b, d]: [u32; 3],
) -> Option<(u32, u32, u32)> {
    let t = star.find_edge(c, a, b)?;
    if !ring.collect(c, t, a, b, usize::MAX) || ring.touches_ghost() {
        return None;
    }
    let at = |v: u32| &c.points[v as usize];
    (0..ring.len()).find_map(|i| {
        let (u, v) = (ring.rim[i], ring.rim[(i + 1) % ring.len()]);
        let inside = orient3d(at(a), at(b), at(u), at(d)) > 0.0 && orient3d(at(a), at(b), at(d), at(v)) > 0.0;
        inside.then_some((ring.tets[i], u, v))
    })
}

/// All edges that pierce triangle `a, b, d`, whose edges exist, as a tetrahedron and both ends. Those nearest to its
/// edges come first. At most [`FAR`].
pub(super) fn piercing_edges(
    c: &Complex,
    star: &mut Star,
    ring: &mut EdgeRing,
    tri: [u32; 3],
    found: &mut Vec<(u32, u32, u32)>,
) {
    found.clear();
    let add = |found: &mut Vec<(u32, u32, u32)>, t: u32, u: u32, v: u32| {
        let known = found.iter().any(|&(_, x, y)| (x, y) == (u, v) || (x, y) == (v, u));
        if !known && found.len() < FAR {
            found.push((t, u, v));
        }
    };
    for i in 0..3 {
        let side = [tri[i], tri[(i + 1) % 3], tri[(i + 2) % 3]];
        if let Some((t, u, v)) = piercing_edge(c, star, ring, side) {
            add(found, t, u, v);
        }
    }
    let mut head = 0;
    while let Some(&(t, u, v)) = found.get(head) {
        head += 1;
        if !ring.collect(c, t, u, v, usize::MAX) || ring.touches_ghost() {
            continue;
        }
        for (i, &x) in ring.tets.iter().enumerate() {
            for [p, q] in [[u, ring.rim[i]], [v, ring.rim[i]]] {
                if pierces(c, [p, q], tri) {
                    add(found, x, p, q);
                }
            }
        }
    }
}

/// True if edge `p, q` pierces the interior of a triangle.
pub(super) fn pierces(c: &Complex, [p, q]: [u32; 2], tri: [u32; 3]) -> bool {
    if tri.contains(&p) || tri.contains(&q) {
        return false;
    }
    let at = |v: u32| &c.points[v as usize];
    let side = |v: u32| orient3d(at(tri[0]), at(tri[1]), at(tri[2]), at(v));
    let (s, t) = (side(p), side(q));
    if !(s > 0.0 && t < 0.0 || s < 0.0 && t > 0.0) {
        return false;
    }
    let turn: [f64; 3] = std::array::from_fn(|i| orient3d(at(p), at(q), at(tri[i]), at(tri[(i + 1) % 3])));
    turn.iter().all(|&x| x > 0.0) || turn.iter().all(|&x| x < 0.0)
}
