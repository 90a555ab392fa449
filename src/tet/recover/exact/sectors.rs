//! The star of a vertex on the surface, cut into sectors by the facets around it, and these facets without the vertex.

use super::polygon::{point_above, triangulate};
use super::space::Space;
use crate::geometry::Vec3;
use crate::tet::complex::{GHOST, face_key};
use crate::tet::error::TetError;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// A facet around a vertex that lies on it: its faces at the vertex, and those that take their place.
pub(super) struct Fan {
    /// None for a pair of faces that only helps to make sectors.
    pub facet: Option<u32>,
    pub old: Vec<[u32; 3]>,
    pub new: Vec<[u32; 3]>,
}

impl Fan {
    /// A facet without the vertex `v`; on a segment between `ends`, or inside of the facet. Nothing if its faces make no
    /// simple polygon.
    pub(super) fn of(
        s: &Space,
        pieces: &[[u32; 3]],
        (facet, triangle): (u32, [u32; 3]),
        v: u32,
        ends: Option<[u32; 2]>,
    ) -> Result<Option<Self>, TetError> {
        let old: Vec<[u32; 3]> = pieces.iter().filter(|f| f.contains(&v)).copied().collect();
        let mut next: FxHashMap<u32, u32> = FxHashMap::default();
        for f in &old {
            if let Some(k) = f.iter().position(|&x| x == v) {
                next.insert(f[(k + 1) % 3], f[(k + 2) % 3]);
            }
        }
        let Some(polygon) = outline(&next, ends) else { return Ok(None) };
        let above = point_above(s, triangle)?;
        let mut new = Vec::new();
        let simple = triangulate(s, &polygon, &above, &mut new);
        Ok(simple.then_some(Self { facet: Some(facet), old, new }))
    }

    /// Faces that are in no facet, from one neighbour of a vertex on a segment to the other, and those that take their
    /// place. As many as `needed`, far from each other and from `others`.
    pub(super) fn helpers(
        s: &Space,
        v: u32,
        [p, q]: [u32; 2],
        star: &[u32],
        others: &[Self],
        needed: usize,
    ) -> Vec<Self> {
        let mut link: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for &t in star {
            let rim: Vec<u32> = s.c.verts(t).into_iter().filter(|&x| x != v && x != GHOST).collect();
            for &x in &rim {
                link.entry(x).or_default().extend(rim.iter().filter(|&&y| y != x));
            }
        }
        for &x in others.iter().flat_map(|fan| &fan.old).flatten().filter(|&&x| x != p && x != q) {
            link.remove(&x);
        }
        let (origin, along) = (s.point(v), (s.point(q) - s.point(p)).normalize());
        let direction = |x: u32| {
            let d = s.point(x) - origin;
            (d - along * d.dot(&along)).normalize()
        };
        let middle = |f: &Self| f.old.first().and_then(|f| f.iter().copied().find(|&x| x != v && x != p && x != q));
        let mut taken: Vec<Vec3> = others.iter().filter_map(middle).map(direction).collect();
        let mut found = Vec::new();
        while found.len() < needed {
            let crowd = |x: u32| taken.iter().map(|d| d.dot(&direction(x))).fold(-1.0, f64::max);
            let Some(path) = path(&link, [p, q], crowd) else { break };
            for x in &path[1..path.len() - 1] {
                link.remove(x);
            }
            taken.push(direction(path[path.len() / 2]));
            let old = path.windows(2).map(|e| [e[0], v, e[1]]).collect();
            let new = path[1..].windows(2).map(|e| [e[0], p, e[1]]).collect();
            found.push(Self { facet: None, old, new });
        }
        found
    }
}

/// A way from `p` to `q` with few edges, of those with one vertex between the one that is least crowded.
fn path(link: &BTreeMap<u32, BTreeSet<u32>>, [p, q]: [u32; 2], crowd: impl Fn(u32) -> f64) -> Option<Vec<u32>> {
    let (at_p, at_q) = (link.get(&p)?, link.get(&q)?);
    let between = at_p.intersection(at_q).copied().filter(|x| link.contains_key(x));
    if let Some(x) = between.min_by(|&x, &y| crowd(x).total_cmp(&crowd(y))) {
        return Some(vec![p, x, q]);
    }
    let mut from: BTreeMap<u32, u32> = BTreeMap::from([(p, p)]);
    let mut queue = VecDeque::from([p]);
    while let Some(x) = queue.pop_front() {
        for &y in link.get(&x).into_iter().flatten().filter(|y| link.contains_key(y)) {
            if let std::collections::btree_map::Entry::Vacant(entry) = from.entry(y) {
                entry.insert(x);
                queue.push_back(y);
            }
        }
    }
    let mut path = vec![q];
    let mut at = q;
    while at != p {
        at = *from.get(&at)?;
        path.push(at);
    }
    path.reverse();
    (path.len() > 2).then_some(path)
}

/// The vertices around one, in order: from one of `ends` to the other, or all around.
fn outline(next: &FxHashMap<u32, u32>, ends: Option<[u32; 2]>) -> Option<Vec<u32>> {
    let (start, last) = match ends {
        Some([p, q]) if next.contains_key(&p) => (p, q),
        Some([p, q]) => (q, p),
        None => next.keys().min().map(|&v| (v, v))?,
    };
    let mut polygon = vec![start];
    let mut at = *next.get(&start)?;
    while at != last {
        if polygon.len() > next.len() {
            return None;
        }
        polygon.push(at);
        at = *next.get(&at)?;
    }
    if ends.is_some() {
        polygon.push(last);
    }
    let faces = if ends.is_some() { polygon.len() - 1 } else { polygon.len() };
    (faces == next.len() && polygon.len() >= 3).then_some(polygon)
}

/// The faces that the vertex that takes the place of another has to see in one sector, counter-clockwise from there:
/// those of the star opposite to the vertex, and the new faces of fans. Nothing if a frozen face is none of the fans'.
pub(super) fn sectors(s: &Space, v: u32, star: &[u32], fans: &[Fan]) -> Option<Vec<Vec<[u32; 3]>>> {
    let mut of: FxHashMap<[u32; 3], (usize, [u32; 3])> = FxHashMap::default();
    for (k, fan) in fans.iter().enumerate() {
        of.extend(fan.old.iter().map(|&piece| (face_key(piece), (k, piece))));
    }
    let mut seen: FxHashSet<u32> = FxHashSet::default();
    let mut sectors = Vec::new();
    for &first in star {
        if !seen.insert(first) {
            continue;
        }
        let mut faces = Vec::new();
        // Per fan, whether the sector lies in front of it, behind it.
        let mut touched = vec![[false; 2]; fans.len()];
        let mut stack = vec![first];
        while let Some(t) = stack.pop() {
            for half in 4 * t..4 * t + 4 {
                let f = s.c.face(half);
                if s.c.apex(half) == v {
                    faces.push([f[0], f[2], f[1]]);
                } else if let Some(&(k, piece)) = of.get(&face_key(f)) {
                    // Seen from outside its tetrahedron the face runs as the facet: the sector lies behind.
                    touched[k][usize::from(same_turn(f, piece))] = true;
                } else if s.c.is_frozen(half) {
                    return None;
                } else {
                    let n = s.c.mate(half) >> 2;
                    if seen.insert(n) {
                        stack.push(n);
                    }
                }
            }
        }
        for (fan, touched) in fans.iter().zip(&touched) {
            if touched[0] {
                faces.extend(&fan.new);
            }
            if touched[1] {
                faces.extend(fan.new.iter().map(|&[a, b, c]| [a, c, b]));
            }
        }
        sectors.push(faces);
    }
    Some(sectors)
}

/// Whether two orders of the same three vertices have the same orientation.
fn same_turn(f: [u32; 3], g: [u32; 3]) -> bool {
    f == g || f == [g[1], g[2], g[0]] || f == [g[2], g[0], g[1]]
}
