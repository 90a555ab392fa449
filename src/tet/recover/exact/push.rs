//! Vertices on segments are moved off them, one copy into each of the sectors between the facets that meet there
//! (George, Borouchaki, Saltel, 'Ultimate robustness in meshing an arbitrary polyhedron', 2003). Positions are floating
//! point and proved by exact predicates.

use super::facets::Facets;
use super::polygon::{point_above, triangulate};
use super::room::deepest;
use super::segments::{Segments, stuck};
use super::space::Space;
use crate::geometry::{Point3, Vec3};
use crate::tet::complex::face_key;
use crate::tet::error::{Stuck, TetError};
use crate::tet::star::Star;
use rustc_hash::{FxHashMap, FxHashSet};

/// Shares of the way from the segment to the deepest point of the room at which a position is looked for.
const SHARES: [f64; 9] = [1.0, 0.7, 0.5, 0.3, 0.15, 0.05, 0.01, 1e-3, 1e-4];

/// Least distances from the planes around, over the size of the room, that are asked for one after the other.
const LEVELS: [f64; 6] = [1e-2, 1e-3, 1e-5, 1e-8, 1e-11, 0.0];

/// What is left of a facet around a vertex on its side: the outline without the vertex, and its triangulation.
struct Fan {
    facet: u32,
    new: Vec<[u32; 3]>,
}

/// A sector of the star: its tetrahedra's faces opposite the vertex and the new faces, seen counter-clockwise from it.
struct Sector {
    faces: Vec<[u32; 3]>,
    apex: Apex,
}

/// What takes the place of the vertex in a sector.
#[derive(Clone, Copy, Debug)]
enum Apex {
    /// One of the vertices around it.
    Vertex(u32),
    /// A new one.
    Point(Point3),
}

pub(super) struct Push<'a> {
    pub s: &'a mut Space,
    pub segments: &'a mut Segments,
    pub facets: &'a mut Facets,
    pub triangles: &'a [[u32; 3]],
    /// Facets at each segment that has vertices.
    around: FxHashMap<u32, Vec<u32>>,
    star: Star,
    /// Vertices that are free now.
    pub free: Vec<u32>,
    changes: Changes,
}

/// When the stars of vertices changed, and when they were looked at last without success.
#[derive(Default)]
struct Changes {
    now: u32,
    changed: Vec<u32>,
    looked: Vec<[u32; 3]>,
}

/// What stars are looked at for.
#[derive(Clone, Copy)]
enum Look {
    Neighbor,
    Point,
    Relax,
}

impl Changes {
    /// Whether a look at this vertex may find something new; it is taken to happen.
    fn worth(&mut self, v: u32, look: Look) -> bool {
        let v = v as usize;
        if self.changed.len() <= v {
            self.changed.resize(v + 1, 0);
            self.looked.resize(v + 1, [0; 3]);
        }
        let last = &mut self.looked[v][look as usize];
        let worth = *last <= self.changed[v];
        *last = self.now + 1;
        worth
    }

    /// The stars of all corners of some faces change.
    fn change(&mut self, faces: impl Iterator<Item = u32>) {
        self.now += 1;
        for v in faces {
            let v = v as usize;
            if self.changed.len() <= v {
                self.changed.resize(v + 1, 0);
                self.looked.resize(v + 1, [0; 3]);
            }
            self.changed[v] = self.now;
        }
    }

    /// Other levels are other looks.
    fn forget(&mut self) {
        self.looked.fill([0; 3]);
    }
}

impl<'a> Push<'a> {
    pub(super) fn new(
        s: &'a mut Space,
        segments: &'a mut Segments,
        facets: &'a mut Facets,
        triangles: &'a [[u32; 3]],
    ) -> Self {
        let mut around: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for (t, id) in triangles.iter().zip(0..) {
            for k in 0..3 {
                if let Some(i) = segments.between(t[k], t[(k + 1) % 3])
                    && segments.list[i as usize].chain.len() > 2
                {
                    around.entry(i).or_default().push(id);
                }
            }
        }
        Self {
            s,
            segments,
            facets,
            triangles,
            around,
            star: Star::default(),
            free: Vec::new(),
            changes: Changes::default(),
        }
    }

    /// Pushes all vertices off their segments. Those that have no room are tried again when others have gone; little
    /// room is taken only when there is no better, since it leaves even less to others.
    pub(super) fn all(&mut self) -> Result<(), TetError> {
        let mut left: Vec<(u32, u32)> = Vec::new();
        for (i, segment) in self.segments.list.iter().enumerate() {
            let n = segment.chain.len();
            left.extend(segment.chain.get(1..n - 1).unwrap_or(&[]).iter().map(|&v| (i as u32, v)));
        }
        let mut level = 0;
        while let Some(&least) = LEVELS.get(level) {
            let before = left.len();
            // Vertices that go without a trace give room to the others, so they come first.
            self.pass(&mut left, least, false)?;
            if left.len() == before {
                self.relax(least);
                self.pass(&mut left, least, true)?;
            }
            if left.is_empty() {
                self.changes.forget();
                self.relax(0.0);
                return Ok(());
            }
            if left.len() == before {
                level += 1;
                self.changes.forget();
            }
        }
        let ends = self.segments.list[left[0].0 as usize].ends;
        Err(stuck(ends, Stuck::Precision))
    }

    fn pass(&mut self, left: &mut Vec<(u32, u32)>, least: f64, new_points: bool) -> Result<(), TetError> {
        let mut again = Vec::with_capacity(left.len());
        for &(segment, v) in left.iter() {
            let look = if new_points { Look::Point } else { Look::Neighbor };
            if !self.changes.worth(v, look) || !self.push(segment, v, least, new_points)? {
                again.push((segment, v));
            }
        }
        *left = again;
        Ok(())
    }

    /// Removes free vertices that are not needed, and moves the others to where they have most room.
    fn relax(&mut self, least: f64) {
        let mut free = std::mem::take(&mut self.free);
        free.retain(|&v| {
            if !self.changes.worth(v, Look::Relax) {
                return true;
            }
            let star: Vec<u32> = self.star.around(&self.s.c, v).to_vec();
            let mut faces = Vec::with_capacity(star.len());
            for &t in &star {
                if let Some(i) = self.s.c.slot_of(t, v) {
                    let [a, b, c] = self.s.c.face(4 * t + i as u32);
                    faces.push([a, c, b]);
                }
            }
            let room = Room::new(self.s, v, &faces);
            if let Some(w) = room.neighbor(self.s, least) {
                let others = faces.iter().filter(|f| !f.contains(&w));
                let new: Vec<[u32; 4]> = others.map(|&[a, b, c]| [a, b, c, w]).collect();
                if self.s.c.replace(&star, &new, &mut Vec::new()) {
                    self.changes.change(faces.iter().flatten().copied());
                    return false;
                }
            }
            let here = room.depth(&Vec3::zeros(), None);
            if let Some(p) = room.place(self.s, 1.2 * here) {
                self.s.c.points[v as usize] = p;
                self.changes.change(faces.iter().flatten().copied());
            }
            true
        });
        self.free = free;
    }

    fn push(&mut self, segment: u32, v: u32, least: f64, new_points: bool) -> Result<bool, TetError> {
        let ends = self.segments.list[segment as usize].ends;
        let chain = &self.segments.list[segment as usize].chain;
        let Some(at) = chain.iter().position(|&x| x == v) else { return Ok(true) };
        let neighbors = [chain[at - 1], chain[at + 1]];
        let facets = self.around.get(&segment).cloned().unwrap_or_default();
        if facets.len() < 2 {
            return Err(stuck(ends, Stuck::Dangling));
        }
        let mut fans = Vec::new();
        for facet in facets {
            fans.push(self.fan(facet, v, neighbors)?.ok_or_else(|| stuck(ends, Stuck::Intersection))?);
        }
        let star: Vec<u32> = self.star.around(&self.s.c, v).to_vec();
        let Some(mut sectors) = self.sectors(v, &star, &fans) else {
            return Err(stuck(ends, Stuck::Intersection));
        };
        for sector in &mut sectors {
            let room = Room::new(self.s, v, &sector.faces);
            sector.apex = match room.neighbor(self.s, least) {
                Some(w) => Apex::Vertex(w),
                None if new_points => match room.place(self.s, least * room.size) {
                    Some(p) => Apex::Point(p),
                    None => return Ok(false),
                },
                None => return Ok(false),
            };
        }
        self.commit(segment, v, &star, &fans, &sectors).ok_or_else(|| stuck(ends, Stuck::Intersection))?;
        Ok(true)
    }

    /// The facet without the vertex.
    fn fan(&self, facet: u32, v: u32, [p, q]: [u32; 2]) -> Result<Option<Fan>, TetError> {
        let triangle = self.triangles[facet as usize];
        let mut next: FxHashMap<u32, u32> = FxHashMap::default();
        for f in self.facets.pieces.get(&facet).into_iter().flatten() {
            if let Some(k) = f.iter().position(|&x| x == v) {
                next.insert(f[(k + 1) % 3], f[(k + 2) % 3]);
            }
        }
        let start = if next.contains_key(&p) { p } else { q };
        let mut polygon = vec![start];
        let mut at = start;
        while let Some(&x) = next.get(&at) {
            if polygon.len() > next.len() {
                return Ok(None);
            }
            polygon.push(x);
            at = x;
        }
        if polygon.len() != next.len() + 1 || polygon.len() < 3 || at != p + q - start {
            return Ok(None);
        }
        let above = point_above(self.s, triangle)?;
        let mut new = Vec::new();
        Ok(triangulate(self.s, &polygon, &above, &mut new).then_some(Fan { facet, new }))
    }

    /// The sectors of a star; nothing if a frozen face is none of the fans'.
    fn sectors(&self, v: u32, star: &[u32], fans: &[Fan]) -> Option<Vec<Sector>> {
        let mut of: FxHashMap<[u32; 3], (usize, [u32; 3])> = FxHashMap::default();
        for (k, fan) in fans.iter().enumerate() {
            for &piece in &self.facets.pieces[&fan.facet] {
                if piece.contains(&v) {
                    of.insert(face_key(piece), (k, piece));
                }
            }
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
                    let f = self.s.c.face(half);
                    if self.s.c.apex(half) == v {
                        faces.push([f[0], f[2], f[1]]);
                    } else if !self.s.c.is_frozen(half) {
                        let n = self.s.c.mate(half) >> 2;
                        if seen.insert(n) {
                            stack.push(n);
                        }
                    } else {
                        let &(k, piece) = of.get(&face_key(f))?;
                        // Seen from outside its tetrahedron the face runs as the facet: the sector lies behind.
                        touched[k][usize::from(same_turn(f, piece))] = true;
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
            sectors.push(Sector { faces, apex: Apex::Vertex(v) });
        }
        Some(sectors)
    }

    fn commit(&mut self, segment: u32, v: u32, star: &[u32], fans: &[Fan], sectors: &[Sector]) -> Option<()> {
        let mut new = Vec::new();
        let mut copies = Vec::new();
        for sector in sectors {
            let apex = match sector.apex {
                Apex::Vertex(w) => w,
                Apex::Point(p) => {
                    copies.push(self.s.add_point(p));
                    copies[copies.len() - 1]
                }
            };
            let faces = sector.faces.iter().filter(|f| !f.contains(&apex));
            new.extend(faces.map(|&[a, b, c]| [a, b, c, apex]));
        }
        let mut created = Vec::new();
        if !self.s.c.replace(star, &new, &mut created) {
            return None;
        }
        self.changes.change(new.iter().flatten().copied());
        let faces: FxHashSet<[u32; 3]> = fans.iter().flat_map(|f| f.new.iter().map(|&t| face_key(t))).collect();
        for half in created.iter().flat_map(|&t| 4 * t..4 * t + 4) {
            if faces.contains(&face_key(self.s.c.face(half))) {
                self.s.c.freeze(half);
            }
        }
        for fan in fans {
            let pieces = self.facets.pieces.get_mut(&fan.facet)?;
            pieces.retain(|f| !f.contains(&v));
            pieces.extend(&fan.new);
        }
        self.segments.list[segment as usize].chain.retain(|&x| x != v);
        self.free.extend(copies);
        Some(())
    }
}

/// The room that some faces leave for a vertex that has to see all of them counter-clockwise, in coordinates relative
/// to where it was.
struct Room<'a> {
    origin: Point3,
    faces: &'a [[u32; 3]],
    /// Unit normal towards the room and height of the origin, per face.
    planes: Vec<(Vec3, f64)>,
    /// Largest distance of a corner.
    size: f64,
}

impl<'a> Room<'a> {
    fn new(s: &Space, v: u32, faces: &'a [[u32; 3]]) -> Self {
        let origin = *s.point(v);
        let mut planes = Vec::with_capacity(faces.len());
        let mut size = 0.0_f64;
        for f in faces {
            let [a, b, c] = f.map(|x| s.point(x) - origin);
            size = size.max(a.norm()).max(b.norm()).max(c.norm());
            let n = normal(a, b, c);
            planes.push((n, -n.dot(&a)));
        }
        Self { origin, faces, planes, size }
    }

    /// Least distance from the planes of the faces, but for those that have vertex `without`.
    fn depth(&self, x: &Vec3, without: Option<u32>) -> f64 {
        let counts = self.planes.iter().zip(self.faces).filter(|(_, f)| without.is_none_or(|w| !f.contains(&w)));
        counts.map(|((n, h), _)| n.dot(x) + h).fold(f64::INFINITY, f64::min)
    }

    /// The corner that sees all faces that do not have it, the one furthest from their planes; at least `least` times
    /// the size.
    fn neighbor(&self, s: &Space, least: f64) -> Option<u32> {
        let mut rim: Vec<u32> = self.faces.iter().flatten().copied().collect();
        rim.sort_unstable();
        rim.dedup();
        let depth = |w: u32| self.depth(&(s.point(w) - self.origin), Some(w));
        let mut rim: Vec<(f64, u32)> = rim.into_iter().map(|w| (depth(w), w)).collect();
        rim.retain(|&(d, _)| d > least * self.size - 1e-14 * self.size);
        rim.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let sees = |w: u32| self.faces.iter().all(|&[a, b, c]| [a, b, c].contains(&w) || s.orient([a, b, c, w]) > 0);
        rim.into_iter().map(|(_, w)| w).find(|&w| sees(w))
    }

    /// A point that sees all faces, from a distance of at least `least`.
    fn place(&self, s: &Space, least: f64) -> Option<Point3> {
        let (aim, depth) = deepest(&self.planes, self.size)?;
        if depth < least {
            return None;
        }
        let sees = |p: &Point3| self.faces.iter().all(|f| s.orient_to(*f, p) > 0);
        SHARES.iter().map(|share| self.origin + aim * *share).find(sees)
    }
}

fn normal(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    // Of the two shorter sides: less roundoff where the triangle is a needle.
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let [x, y, z] = [ab, bc, ca].map(|v| v.norm_squared());
    let n = if x >= y && x >= z {
        bc.cross(&ca)
    } else if y >= z {
        ca.cross(&ab)
    } else {
        ab.cross(&bc)
    };
    n.try_normalize(0.0).unwrap_or(Vec3::zeros())
}

/// Whether two orders of the same three vertices have the same orientation.
fn same_turn(f: [u32; 3], g: [u32; 3]) -> bool {
    f == g || f == [g[1], g[2], g[0]] || f == [g[2], g[0], g[1]]
}
