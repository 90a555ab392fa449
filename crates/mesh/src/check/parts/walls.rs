//! Test of walls of different parts against each other: boxes of parts, then boxes of faces, then exactly.
//!
//! Parts are visited along the Hilbert curve of their boxes, in batches of pairs whose walls fit in memory.

use super::boxes::Boxes;
use super::glue::{Held, invalid};
use super::{FacesApart, Parts};
use crate::check::result::Intersection;
use crate::geometry::{Aabb, Bvh, Contact, Improper, Point3, Triangle, classify_triangles};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use std::io;
use std::sync::Arc;

/// Parts whose neighbours are searched at a time.
const SEARCH_BATCH: usize = 512;

/// Bytes of a wall besides its faces.
const OVERHEAD: u64 = 200;

/// Bytes per face of a wall: three indices, half a point, half an id.
const PER_FACE: u64 = 12 + 14;

/// Maximum pairs of faces tested without a tree.
const FEW: usize = 1 << 13;

/// Wall of a part.
#[derive(Debug)]
pub(super) struct Wall {
    pub points: Vec<Point3>,
    /// Ids in the whole.
    pub ids: Vec<u32>,
    pub faces: Vec<[u32; 3]>,
    aabb: Aabb,
}

/// Walls in memory, by part.
pub(super) type Walls = FxHashMap<u32, Arc<Wall>>;

/// Reads walls and verifies that they are the certified ones.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a> {
    pub parts: &'a dyn Parts,
    pub held: &'a Held,
    pub is_joined: &'a [bool],
}

impl Reader<'_> {
    pub(super) fn wall(&self, part: u32) -> io::Result<Wall> {
        let piece = self.parts.wall(part)?;
        if !self.held.is_wall(part, self.is_joined, &piece) {
            return Err(invalid(format!("the wall of part {part} is not what was certified")));
        }
        Ok(Wall::of(piece))
    }

    fn bytes(&self, part: u32) -> u64 {
        OVERHEAD + PER_FACE * self.held.faces_of(part, self.is_joined)
    }
}

/// Improper intersections of walls of different parts.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Meetings {
    pub intersections: Vec<(Intersection, Point3)>,
    /// Edges common to both walls, outside joints.
    pub edges: Vec<([u32; 2], Point3)>,
    /// Points with different ids at one position.
    pub twins: Vec<([u32; 2], Point3)>,
    /// Pairs of parts with any of these.
    pub parts: Vec<[u32; 2]>,
}

impl Meetings {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    fn append(&mut self, mut other: Self) {
        self.intersections.append(&mut other.intersections);
        self.edges.append(&mut other.edges);
        self.twins.append(&mut other.twins);
        self.parts.append(&mut other.parts);
    }
}

/// Tests all walls against each other, with about `memory` bytes of them at a time.
pub(super) fn meetings(reader: Reader, boxes: &Boxes, memory: usize) -> io::Result<Meetings> {
    let mut all = Meetings::default();
    let mut walls: Walls = FxHashMap::default();
    for some in boxes.along_curve().chunks(SEARCH_BATCH) {
        let pairs: Vec<[u32; 2]> = some.par_iter().flat_map_iter(|&part| boxes.partners(part)).collect();
        let mut rest = &pairs[..];
        while !rest.is_empty() {
            let fits = fitting(&reader, rest, memory as u64);
            let (now, later) = rest.split_at(fits);
            load(|part| reader.wall(part), now, &mut walls)?;
            all.append(test(now, &walls));
            rest = later;
        }
    }
    Ok(all)
}

/// Number of pairs, at least one, whose walls fit in memory.
pub(super) fn fitting(reader: &Reader, pairs: &[[u32; 2]], memory: u64) -> usize {
    let mut needed: FxHashSet<u32> = FxHashSet::default();
    let mut bytes = 0;
    for (i, pair) in pairs.iter().enumerate() {
        for &part in pair {
            if needed.insert(part) {
                bytes += reader.bytes(part);
            }
        }
        if bytes > memory && i > 0 {
            return i;
        }
    }
    pairs.len()
}

/// Loads the missing walls of the pairs, and drops all others.
pub(super) fn load(
    read: impl Fn(u32) -> io::Result<Wall> + Sync,
    pairs: &[[u32; 2]],
    walls: &mut Walls,
) -> io::Result<()> {
    let mut needed: Vec<u32> = pairs.as_flattened().to_vec();
    needed.sort_unstable();
    needed.dedup();
    walls.retain(|part, _| needed.binary_search(part).is_ok());
    let missing: Vec<u32> = needed.into_iter().filter(|part| !walls.contains_key(part)).collect();
    let read = |&part: &u32| Ok((part, Arc::new(read(part)?)));
    walls.extend(missing.par_iter().map(read).collect::<io::Result<Vec<_>>>()?);
    Ok(())
}

/// Tests pairs of walls.
pub(super) fn test(pairs: &[[u32; 2]], walls: &Walls) -> Meetings {
    let test = |pair: &[u32; 2]| {
        // Independent of the order along the curve.
        let parts = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        let [Some(a), Some(b)] = parts.map(|part| walls.get(&part)) else { return None };
        let meetings = test_pair(a, b);
        (!meetings.is_empty()).then(|| Meetings { parts: vec![parts], ..meetings })
    };
    let found: Vec<Meetings> = pairs.par_iter().with_min_len(8).filter_map(test).collect();
    let mut all = Meetings::default();
    for meetings in found {
        all.append(meetings);
    }
    all
}

impl Wall {
    pub(super) fn of(FacesApart { points, vertices: ids, faces }: FacesApart) -> Self {
        Self { aabb: Aabb::of_points(&points), points, ids, faces }
    }

    fn triangle(&self, face: u32) -> Triangle<'_> {
        let corners = self.faces[face as usize];
        Triangle { ids: corners.map(|v| self.ids[v as usize]), corners: corners.map(|v| &self.points[v as usize]) }
    }

    /// Faces that may reach into a box, with their own boxes.
    fn faces_near(&self, aabb: &Aabb) -> Vec<(u32, Aabb)> {
        // One bit for each side of the box beyond which a point lies.
        let code = |p: &Point3| {
            (0..3).fold(0_u8, |code, i| {
                code | u8::from(p[i] < aabb.min[i]) << (2 * i) | u8::from(p[i] > aabb.max[i]) << (2 * i + 1)
            })
        };
        let codes: Vec<u8> = self.points.iter().map(code).collect();
        let mut near = Vec::new();
        for (f, &[a, b, c]) in (0..).zip(&self.faces) {
            if codes[a as usize] & codes[b as usize] & codes[c as usize] == 0 {
                near.push((f, Aabb::of_points(self.triangle(f).corners)));
            }
        }
        near
    }
}

fn test_pair(a: &Wall, b: &Wall) -> Meetings {
    let mut meetings = Meetings::default();
    let common = Aabb { min: a.aabb.min.sup(&b.aabb.min), max: a.aabb.max.inf(&b.aabb.max) };
    if !a.aabb.overlaps(&b.aabb) {
        return meetings;
    }
    let (first, second) = (a.faces_near(&common), b.faces_near(&common));
    for (i, j) in overlapping(&first, &second) {
        let (p, q) = (a.triangle(i), b.triangle(j));
        match classify_triangles(p, q) {
            // Faces without area are reported by their own part.
            Contact::Apart | Contact::Neighbours | Contact::Improper(Improper::Degenerate) => {}
            Contact::Improper(kind) => {
                let place = crate::check::cells::middle(p.corners.into_iter().chain(q.corners));
                meetings.intersections.push((Intersection { faces: [p.ids, q.ids], kind }, place));
                meetings.twins.extend(twins(p, q));
            }
        }
    }
    common_edges(a, &first, b, &second, &mut meetings.edges);
    meetings
}

/// Pairs of faces with overlapping boxes, ascending.
fn overlapping(first: &[(u32, Aabb)], second: &[(u32, Aabb)]) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    if first.len() * second.len() <= FEW {
        for (i, p) in first {
            pairs.extend(second.iter().filter(|(_, q)| p.overlaps(q)).map(|(j, _)| (*i, *j)));
        }
    } else {
        let boxes = |faces: &[(u32, Aabb)]| faces.iter().map(|(_, aabb)| *aabb).collect::<Vec<_>>();
        let (p, q) = (Bvh::new(&boxes(first)), Bvh::new(&boxes(second)));
        p.pairs(&q, |i, j| pairs.push((first[i as usize].0, second[j as usize].0)));
        pairs.sort_unstable();
    }
    pairs
}

/// Vertices with different ids at one position.
fn twins(p: Triangle, q: Triangle) -> Vec<([u32; 2], Point3)> {
    let mut found = Vec::new();
    for (i, a) in p.ids.into_iter().zip(p.corners) {
        for (j, b) in q.ids.into_iter().zip(q.corners) {
            if i != j && a == b {
                found.push(([i.min(j), i.max(j)], *a));
            }
        }
    }
    found
}

/// Finds edges common to both walls. The rim of a joint has one face of either; an edge with more is no rim.
fn common_edges(
    a: &Wall,
    first: &[(u32, Aabb)],
    b: &Wall,
    second: &[(u32, Aabb)],
    found: &mut Vec<([u32; 2], Point3)>,
) {
    let mut ids: Vec<u32> = first.iter().flat_map(|(f, _)| a.triangle(*f).ids).collect();
    ids.sort_unstable();
    ids.dedup();
    let is_common = |v: u32| ids.binary_search(&v).is_ok();
    let mut edges: Vec<([u32; 2], bool, Point3)> = Vec::new();
    let mut rim: Vec<u32> = Vec::new();
    for (f, _) in second {
        rim.extend(b.triangle(*f).ids.into_iter().filter(|&v| is_common(v)));
    }
    if rim.len() < 2 {
        return;
    }
    rim.sort_unstable();
    for (wall, faces, is_first) in [(a, first, true), (b, second, false)] {
        for (f, _) in faces {
            let t = wall.triangle(*f);
            for i in 0..3 {
                let (v, w) = (t.ids[i], t.ids[(i + 1) % 3]);
                if [v, w].iter().all(|v| rim.binary_search(v).is_ok()) {
                    edges.push(([v.min(w), v.max(w)], is_first, *t.corners[i]));
                }
            }
        }
    }
    edges.sort_by_key(|edge| (edge.0, edge.1));
    for run in edges.chunk_by(|x, y| x.0 == y.0) {
        let is_shared = run[0].1 != run[run.len() - 1].1;
        if is_shared && run.len() > 2 {
            found.push((run[0].0, run[0].2));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(ids: &[u32], faces: &[[u32; 3]], z: f64) -> Wall {
        // The first two points are those of a common edge.
        let at = |i: usize| match i {
            0 | 1 => Point3::new(i as f64, 0.0, 0.0),
            _ => Point3::new(0.5, i as f64 - 2.5, z),
        };
        let points: Vec<Point3> = (0..ids.len()).map(at).collect();
        Wall { aabb: Aabb::of_points(&points), points, ids: ids.to_vec(), faces: faces.to_vec() }
    }

    #[test]
    fn an_edge_that_both_walls_have_is_a_rim_or_a_fault() {
        let rim = test_pair(&wall(&[7, 9, 1], &[[0, 1, 2]], 1.0), &wall(&[7, 9, 2], &[[1, 0, 2]], -1.0));
        assert_eq!(rim, Meetings::default());
        let two = [[0, 1, 2], [1, 0, 3]];
        let chord = test_pair(&wall(&[7, 9, 1, 2], &two, 1.0), &wall(&[7, 9, 3, 4], &two, -1.0));
        assert_eq!(chord.edges.iter().map(|edge| edge.0).collect::<Vec<_>>(), [[7, 9]]);
        assert!(chord.intersections.is_empty() && chord.twins.is_empty());
        // Without common ids, the edges coincide geometrically.
        let apart = test_pair(&wall(&[7, 9, 1, 2], &two, 1.0), &wall(&[17, 19, 3, 4], &two, -1.0));
        assert_eq!((apart.edges.len(), apart.intersections.len(), apart.twins.len()), (0, 4, 8));
    }

    #[test]
    fn an_edge_with_two_faces_in_one_wall_and_one_in_the_other_is_no_rim() {
        let two = wall(&[7, 9, 1, 2], &[[0, 1, 2], [1, 0, 3]], 1.0);
        let one = wall(&[7, 9, 3], &[[0, 1, 2]], -1.0);
        for (a, b) in [(&two, &one), (&one, &two)] {
            assert_eq!(test_pair(a, b).edges.iter().map(|edge| edge.0).collect::<Vec<_>>(), [[7, 9]]);
        }
    }

    #[test]
    fn faces_beyond_a_side_of_a_box_are_not_near_it() {
        let aabb = Aabb { min: Point3::new(0.0, 0.0, 0.0), max: Point3::new(1.0, 1.0, 1.0) };
        let near = |corners: [[f64; 3]; 3]| {
            let points = corners.map(Point3::from).to_vec();
            let wall = Wall { aabb: Aabb::of_points(&points), points, ids: vec![4, 5, 6], faces: vec![[0, 1, 2]] };
            !wall.faces_near(&aabb).is_empty()
        };
        for axis in 0..3 {
            // On either side, and on the side itself.
            for (x, is_near) in [(-0.1, false), (0.0, true), (0.5, true), (1.0, true), (1.1, false)] {
                let at = |y: f64, z: f64| {
                    let mut corner = [x; 3];
                    (corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (y, z);
                    corner
                };
                assert_eq!(near([at(0.2, 0.2), at(0.8, 0.2), at(0.2, 0.8)]), is_near, "{axis} {x}");
                // Corners beyond all other sides.
                assert_eq!(near([at(-3.0, -3.0), at(5.0, -3.0), at(0.5, 5.0)]), is_near, "{axis} {x}");
            }
        }
        // Corners beyond different sides.
        assert!(near([[-0.5, 0.5, 0.5], [1.5, 0.5, 0.5], [0.5, 1.5, 0.5]]));
    }

    #[test]
    fn large_walls_have_the_pairs_of_small_ones() {
        // 100 boxes along x, and 100 that each overlap at most one of them.
        let list = |shift: f64| -> Vec<(u32, Aabb)> {
            let at = |i: u32| Aabb {
                min: Point3::new(f64::from(i) + shift, 0.0, 0.0),
                max: Point3::new(f64::from(i) + shift + 0.5, 1.0, 1.0),
            };
            (0..100).map(|i| (3 * i, at(i))).collect()
        };
        let (first, second) = (list(0.0), list(-0.7));
        assert!(first.len() * second.len() > FEW);
        // Box i of the second reaches from i - 0.7 to i - 0.2, and box i - 1 of the first to i - 0.5.
        let expected: Vec<(u32, u32)> = (0..99).map(|i| (3 * i, 3 * (i + 1))).collect();
        assert_eq!(overlapping(&first, &second), expected);
        assert_eq!(overlapping(&first[..50], &second[..50]), expected[..49]);
    }
}
