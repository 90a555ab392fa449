//! Sectors of the star of a surface vertex, separated by its facets, and these facets without the vertex.

use super::kernel::Apex;
use super::polygon::{point_above, triangulate};
use super::space::Space;
use crate::complex::face_key;
use crate::error::TetError;
use rustc_hash::{FxHashMap, FxHashSet};

/// A facet around a vertex that lies on it: its faces at the vertex and their replacements.
pub(super) struct Fan {
    pub facet: u32,
    pub old: Vec<[u32; 3]>,
    pub new: Vec<[u32; 3]>,
}

impl Fan {
    /// Retriangulates a facet without vertex `v`, which lies between `ends` on a segment or inside the facet. Returns
    /// `None` if the faces do not form a simple polygon.
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
        Ok(simple.then_some(Self { facet, old, new }))
    }
}

/// Vertices around a vertex in order: from one of `ends` to the other, or all around.
pub(super) fn outline(next: &FxHashMap<u32, u32>, ends: Option<[u32; 2]>) -> Option<Vec<u32>> {
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

/// Faces that an apex in one sector has to see, counter-clockwise from the apex.
#[derive(Clone)]
pub(super) struct Sector {
    pub faces: Vec<[u32; 3]>,
    /// Half-faces of the sector's tetrahedra, for the first faces. The others are new faces of facets.
    pub halves: Vec<u32>,
}

/// Sectors around a vertex, bounded by the opposite faces of its star and the new faces of fans. Returns `None` if a
/// frozen face belongs to no fan.
pub(super) fn sectors(s: &Space, v: u32, star: &[u32], fans: &[Fan]) -> Option<Vec<Sector>> {
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
        let mut halves = Vec::new();
        // For each fan, true if the sector lies in front of it or behind it.
        let mut touched = vec![[false; 2]; fans.len()];
        let mut stack = vec![first];
        while let Some(t) = stack.pop() {
            for half in 4 * t..4 * t + 4 {
                let f = s.c.face(half);
                if s.c.apex(half) == v {
                    halves.push(half);
                } else if let Some(&(k, piece)) = of.get(&face_key(f)) {
                    // If the outward face has the orientation of the facet, the sector lies behind it.
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
        let mut faces: Vec<[u32; 3]> = halves.iter().map(|&half| s.wall(half)).collect();
        for (fan, touched) in fans.iter().zip(&touched) {
            if touched[0] {
                faces.extend(&fan.new);
            }
            if touched[1] {
                faces.extend(fan.new.iter().map(|&[a, b, c]| [a, c, b]));
            }
        }
        sectors.push(Sector { faces, halves });
    }
    Some(sectors)
}

/// Replaces a cavity by sectors, each joined to its apex. Freezes the new faces of facets and the frozen faces between
/// sectors. Returns the new tetrahedra; changes nothing if they do not fit.
pub(super) fn refill(
    s: &mut Space,
    cavity: &[u32],
    sectors: &[(Sector, Apex)],
    facets: &[[u32; 3]],
) -> Option<Vec<[u32; 4]>> {
    let walls = sectors.iter().flat_map(|(sector, _)| &sector.halves).filter(|&&half| s.c.is_frozen(half));
    let mut frozen: FxHashSet<[u32; 3]> = walls.map(|&half| face_key(s.c.face(half))).collect();
    frozen.extend(facets.iter().map(|&face| face_key(face)));
    let before = s.c.points.len();
    let mut new = Vec::new();
    for (sector, apex) in sectors {
        let apex = match *apex {
            Apex::Vertex(w) => w,
            Apex::Point(p) => s.add_point(p),
        };
        let faces = sector.faces.iter().filter(|f| !f.contains(&apex));
        new.extend(faces.map(|&[a, b, c]| [a, b, c, apex]));
    }
    let mut created = Vec::new();
    if !s.c.replace(cavity, &new, &mut created) {
        s.forget_points(before);
        return None;
    }
    for half in created.into_iter().flat_map(|t| 4 * t..4 * t + 4) {
        if frozen.contains(&face_key(s.c.face(half))) {
            s.c.freeze(half);
        }
    }
    Some(new)
}

/// True if two orders of the same vertices have the same orientation.
fn same_turn(f: [u32; 3], g: [u32; 3]) -> bool {
    f == g || f == [g[1], g[2], g[0]] || f == [g[2], g[0], g[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_is_one_chain_or_one_cycle() {
        let of = |next: &[(u32, u32)], ends| outline(&next.iter().copied().collect(), ends);
        assert_eq!(of(&[(3, 1), (1, 2), (2, 3)], None), Some(vec![1, 2, 3]));
        for ends in [[1, 4], [4, 1]] {
            assert_eq!(of(&[(1, 2), (2, 3), (3, 4)], Some(ends)), Some(vec![1, 2, 3, 4]));
        }
        assert_eq!(of(&[(1, 2), (2, 3)], Some([1, 3])), Some(vec![1, 2, 3]));
        // Too short, broken, divided, endless.
        assert_eq!(of(&[(1, 2)], Some([1, 2])), None);
        assert_eq!(of(&[(1, 2), (2, 1)], None), None);
        assert_eq!(of(&[(1, 2), (2, 5), (3, 1)], None), None);
        assert_eq!(of(&[(1, 2), (2, 3), (3, 1), (4, 5)], None), None);
        assert_eq!(of(&[(1, 2), (2, 3), (4, 5)], Some([1, 3])), None);
        assert_eq!(of(&[(1, 2), (2, 3), (3, 2)], None), None);
        assert_eq!(of(&[], None), None);
    }

    #[test]
    fn rotations_of_a_face_keep_its_orientation() {
        let same = |f: [u32; 3]| same_turn(f, [1, 2, 3]);
        assert_eq!([[1, 2, 3], [2, 3, 1], [3, 1, 2]].map(same), [true; 3]);
        assert_eq!([[1, 3, 2], [3, 2, 1], [2, 1, 3]].map(same), [false; 3]);
    }
}
