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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delaunay::delaunay;
    use anastomesh_mesh::geometry::Point3;

    #[test]
    fn an_edge_pierces_only_the_interior_of_a_triangle() {
        let mut points = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        // Inside, beyond each side, on a side, beside a corner.
        for [x, y] in [[1.0, 1.0], [1.0, -1.0], [3.0, 3.0], [-1.0, 1.0], [2.0, 0.0], [-1.0, -1.0]] {
            points.extend([1.0, -1.0, 2.0].map(|z| [x, y, z]));
        }
        points.push([1.0, 1.0, 0.0]);
        let c = Complex::new(points.into_iter().map(Point3::from).collect());
        for triangle in [[0, 1, 2], [2, 1, 0]] {
            let pierced: Vec<u32> = (3..21).step_by(3).filter(|&v| pierces(&c, [v, v + 1], triangle)).collect();
            assert_eq!(pierced, [3]);
            assert!(pierces(&c, [4, 3], triangle) && pierces(&c, [4, 5], triangle));
            // From one side, from a corner, and from its plane.
            assert!(!pierces(&c, [3, 5], triangle) && !pierces(&c, [0, 4], triangle) && !pierces(&c, [3, 1], triangle));
            assert!(!pierces(&c, [21, 3], triangle) && !pierces(&c, [3, 21], triangle));
        }
    }

    /// Crossings of a segment between two points, in order.
    fn along(c: &Complex, from: [f64; 3], to: [f64; 3]) -> Vec<String> {
        let at = |p: [f64; 3]| c.points.iter().position(|q| *q == Point3::from(p)).unwrap() as u32;
        let mut found = Vec::new();
        crossings(c, &mut Star::default(), &mut EdgeRing::default(), at(from), at(to), &mut found);
        let place = |x: &Crossing| match *x {
            Crossing::Face(half) => format!("face {:?}", sorted(c.face(half).to_vec())),
            Crossing::Edge(t, p, q) => {
                assert!([p, q].iter().all(|&v| c.slot_of(t, v).is_some()));
                format!("edge {:?}", sorted(vec![p, q]))
            }
            Crossing::Vertex(v) => format!("vertex {v}"),
            Crossing::Exists => "exists".into(),
            Crossing::Nothing => "nothing".into(),
        };
        found.iter().map(place).collect()
    }

    fn sorted(mut v: Vec<u32>) -> Vec<u32> {
        v.sort_unstable();
        v
    }

    /// Crossings of a segment between two points of a complex, found by tests of all faces, edges and vertices.
    fn crossed(c: &Complex, [a, b]: [u32; 2]) -> std::collections::BTreeSet<String> {
        let mut all = std::collections::BTreeSet::new();
        let at = |v: u32| &c.points[v as usize];
        let between = |p: &Point3| {
            let along = at(b) - at(a);
            let share = (p - at(a)).dot(&along) / along.norm_squared();
            share > 1e-9 && share < 1.0 - 1e-9
        };
        for t in c.real_tets() {
            for half in 4 * t..4 * t + 4 {
                let f = c.face(half);
                if pierces(c, [a, b], f) {
                    all.insert(format!("face {:?}", sorted(f.to_vec())));
                }
                for [p, q] in [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]] {
                    let (u, v) = (at(q) - at(p), at(b) - at(a));
                    let normal = u.cross(&v);
                    let apart = normal.dot(&(at(a) - at(p)));
                    if [a, b].contains(&p) || [a, b].contains(&q) || normal.norm() < 1e-9 || apart.abs() > 1e-9 {
                        continue;
                    }
                    let share = (at(a) - at(p)).cross(&v).dot(&normal) / normal.norm_squared();
                    if share > 1e-9 && share < 1.0 - 1e-9 && between(&(at(p) + u * share)) {
                        all.insert(format!("edge {:?}", sorted(vec![p, q])));
                    }
                }
                for v in f {
                    let off = (at(v) - at(a)).cross(&(at(b) - at(a))).norm();
                    if ![a, b].contains(&v) && off < 1e-9 && between(at(v)) {
                        all.insert(format!("vertex {v}"));
                    }
                }
            }
        }
        all
    }

    #[test]
    fn all_crossings_of_a_segment_are_listed() {
        // Grids have crossings of all kinds; the shifted one, mostly faces and edges.
        let mut kinds = [0; 4];
        for shift in [0.0, 0.25] {
            let mut points = Vec::new();
            for i in 0..27 {
                let [x, y, z] = [i % 3, i / 3 % 3, i / 9].map(f64::from);
                points.push(Point3::new(x + shift * y, y + shift * z * z, z));
            }
            points.extend(crate::conform::box_corners(&points));
            let c = delaunay(&points).unwrap();
            for a in 0..27_u32 {
                for b in (0..27).filter(|&b| b != a) {
                    let found = along(&c, points[a as usize].coords.into(), points[b as usize].coords.into());
                    let expected = crossed(&c, [a, b]);
                    let first = found[0].split(' ').next().unwrap();
                    let kind = ["exists", "face", "edge", "vertex"].iter().position(|&x| x == first).unwrap();
                    kinds[kind] += 1;
                    if kind == 0 {
                        assert!(expected.is_empty() && found.len() == 1, "{a} {b}: {found:?} {expected:?}");
                        continue;
                    }
                    // Crossings end at a vertex.
                    let all: std::collections::BTreeSet<String> = found.iter().cloned().collect();
                    assert!(all.is_subset(&expected), "{a} {b}: {found:?} {expected:?}");
                    assert_eq!(all.len(), found.len());
                    let stops = found.last().is_some_and(|x| x.starts_with("vertex"));
                    assert!(stops || all == expected, "{a} {b}: {found:?} {expected:?}");
                }
            }
        }
        assert!(kinds.iter().all(|&n| n > 30), "{kinds:?}");
    }

    #[test]
    fn a_vertex_on_the_segment_is_found_beyond_a_face() {
        // A face between vertices 3 and 4, and 5 further on.
        let points =
            [[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [0.0, 0.0, -2.0], [0.0, 0.0, 2.0], [0.0, 0.0, 6.0]];
        // The second tetrahedron, with its last vertex at each place.
        for second in [[0, 1, 2, 4], [0, 2, 4, 1], [0, 4, 1, 2], [4, 0, 2, 1]] {
            let tets = [[1, 0, 2, 3], second];
            let Ok(c) = Complex::from_mesh(points.map(Point3::from).to_vec(), &tets) else { panic!("{second:?}") };
            assert_eq!(along(&c, points[3], points[5]), ["face [0, 1, 2]", "vertex 4"], "{second:?}");
        }
    }

    #[test]
    fn an_edge_that_pierces_a_triangle_crosses_its_plane() {
        let points: Vec<Point3> = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9].map(f64::from)).map(Point3::from).collect();
        let c = delaunay(&points).unwrap();
        let (mut star, mut ring, mut found) = (Star::default(), EdgeRing::default(), 0);
        let at = |v: u32| &c.points[v as usize];
        for [a, b, d] in (0..27 * 27 * 27_u32).map(|k| [k % 27, k / 27 % 27, k / 729]) {
            let Some((t, u, v)) = piercing_edge(&c, &mut star, &mut ring, [a, b, d]) else { continue };
            found += 1;
            assert!([a, b, u, v].iter().all(|&x| c.slot_of(t, x).is_some()));
            assert!(orient3d(at(a), at(b), at(u), at(d)) > 0.0 && orient3d(at(a), at(b), at(d), at(v)) > 0.0);
        }
        assert!(found > 100, "{found}");
    }
}
