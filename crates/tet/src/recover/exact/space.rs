//! A complex with implicit vertices, and exact predicates on its vertices.

use crate::complex::{Complex, NONE};
use crate::star::{EdgeRing, Star};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::implicit::{self, OnTriangle, Site};
use anastomesh_mesh::geometry::predicates;
use std::cell::Cell;
use std::cmp::Ordering;

/// Maximum tetrahedra of a cavity that is searched without sorting.
const SMALL: usize = 16;

/// Work of a predicate with implicit points.
const IMPLICIT: usize = 4;

/// A complex that stores implicit points by their rounded coordinates.
#[derive(Clone)]
pub(super) struct Space {
    pub c: Complex,
    /// Maximum thickness that counts as flat.
    pub flat: f64,
    /// Exact definitions of the implicit points.
    on: Vec<OnTriangle>,
    /// Index in `on` of each vertex, or [`NONE`].
    place: Vec<u32>,
    created: Vec<u32>,
    star: Star,
    /// Former definitions of points moved since [`Space::record`].
    moved: Vec<(usize, OnTriangle)>,
    /// Work since the last call of [`Space::take_work`].
    work: Cell<usize>,
}

/// State to which [`Space::undo`] returns.
pub(super) struct Mark {
    points: usize,
    implicit: usize,
}

impl Space {
    pub(super) fn new(c: Complex, flat: f64) -> Self {
        let place = vec![NONE; c.points.len()];
        Self {
            c,
            flat,
            on: Vec::new(),
            place,
            created: Vec::new(),
            star: Star::default(),
            moved: Vec::new(),
            work: Cell::new(0),
        }
    }

    /// Counts work, in units of one exact predicate on given points.
    #[inline]
    pub(super) fn count(&self, work: usize) {
        self.work.set(self.work.get() + work);
    }

    /// Returns the work counted since the last call.
    pub(super) fn take_work(&self) -> usize {
        self.work.take()
    }

    /// Records all changes until [`Space::keep`] or [`Space::undo`].
    pub(super) fn record(&mut self) -> Mark {
        self.c.record();
        self.moved.clear();
        Mark { points: self.place.len(), implicit: self.on.len() }
    }

    /// Keeps the recorded changes.
    pub(super) fn keep(&mut self) {
        self.c.keep_changes();
    }

    /// Takes back the recorded changes.
    pub(super) fn undo(&mut self, mark: &Mark) {
        for (place, on) in self.moved.drain(..).rev() {
            self.on[place] = on;
        }
        self.on.truncate(mark.implicit);
        self.place.truncate(mark.points);
        self.c.undo_changes();
    }

    /// Tetrahedra at a vertex.
    pub(super) fn star(&mut self, v: u32) -> Vec<u32> {
        self.star.around(&self.c, v).to_vec()
    }

    /// Ring of tetrahedra around an interior edge.
    pub(super) fn ring(&mut self, a: u32, b: u32) -> Option<EdgeRing> {
        let t = self.star.find_edge(&self.c, a, b)?;
        let mut ring = EdgeRing::default();
        (ring.collect(&self.c, t, a, b, usize::MAX) && !ring.touches_ghost()).then_some(ring)
    }

    pub(super) fn has_edge(&mut self, a: u32, b: u32) -> bool {
        self.star.find_edge(&self.c, a, b).is_some()
    }

    /// Half-face with three given vertices.
    pub(super) fn find_face(&mut self, face: [u32; 3]) -> Option<u32> {
        self.star.find_face(&self.c, face)
    }

    #[inline]
    pub(super) fn point(&self, v: u32) -> &Point3 {
        &self.c.points[v as usize]
    }

    #[inline]
    pub(super) fn site(&self, v: u32) -> Site<'_> {
        Site { at: self.point(v), on: self.on.get(self.place[v as usize] as usize) }
    }

    #[inline]
    pub(super) fn is_implicit(&self, v: u32) -> bool {
        self.place[v as usize] != NONE
    }

    /// Number of implicit vertices made.
    pub(super) fn implicit_vertices(&self) -> usize {
        self.on.len()
    }

    /// Adds a vertex without a tetrahedron.
    pub(super) fn add_point(&mut self, p: Point3) -> u32 {
        self.place.push(NONE);
        self.c.add_point(p)
    }

    /// Removes the last points, which have no tetrahedra, until `count` are left.
    pub(super) fn forget_points(&mut self, count: usize) {
        while self.c.points.len() > count {
            self.c.pop_point();
            self.place.pop();
        }
    }

    /// Replaces `cavity` by a new vertex joined to all its faces, which are counter-clockwise seen from inside. Changes
    /// nothing if they do not fit.
    pub(super) fn fill(&mut self, cavity: &[u32], walls: &[[u32; 3]], p: Point3) -> Option<u32> {
        let v = self.add_point(p);
        let new: Vec<[u32; 4]> = walls.iter().map(|&[a, b, c]| [a, b, c, v]).collect();
        if self.c.replace(cavity, &new, &mut self.created) {
            return Some(v);
        }
        self.forget_points(v as usize);
        None
    }

    /// Replaces `cavity` by an implicit vertex. Changes nothing unless the vertex sees all faces.
    pub(super) fn insert(&mut self, cavity: &[u32], walls: &[[u32; 3]], on: OnTriangle) -> Option<u32> {
        let at = on.rounded();
        let site = Site { at: &at, on: Some(&on) };
        let sees = |&[a, b, c]: &[u32; 3]| implicit::orient3d([self.site(a), self.site(c), self.site(b), site]) > 0;
        if !walls.iter().all(sees) {
            return None;
        }
        self.count(IMPLICIT * walls.len());
        let v = self.c.add_point(at);
        self.place.push(self.on.len() as u32);
        self.on.push(on);
        let new: Vec<[u32; 4]> = walls.iter().map(|&[a, b, c]| [a, c, b, v]).collect();
        let fits = self.c.replace(cavity, &new, &mut self.created);
        debug_assert!(fits, "the walls are those of the cavity");
        fits.then_some(v)
    }

    /// Inserts a vertex into the tetrahedron that strictly contains it. Returns `None` if there is none.
    pub(super) fn insert_point(&mut self, p: Point3) -> Option<u32> {
        let inside = |t: u32| (4 * t..4 * t + 4).all(|half| self.orient_to(self.c.face(half), &p) < 0);
        let t = self.c.real_tets().find(|&t| inside(t))?;
        let walls: Vec<[u32; 3]> = self.outer(&[t]).into_iter().map(|half| self.wall(half)).collect();
        self.fill(&[t], &walls, p)
    }

    /// Moves an implicit vertex along its segment or facet. Changes nothing unless it still sees all faces of its star.
    pub(super) fn move_to(&mut self, v: u32, walls: &[[u32; 3]], on: OnTriangle) -> bool {
        let at = on.rounded();
        let site = Site { at: &at, on: Some(&on) };
        let sees = |&[a, b, c]: &[u32; 3]| implicit::orient3d([self.site(a), self.site(c), self.site(b), site]) > 0;
        let Some(place) = self.on.get(self.place[v as usize] as usize).filter(|_| walls.iter().all(sees)) else {
            return false;
        };
        if *place == on {
            return false;
        }
        let place = self.place[v as usize] as usize;
        self.moved.push((place, std::mem::replace(&mut self.on[place], on)));
        self.c.move_point(v, at);
        true
    }

    /// Joins all faces of `cavity` to one of its vertices, if that vertex sees them.
    pub(super) fn join(&mut self, cavity: &[u32], walls: &[[u32; 3]], apex: u32) -> bool {
        let others = walls.iter().filter(|f| !f.contains(&apex));
        let new: Vec<[u32; 4]> = others.map(|&[a, b, c]| [a, c, b, apex]).collect();
        new.iter().all(|&tet| self.orient(tet) > 0) && self.c.replace(cavity, &new, &mut self.created)
    }

    /// Half-faces of the given tetrahedra with their mate outside.
    pub(super) fn outer(&self, cavity: &[u32]) -> Vec<u32> {
        self.count(cavity.len());
        let halves = cavity.iter().flat_map(|&t| 4 * t..4 * t + 4);
        if cavity.len() <= SMALL {
            return halves.filter(|&half| !cavity.contains(&(self.c.mate(half) >> 2))).collect();
        }
        let mut sorted = cavity.to_vec();
        sorted.sort_unstable();
        halves.filter(|&half| sorted.binary_search(&(self.c.mate(half) >> 2)).is_err()).collect()
    }

    /// Faces around the given tetrahedra, counter-clockwise seen from outside.
    pub(super) fn walls(&self, cavity: &[u32]) -> Vec<[u32; 3]> {
        self.outer(cavity).into_iter().map(|half| self.c.face(half)).collect()
    }

    /// Vertices of a half-face, counter-clockwise seen from inside the cavity with its tetrahedron.
    pub(super) fn wall(&self, half: u32) -> [u32; 3] {
        let [a, b, c] = self.c.face(half);
        [a, c, b]
    }

    /// Exact sign of the orientation of four vertices.
    #[inline]
    pub(super) fn orient(&self, v: [u32; 4]) -> i32 {
        if v.iter().any(|&x| self.is_implicit(x)) {
            self.count(IMPLICIT);
            return implicit::orient3d(v.map(|x| self.site(x)));
        }
        self.count(1);
        let [a, b, c, d] = v.map(|x| self.point(x));
        let o = predicates::orient3d(a, b, c, d);
        i32::from(o > 0.0) - i32::from(o < 0.0)
    }

    /// Exact sign of the orientation of three vertices and a point.
    #[inline]
    pub(super) fn orient_to(&self, [a, b, c]: [u32; 3], p: &Point3) -> i32 {
        self.count(IMPLICIT);
        implicit::orient3d([self.site(a), self.site(b), self.site(c), Site { at: p, on: None }])
    }

    /// Exact lexicographic comparison of two vertices.
    pub(super) fn compare(&self, v: u32, w: u32) -> Ordering {
        implicit::compare(self.site(v), self.site(w))
    }

    /// Points without tetrahedra. For tests.
    #[cfg(test)]
    pub(super) fn of_points<const N: usize>(points: [[f64; 3]; N]) -> Self {
        Self::new(Complex::new(points.map(Point3::from).to_vec()), 0.0)
    }

    /// Asserts that all tetrahedra are positive, with exact implicit points. For tests.
    #[cfg(test)]
    pub(super) fn check(&self) {
        if self.c.slots() > 50_000 {
            return;
        }
        for t in self.c.real_tets() {
            assert!(self.orient(self.c.verts(t)) > 0, "tetrahedron {t} is not positive");
        }
        for t in (0..self.c.slots() as u32).filter(|&t| self.c.is_alive(t)) {
            for i in 0..4 {
                let half = 4 * t + i;
                let mate = self.c.mate(half);
                assert_eq!(self.c.mate(mate), half);
                assert_eq!(self.c.is_frozen(mate), self.c.is_frozen(half));
                assert!(crate::complex::opposed(self.c.face(half), self.c.face(mate)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tetrahedra with a common face. Vertices 0, 1, 3 and 4 lie in a plane.
    fn pair() -> Space {
        let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 4.0, 0.0], [1.0, 0.0, 2.0], [1.0, 0.0, -2.0]];
        let points = points.map(Point3::from).to_vec();
        Space::new(Complex::from_mesh(points, &[[0, 1, 2, 3], [1, 0, 2, 4]]).expect("positive tetrahedra"), 0.0)
    }

    #[test]
    fn a_cavity_is_joined_only_to_a_vertex_off_the_planes_of_its_faces() {
        for (apex, expected) in [(0, true), (1, true), (2, true), (3, false), (4, false)] {
            let mut s = pair();
            let cavity: Vec<u32> = s.c.real_tets().collect();
            let walls = s.walls(&cavity);
            assert_eq!(s.join(&cavity, &walls, apex), expected, "{apex}");
            s.check();
        }
    }

    #[test]
    fn a_vertex_that_does_not_fit_is_forgotten() {
        let mut s = pair();
        let cavity: Vec<u32> = s.c.real_tets().collect();
        let walls: Vec<[u32; 3]> = s.outer(&cavity).into_iter().map(|half| s.wall(half)).collect();
        let at = Point3::new(1.5, 1.0, 0.0);
        // A face is missing.
        assert_eq!((s.fill(&cavity, &walls[1..], at), s.c.points.len()), (None, 5));
        assert_eq!((s.fill(&cavity, &walls, at), s.c.points.len()), (Some(5), 6));
        assert!(!s.is_implicit(5));
        s.check();
    }

    #[test]
    fn points_are_inserted_strictly_inside_a_tetrahedron() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]].map(Point3::from);
        let insert = |p: [f64; 3]| {
            let c = crate::delaunay::delaunay(&corners).unwrap();
            let mut s = Space::new(c, 0.0);
            let v = s.insert_point(Point3::from(p));
            s.check();
            (v, s.c.real_tets().count(), s.c.points.len())
        };
        assert_eq!(insert([0.5, 1.0, 1.5]), (Some(4), 4, 5));
        // On a face, on an edge, outside.
        for p in [[1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [2.0, 1.0, 1.0], [2.0, 0.0, 0.0], [4.0, 4.0, 4.0]] {
            assert_eq!(insert(p), (None, 1, 4));
        }
    }
}
