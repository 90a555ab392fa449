//! What stands between the ends of a missing edge, or within a missing triangle. Exact.

use crate::geometry::predicates::orient3d;
use crate::tet::complex::Complex;
use crate::tet::star::{EdgeRing, Star};

/// What a segment meets first on leaving its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crossing {
    /// The segment is an edge.
    Exists,
    /// It crosses the inside of a face; half-face of the tetrahedron at the start.
    Face(u32),
    /// It crosses an edge: tetrahedron, both ends.
    Edge(u32, u32, u32),
    /// It runs through a vertex.
    Vertex(u32),
    /// No tetrahedron at the start opens towards the end.
    Nothing,
}

/// Finds what the segment from `a` to `b` meets first.
pub(super) fn first_crossing(c: &Complex, star: &mut Star, a: u32, b: u32) -> Crossing {
    let tets = star.around(c, a);
    if tets.iter().any(|&t| c.slot_of(t, b).is_some()) {
        return Crossing::Exists;
    }
    let (pa, pb) = (&c.points[a as usize], &c.points[b as usize]);
    for &t in tets {
        let Some(i) = c.slot_of(t, a) else { continue };
        if c.is_ghost(t) {
            continue;
        }
        let half = 4 * t + i as u32;
        let f = c.face(half);
        let p = f.map(|v| &c.points[v as usize]);
        let s = [orient3d(pa, pb, p[1], p[2]), orient3d(pa, pb, p[2], p[0]), orient3d(pa, pb, p[0], p[1])];
        if s.iter().any(|&x| x < 0.0) {
            continue;
        }
        // The line through a also points into the opposite cone: all signs are reversed there, so this is the right
        // one unless two of them vanish, when the line runs along an edge at a.
        let zeros: Vec<usize> = (0..3).filter(|&k| s[k] == 0.0).collect();
        match zeros[..] {
            [] => return Crossing::Face(half),
            [k] => return Crossing::Edge(t, f[(k + 1) % 3], f[(k + 2) % 3]),
            [k, l] => {
                let v = f[3 - k - l];
                let along = (c.points[v as usize] - pa).dot(&(pb - pa)) > 0.0;
                if along {
                    return Crossing::Vertex(v);
                }
            }
            _ => {}
        }
    }
    Crossing::Nothing
}

/// The edge that pierces triangle `a, b, d` nearest to its edge `a, b`: a tetrahedron and both ends.
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
