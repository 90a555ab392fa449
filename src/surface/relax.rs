//! Isotropic remeshing after Botsch and Kobbelt (2004), with projection by Newton steps on the field. Edges are split,
//! collapsed and flipped towards equal lengths and valence 6. Vertices move within the surface and are projected back
//! onto the level set.

use super::field::Field;
use super::halfedge::HalfEdges;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_tet::parts::Watch;

mod crotch;

/// Level set onto which vertices are projected.
pub(crate) trait Level {
    /// Returns value and gradient of a function that grows outwards and is 1 on the level set. The gradient is zero
    /// where the level does not constrain vertices.
    fn value_and_gradient(&mut self, p: &Point3) -> (f64, Vec3);

    /// Operations of the evaluations since the last call, as counted by budgets.
    fn operations(&mut self) -> usize {
        0
    }
}

impl Level for Field {
    fn value_and_gradient(&mut self, p: &Point3) -> (f64, Vec3) {
        Field::value_and_gradient(self, p)
    }

    fn operations(&mut self) -> usize {
        Field::operations(self)
    }
}

/// Constraint on a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hold {
    /// The vertex may move and vanish.
    Free,
    /// The vertex is fixed, and so are edges between two `Still` vertices.
    Still,
    /// Fixed vertex of a disc. Edges between `Disc` and `Still` vertices may be split and flipped.
    Disc,
}

/// Relaxation of a surface or of a part of it.
pub(crate) struct Relaxation<'a, L> {
    pub surface: &'a mut HalfEdges,
    /// Level set of the vertices.
    pub level: &'a mut L,
    /// Target edge length at each vertex.
    pub sizes: Vec<f64>,
    /// Constraint of each vertex; if empty, all vertices are free.
    pub hold: Vec<Hold>,
    /// Unit normal of the level set at each vertex.
    normals: Vec<Vec3>,
    /// Part to relax; `None` for the whole surface.
    patch: Option<Patch>,
    watch: Watch<'a>,
    /// Reason to end early; no pass does anything then.
    stopped: Option<Stop>,
}

/// Part of a surface with free vertices.
#[derive(Debug, Default)]
struct Patch {
    /// Free vertices and those added by splits.
    vertices: Vec<u32>,
    /// Triangles at free vertices and those added by splits. Every operation replaces triangles of the patch by
    /// triangles of the patch.
    faces: Vec<u32>,
}

/// Minimum decrease of the largest cosine by a flip. Rounding errors could make flips alternate forever.
const COSINE_GAIN: f64 = 1e-3;
/// Edges beyond these multiples of the target length are split or collapsed.
const SPLIT_ABOVE: f64 = 1.45;
const COLLAPSE_BELOW: f64 = 0.62;
/// Maximum number of edges of a vertex after a collapse. Without it, the time is quadratic where the grid is much finer than
/// the edges. Flips between passes make room.
const MOST_VALENCE: usize = 24;
/// Maximum number of passes of collapses. Each one removes most vertices that are too many.
const MOST_PASSES: usize = 16;
/// Triangles with a minimum angle above 41° are not flipped for a better one.
const GOOD_COSINE: f64 = 0.75;
/// Items between two checks for cancellation and the budget, and operations per item.
const ASKED_EVERY: usize = 4096;
const OPERATIONS: usize = 1;
/// Maximum vertex step in one projection, in edge lengths.
const MAX_STEP: f64 = 0.5;

impl<'a, L: Level> Relaxation<'a, L> {
    pub(crate) fn new(
        surface: &'a mut HalfEdges,
        level: &'a mut L,
        sizes: Vec<f64>,
        hold: Vec<Hold>,
        watch: Watch<'a>,
    ) -> Self {
        let normals = vec![Vec3::zeros(); surface.points.len()];
        let patch = (!hold.is_empty()).then(|| Patch::of(surface, &hold));
        let mut this = Self { surface, level, sizes, hold, normals, patch, watch, stopped: None };
        // Contours and relaxed walls lie near the level, so surface normals suffice until the first projection.
        for i in 0..this.vertex_count() {
            let v = this.vertex(i);
            let sum: Vec3 = this.surface.fan(v).map(|h| this.surface.area_vector(h)).sum();
            this.normals[v as usize] = sum.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        }
        this
    }

    /// Counts the next operations of a pass at item `i` of `count`. Returns true if the pass must end.
    #[inline]
    fn must_stop(&mut self, i: usize, count: usize) -> bool {
        if i.is_multiple_of(ASKED_EVERY) {
            let operations = OPERATIONS * ASKED_EVERY.min(count - i) + self.level.operations();
            self.stopped = self.stopped.or(self.watch.spend(operations).err());
        }
        self.stopped.is_some()
    }

    /// Number of half-edges to visit, including removed ones.
    fn half_count(&self) -> u32 {
        self.patch.as_ref().map_or(self.surface.len(), |p| 3 * p.faces.len() as u32)
    }

    /// Half-edge number `i` of those to visit.
    #[inline]
    fn half(&self, i: u32) -> u32 {
        self.patch.as_ref().map_or(i, |p| 3 * p.faces[i as usize / 3] + i % 3)
    }

    /// Number of vertices to visit, including removed ones.
    fn vertex_count(&self) -> usize {
        self.patch.as_ref().map_or(self.surface.points.len(), |p| p.vertices.len())
    }

    /// Vertex number `i` of those to visit.
    #[inline]
    fn vertex(&self, i: usize) -> u32 {
        self.patch.as_ref().map_or(i as u32, |p| p.vertices[i])
    }

    /// Relaxes a surface that is good except for an inner seam: flips use the angle criterion only.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub(crate) fn mend(&mut self, rounds: usize) -> Result<(), Stop> {
        self.rounds(rounds, Criterion::Angle);
        self.flip(Criterion::Angle);
        self.project();
        self.stopped.map_or(Ok(()), Err)
    }

    /// Runs rounds of split, collapse, flip and smooth, then opens crotches and runs the final passes. For whole
    /// surfaces.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub(crate) fn run(&mut self, rounds: usize) -> Result<(), Stop> {
        self.rounds(rounds, Criterion::Valence);
        self.open_crotches(Self::finish);
        self.stopped.map_or(Ok(()), Err)
    }

    fn rounds(&mut self, count: usize, criterion: Criterion) {
        for _ in 0..count {
            self.split_long();
            self.collapse_short();
            self.flip(criterion);
            self.smooth();
        }
    }

    /// Improves the worst angles and applies the final projection and chord compensation.
    fn finish(&mut self) {
        self.flip(Criterion::Angle);
        self.smooth();
        self.flip(Criterion::Angle);
        self.project();
        self.compensate_chords();
    }

    /// Moves each vertex outwards by a quarter of its normal distance from the mean of its neighbours. Vertices on the
    /// level form an inscribed polyhedron. The shift compensates its error to second order (h²/16r on a tube, negative
    /// in saddles).
    fn compensate_chords(&mut self) {
        let moves: Vec<Vec3> = (0..self.surface.points.len() as u32)
            .map(|v| {
                if !self.is_free(v) {
                    return Vec3::zeros();
                }
                let n = self.normals[v as usize];
                n * (0.25 * (self.surface.points[v as usize] - self.neighbour_mean(v)).dot(&n))
            })
            .collect();
        for (p, m) in self.surface.points.iter_mut().zip(moves) {
            *p += m;
        }
    }

    /// Target length of an edge between two vertices.
    #[inline]
    fn aim(&self, a: u32, b: u32) -> f64 {
        0.5 * (self.sizes[a as usize] + self.sizes[b as usize])
    }

    fn is_free(&self, v: u32) -> bool {
        self.surface.has_vertex(v) && !self.is_locked(v)
    }

    #[inline]
    fn hold(&self, v: u32) -> Hold {
        self.hold.get(v as usize).copied().unwrap_or(Hold::Free)
    }

    #[inline]
    fn is_locked(&self, v: u32) -> bool {
        self.hold(v) != Hold::Free
    }

    fn neighbour_mean(&self, v: u32) -> Point3 {
        let (mut sum, mut count) = (Vec3::zeros(), 0.0);
        for h in self.surface.fan(v) {
            sum += self.surface.points[self.surface.to(h) as usize].coords;
            count += 1.0;
        }
        Point3::from(sum / count)
    }

    /// Moves each free vertex by one Newton step onto the level and updates its normal.
    fn project(&mut self) {
        for i in 0..self.vertex_count() {
            if self.must_stop(i, self.vertex_count()) {
                return;
            }
            let v = self.vertex(i);
            if self.is_free(v) {
                let p = self.surface.points[v as usize];
                self.surface.points[v as usize] = self.projected(v, p);
            }
        }
    }

    fn projected(&mut self, v: u32, p: Point3) -> Point3 {
        let (value, gradient) = self.level.value_and_gradient(&p);
        let g2 = gradient.norm_squared();
        if g2 <= 0.0 {
            return p;
        }
        self.normals[v as usize] = gradient / g2.sqrt();
        let step = gradient * ((1.0 - value) / g2);
        let limit = MAX_STEP * self.sizes[v as usize];
        let length = step.norm();
        p + if length > limit { step * (limit / length) } else { step }
    }

    /// Moves each free vertex, within the tangent plane, towards the area-weighted centre of its triangles, then
    /// projects it.
    fn smooth(&mut self) {
        let targets: Vec<Point3> = (0..self.vertex_count()).map(|i| self.smoothed(self.vertex(i))).collect();
        let count = targets.len();
        for (i, target) in targets.into_iter().enumerate() {
            if self.must_stop(i, count) {
                return;
            }
            let v = self.vertex(i);
            if self.is_free(v) {
                self.surface.points[v as usize] = self.projected(v, target);
            }
        }
    }

    fn smoothed(&self, v: u32) -> Point3 {
        let p = self.surface.points[v as usize];
        if !self.is_free(v) {
            return p;
        }
        let (mut sum, mut weight) = (Vec3::zeros(), 0.0);
        for h in self.surface.fan(v) {
            let a = self.surface.points[self.surface.to(h) as usize] - p;
            let b = self.surface.points[self.surface.apex(h) as usize] - p;
            // Weights areas by target size, so graded meshes keep their grading.
            let size = self.sizes[self.surface.to(h) as usize] + self.sizes[self.surface.apex(h) as usize];
            let area = a.cross(&b).norm() / (size * size);
            sum += (a + b) * (area / 3.0);
            weight += area;
        }
        if weight <= 0.0 {
            return p;
        }
        let n = self.normals[v as usize];
        let step = sum / weight;
        p + (step - n * step.dot(&n))
    }

    fn split_long(&mut self) {
        let count = self.half_count();
        for i in 0..count {
            if self.must_stop(i as usize, count as usize) {
                return;
            }
            let h = self.half(i);
            if !self.is_editable(h) {
                continue;
            }
            let (a, b) = (self.surface.from(h), self.surface.to(h));
            if a < b && self.surface.length(h) > SPLIT_ABOVE * self.aim(a, b) {
                let m = self.split(h, self.aim(a, b));
                let middle = self.surface.points[m as usize];
                self.surface.points[m as usize] = self.projected(m, middle);
            }
        }
    }

    /// Inserts a vertex amid an edge without projecting it.
    fn split(&mut self, h: u32, size: f64) -> u32 {
        let [a, b] = [self.surface.from(h), self.surface.to(h)].map(|v| v as usize);
        let m = self.surface.split(h, nalgebra::center(&self.surface.points[a], &self.surface.points[b]));
        self.normals.push(self.normals[a]);
        self.sizes.push(size);
        if let Some(patch) = &mut self.patch {
            self.hold.push(Hold::Free);
            patch.vertices.push(m);
            let faces = self.surface.len() / 3;
            patch.faces.extend([faces - 2, faces - 1]);
        }
        m
    }

    /// True if the edge exists and its ends do not fix it.
    fn is_editable(&self, h: u32) -> bool {
        if !self.surface.is_live(h) {
            return false;
        }
        let (a, b) = (self.hold(self.surface.from(h)), self.hold(self.surface.to(h)));
        a == Hold::Free || b == Hold::Free || a != b
    }

    /// Collapses short edges. On a grid much finer than the edges, this takes several passes.
    fn collapse_short(&mut self) {
        for _ in 0..MOST_PASSES {
            if !self.collapse_once() {
                return;
            }
            self.flip(Criterion::Valence);
        }
    }

    /// One pass of collapses. Returns true if some wait because the fan of their vertex is full.
    fn collapse_once(&mut self) -> bool {
        let count = self.half_count();
        let mut is_full = false;
        for i in 0..count {
            if self.must_stop(i as usize, count as usize) {
                return false;
            }
            let h = self.half(i);
            if !self.surface.is_live(h) || self.is_locked(self.surface.from(h)) {
                continue;
            }
            let (a, b) = (self.surface.from(h), self.surface.to(h));
            if self.surface.length(h) > COLLAPSE_BELOW * self.aim(a, b) {
                continue;
            }
            let target = if self.is_locked(b) {
                self.surface.points[b as usize]
            } else {
                nalgebra::center(&self.surface.points[a as usize], &self.surface.points[b as usize])
            };
            if !self.surface.can_collapse(h) || !self.collapse_is_sound(h, target) {
                continue;
            }
            if self.surface.valence(a) + self.surface.valence(b) > MOST_VALENCE + 4 {
                is_full = true;
                continue;
            }
            self.surface.collapse(h);
            self.sizes[b as usize] = self.aim(a, b);
            // The vertex is projected during smoothing.
            self.surface.points[b as usize] = target;
        }
        is_full
    }

    fn is_on_disc(&self, v: u32) -> bool {
        self.hold(v) == Hold::Disc
    }

    /// True if the collapse of `h` to `target` inverts no triangle, places none on a disc, and makes no edge too long.
    fn collapse_is_sound(&self, h: u32, target: Point3) -> bool {
        let (a, b) = (self.surface.from(h), self.surface.to(h));
        let limit = SPLIT_ABOVE * self.aim(a, b);
        [(a, b), (b, a)].iter().all(|&(v, other)| {
            self.surface.fan(v).all(|e| {
                let (x, y) = (self.surface.to(e), self.surface.apex(e));
                if x == other || y == other {
                    return true;
                }
                if v == a && [b, x, y].into_iter().all(|w| self.is_on_disc(w)) {
                    return false;
                }
                let (px, py) = (self.surface.points[x as usize], self.surface.points[y as usize]);
                let old = self.surface.area_vector(e);
                let new = (px - target).cross(&(py - target));
                new.dot(&old) > 0.5 * new.norm() * old.norm() && (px - target).norm() < limit
            })
        })
    }

    fn flip(&mut self, criterion: Criterion) {
        let by_valence = matches!(criterion, Criterion::Valence);
        let mut valence = if by_valence { self.surface.valences() } else { Vec::new() };
        let count = self.half_count();
        for i in 0..count {
            if self.must_stop(i as usize, count as usize) {
                return;
            }
            let h = self.half(i);
            if self.is_editable(h) && h < self.surface.twin(h) {
                let s = &*self.surface;
                let quad = [s.from(h), s.to(h), s.apex(h), s.apex(s.twin(h))].map(|v| v as usize);
                let wanted =
                    if by_valence { flip_evens_valence(quad.map(|v| valence[v])) } else { self.flip_opens_angle(h) };
                // A new edge between two disc vertices would lie in the disc plane, and so would an adjacent triangle.
                let chord = self.is_on_disc(quad[2] as u32) && self.is_on_disc(quad[3] as u32);
                if wanted && !chord && self.surface.can_flip(h) && self.flip_is_sound(h) {
                    self.surface.flip(h);
                    if by_valence {
                        for (v, change) in quad.into_iter().zip([-1, -1, 1, 1]) {
                            valence[v] += change;
                        }
                    }
                }
            }
        }
    }

    fn flip_opens_angle(&self, h: u32) -> bool {
        let s = &*self.surface;
        let o = s.twin(h);
        let [a, b, c, d] = [s.from(h), s.to(h), s.apex(h), s.apex(o)].map(|v| s.points[v as usize]);
        let before = largest_cosine(&a, &b, &c).max(largest_cosine(&b, &a, &d));
        if before < GOOD_COSINE {
            return false;
        }
        let after = largest_cosine(&a, &d, &c).max(largest_cosine(&d, &b, &c));
        after < before - COSINE_GAIN
    }

    /// True if the new triangles face the old direction and the new edge is not a ridge.
    fn flip_is_sound(&self, h: u32) -> bool {
        let s = &*self.surface;
        let o = s.twin(h);
        let [a, b, c, d] = [s.from(h), s.to(h), s.apex(h), s.apex(o)].map(|v| s.points[v as usize]);
        let old = (s.area_vector(h) + s.area_vector(o)).normalize();
        let (n1, n2) = ((d - a).cross(&(c - a)), (b - d).cross(&(c - d)));
        let (l1, l2) = (n1.norm(), n2.norm());
        n1.dot(&old) > 0.7 * l1 && n2.dot(&old) > 0.7 * l2 && n1.dot(&n2) > 0.5 * l1 * l2
    }
}

impl Patch {
    fn of(surface: &HalfEdges, hold: &[Hold]) -> Self {
        let free = |v: &u32| hold[*v as usize] == Hold::Free && surface.has_vertex(*v);
        let vertices: Vec<u32> = (0..hold.len() as u32).filter(free).collect();
        let mut faces: Vec<u32> = vertices.iter().flat_map(|&v| surface.fan(v)).map(|h| h / 3).collect();
        faces.sort_unstable();
        faces.dedup();
        Self { vertices, faces }
    }
}

/// True if a flip improves valences: the first two vertices lose an edge, the others gain one.
fn flip_evens_valence(valence: [i32; 4]) -> bool {
    let badness = |x: [i32; 4]| x.iter().map(|n| (n - 6) * (n - 6)).sum::<i32>();
    let [a, b, c, d] = valence;
    badness([a - 1, b - 1, c + 1, d + 1]) < badness(valence)
}

#[derive(Clone, Copy)]
enum Criterion {
    Valence,
    Angle,
}

/// Cosine of a triangle's smallest angle.
pub(crate) fn largest_cosine(a: &Point3, b: &Point3, c: &Point3) -> f64 {
    let (x, y, z) = ((c - b).norm_squared(), (a - c).norm_squared(), (b - a).norm_squared());
    // The smallest angle lies opposite the shortest side.
    let (o, p, q) = if x <= y && x <= z {
        (x, y, z)
    } else if y <= z {
        (y, z, x)
    } else {
        (z, x, y)
    };
    (p + q - o) / (2.0 * (p * q).sqrt()).max(f64::MIN_POSITIVE)
}
