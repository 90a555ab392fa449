//! Shape of the pieces: edges within plane facets are flipped to Delaunay triangulations, and badly shaped pieces are refined
//! by their longest edges.
//!
//! A facet is a set of coplanar triangles with one marker. Its triangulation is Delaunay if at no edge the two opposite
//! angles exceed 180° (Lawson, 'Software for C1 surface interpolation', 1977). A badly shaped piece gets
//! the midpoint of the terminal edge of its longest-edge path. The path is that of Rivara, 'New longest-edge algorithms for the
//! refinement and/or improvement of unstructured triangulations', 1997.

use super::pieces::{Pieces, edge, edges_of};
use crate::progress::{Counter, Watch};
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Maximum distance from a common plane of the corners of two triangles in one facet, relative to their longest edge.
const FLAT: f64 = 1e-4;

/// Sine of the sum of two opposite angles below which their edge is flipped. Avoids endless flips of cocircular points.
const DELAUNAY: f64 = -1e-9;

/// Maximum flips per edge, and maximum triangles on a longest-edge path.
const MAX_FLIPS: usize = 16;
const MAX_PATH: usize = 64;

/// Minimum length of new edges, relative to the shortest edge of the piece that they improve. Edges get longer away from
/// short ones, and at small angles of creases the refinement ends.
const SPACING: f64 = 1.1;

/// Operations per piece, as counted by budgets.
const OPERATIONS: usize = 20;

/// Minimum length of an edge to be halved, relative to the size of the surface.
const SHORTEST: f64 = 1e-6;

/// Two triangles of a facet at their common edge: `a`, `b` and the opposite vertices. The first triangle has the edge from
/// `a` to `b`.
struct Hinge {
    triangles: [u32; 2],
    ends: [u32; 2],
    apexes: [u32; 2],
    /// Normal of the facet.
    normal: Vec3,
}

impl Pieces {
    /// Makes all facets Delaunay, and refines pieces with a larger ratio of circumradius to shortest edge.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub(super) fn improve(&mut self, ratio: f64, most: usize, watch: &Watch) -> Result<(), Stop> {
        let due: Vec<u32> = (0..self.plc.surface.triangles.len() as u32).collect();
        self.legalize(self.edges_at(&due));
        self.refine_all(due, ratio, most, watch)
    }

    /// Refines those of the pieces that are badly shaped, and all that change, as long as there are at most `most`.
    pub(super) fn refine_all(&mut self, mut due: Vec<u32>, ratio: f64, most: usize, watch: &Watch) -> Result<(), Stop> {
        let mut counter = Counter::new(watch);
        while !due.is_empty() {
            due.sort_unstable();
            due.dedup();
            self.changed.clear();
            for t in due {
                counter.add(OPERATIONS)?;
                if self.plc.surface.triangles.len() < most && self.is_bad(t, ratio) {
                    let edge = self.edge_to_divide(t);
                    let has_room = self.is_encroached(edge) || self.clearance(edge) >= SPACING * self.shortest(t);
                    if has_room && self.divide(edge) {
                        self.changed.push(t);
                    }
                }
            }
            due = std::mem::take(&mut self.changed);
        }
        counter.end()
    }

    /// Divides an edge, and makes the facets at it Delaunay. Returns false if it is too short.
    pub(super) fn divide(&mut self, edge: [u32; 2]) -> bool {
        let before = self.changed.len();
        let is_divided = self.length(edge) > SHORTEST * self.extent && self.halve(edge);
        if is_divided {
            self.legalize(self.edges_at(&self.changed[before..]));
        }
        is_divided
    }

    /// Edges of triangles, ascending.
    fn edges_at(&self, triangles: &[u32]) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> =
            triangles.iter().flat_map(|&t| edges_of(self.plc.surface.triangles[t as usize])).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// True if the ratio of circumradius to shortest edge is too large, and the smallest angle is not one of the input.
    fn is_bad(&self, t: u32, ratio: f64) -> bool {
        let v = self.plc.surface.triangles[t as usize];
        let [a, b, c] = self.corners(v);
        let sides = [(b - c).norm(), (c - a).norm(), (a - b).norm()];
        let double_area = (b - a).cross(&(c - a)).norm();
        let at = (0..3).min_by(|&i, &j| sides[i].total_cmp(&sides[j])).unwrap_or(0);
        // The circumradius is the product of the sides over four areas.
        let is_bad = sides[(at + 1) % 3] * sides[(at + 2) % 3] > 2.0 * ratio * double_area;
        is_bad && [1, 2].iter().any(|i| self.is_flat(edge(v[at], v[(at + i) % 3])))
    }

    fn shortest(&self, t: u32) -> f64 {
        edges_of(self.plc.surface.triangles[t as usize])
            .map(|e| self.length(e))
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }

    /// Distance of the point that divides an edge from the corners of the triangles at the edge.
    pub(super) fn clearance(&self, edge: [u32; 2]) -> f64 {
        let point = self.dividing(edge);
        let triangles = self.at_edge.get(&edge).into_iter().flatten();
        let corners = triangles.flat_map(|&t| self.corners(self.plc.surface.triangles[t as usize]));
        corners.map(|corner| (corner - point).norm()).fold(f64::INFINITY, f64::min)
    }

    /// Terminal edge of a triangle, or a crease beside it that its middle is too close to.
    pub(super) fn edge_to_divide(&self, t: u32) -> [u32; 2] {
        let terminal = self.terminal_edge(t);
        let Some(hinge) = self.hinge(terminal) else { return terminal };
        let middle = self.dividing(terminal);
        let beside = hinge.triangles.into_iter().flat_map(|t| edges_of(self.plc.surface.triangles[t as usize]));
        let creases = beside.filter(|&e| e != terminal && self.sees_obtuse(&middle, e) && !self.is_flat(e));
        creases.max_by(|x, y| self.length(*x).total_cmp(&self.length(*y))).unwrap_or(terminal)
    }

    /// True if a point lies in the smallest sphere around an edge.
    fn sees_obtuse(&self, p: &Point3, edge: [u32; 2]) -> bool {
        let [a, b] = edge.map(|v| self.plc.surface.points[v as usize] - p);
        a.dot(&b) < 0.0
    }

    /// True for a crease with the opposite vertex of a triangle in its smallest sphere. Vertices on edges of the input that meet
    /// the crease do not count.
    fn is_encroached(&self, e: [u32; 2]) -> bool {
        let opposite = |t: &u32| self.plc.surface.triangles[*t as usize].into_iter().find(|v| !e.contains(v));
        let mut apexes = self.at_edge.get(&e).into_iter().flatten().filter_map(opposite);
        let encroaches =
            |v: u32| self.sees_obtuse(&self.plc.surface.points[v as usize], e) && !self.is_beside_line(v, e);
        apexes.any(encroaches) && !self.is_flat(e)
    }

    /// Last edge of the path from a triangle across longest edges, as long as these grow and are flat.
    fn terminal_edge(&self, mut t: u32) -> [u32; 2] {
        let mut longest = self.longest(t);
        for _ in 0..MAX_PATH {
            let Some(hinge) = self.hinge(longest) else { break };
            let [first, second] = hinge.triangles;
            t = if first == t { second } else { first };
            let next = self.longest(t);
            if next == longest {
                break;
            }
            longest = next;
        }
        longest
    }

    /// Flips edges until all facets at them are Delaunay.
    fn legalize(&mut self, mut edges: Vec<[u32; 2]>) {
        let mut flips = MAX_FLIPS * edges.len();
        while let Some(edge) = edges.pop() {
            let Some(hinge) = self.hinge(edge) else { continue };
            if flips == 0 || !self.is_illegal(&hinge) || !self.flip(&hinge) {
                continue;
            }
            flips -= 1;
            let outer = hinge.triangles.into_iter().flat_map(|t| edges_of(self.plc.surface.triangles[t as usize]));
            edges.extend(outer.filter(|e| !hinge.apexes.contains(&e[0]) || !hinge.apexes.contains(&e[1])));
        }
    }

    fn is_illegal(&self, hinge: &Hinge) -> bool {
        let [a, b] = hinge.ends.map(|v| self.plc.surface.points[v as usize]);
        let sine_and_cosine = |apex: u32| {
            let p = self.plc.surface.points[apex as usize];
            let (u, v) = (a - p, b - p);
            let scale = u.norm() * v.norm();
            [u.cross(&v).norm() / scale, u.dot(&v) / scale]
        };
        let [[s, c], [t, d]] = hinge.apexes.map(sine_and_cosine);
        s * d + c * t < DELAUNAY
    }

    /// True for an edge within a facet.
    pub(super) fn is_flat(&self, edge: [u32; 2]) -> bool {
        self.hinge(edge).is_some()
    }

    /// The triangles at an edge within a facet; `None` at a crease, a segment, or an edge of other than two triangles.
    fn hinge(&self, edge: [u32; 2]) -> Option<Hinge> {
        let &[t, u] = self.at_edge.get(&edge)?.as_slice() else { return None };
        let marker = |t: u32| self.plc.markers.get(t as usize);
        if self.segments.contains_key(&edge) || marker(t) != marker(u) {
            return None;
        }
        let [a, b] = edge;
        let directed = |t: u32, from: u32, to: u32| {
            let v = self.plc.surface.triangles[t as usize];
            (0..3).find(|&i| v[i] == from && v[(i + 1) % 3] == to).map(|i| v[(i + 2) % 3])
        };
        let (ends, first, second) = match (directed(t, a, b), directed(u, b, a)) {
            (Some(first), Some(second)) => ([a, b], first, second),
            _ => ([b, a], directed(t, b, a)?, directed(u, a, b)?),
        };
        let normal = self.common_normal(ends, [first, second])?;
        Some(Hinge { triangles: [t, u], ends, apexes: [first, second], normal })
    }

    /// Normal of the facet of two triangles at an edge; `None` if they are not coplanar.
    fn common_normal(&self, ends: [u32; 2], apexes: [u32; 2]) -> Option<Vec3> {
        let [a, b, c, d] = [ends[0], ends[1], apexes[0], apexes[1]].map(|v| self.plc.surface.points[v as usize]);
        let (first, second) = ((b - a).cross(&(c - a)), (a - b).cross(&(d - b)));
        let (large, small) = if first.norm() >= second.norm() { (first, second) } else { (second, first) };
        let longest = [b - a, c - a, c - b, d - a, d - b].iter().map(Vec3::norm).fold(0.0, f64::max);
        let off = first.dot(&(d - a)).abs();
        // The normal of a triangle without height means nothing.
        let is_folded = large.dot(&small) <= 0.0 && small.norm() > FLAT * longest * longest;
        (off <= FLAT * longest * large.norm() && !is_folded).then_some(large)
    }

    /// Exchanges the edge of two triangles for that between their opposite vertices. Returns false if this is impossible.
    fn flip(&mut self, Hinge { triangles: [t, u], ends: [a, b], apexes: [c, d], normal }: &Hinge) -> bool {
        let new = [[*a, *d, *c], [*d, *b, *c]];
        let is_positive = |v: &[u32; 3]| {
            let [a, b, c] = self.corners(*v);
            (b - a).cross(&(c - a)).dot(normal) > 0.0
        };
        let exists = self.at_edge.get(&edge(*c, *d)).is_some_and(|list| !list.is_empty());
        if exists || !new.iter().all(is_positive) {
            return false;
        }
        for (t, v) in [(*t, new[0]), (*u, new[1])] {
            self.replace(t, v);
        }
        true
    }

    pub(super) fn corners(&self, v: [u32; 3]) -> [Point3; 3] {
        v.map(|v| self.plc.surface.points[v as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plc::Plc;
    use crate::{Boundary, Refinement, Tetrahedralization, Tetrahedralizer};
    use anastomesh_mesh::TriMesh;
    use anastomesh_mesh::quality::TetQuality;
    use proptest::prelude::*;

    /// Prism of a polygon around the z axis, whose faces are fans; the bottom, the top and each side have their marker.
    fn prism(angles: &[f64], height: f64) -> Plc {
        let n = angles.len() as u32;
        let ring = |z: f64| angles.iter().map(move |&a| Point3::new(libm::cos(a), libm::sin(a), z));
        let points = ring(0.0).chain(ring(height)).collect();
        let mut triangles = Vec::new();
        let mut markers = Vec::new();
        for i in 1..n - 1 {
            triangles.extend([[0, i + 1, i], [n, n + i, n + i + 1]]);
            markers.extend([1, 2]);
        }
        for i in 0..n {
            let j = (i + 1) % n;
            triangles.extend([[i, j, n + j], [i, n + j, n + i]]);
            markers.extend([3 + i as i32; 2]);
        }
        Plc { markers, ..Plc::from(TriMesh { points, triangles }) }
    }

    fn ratio(pieces: &Pieces, t: u32) -> f64 {
        let [a, b, c] = pieces.corners(pieces.plc.surface.triangles[t as usize]);
        let sides = [(b - c).norm(), (c - a).norm(), (a - b).norm()];
        let shortest = sides.iter().copied().fold(f64::INFINITY, f64::min);
        sides.iter().product::<f64>() / (2.0 * (b - a).cross(&(c - a)).norm()) / shortest
    }

    /// Area of each marker, and volume.
    fn sizes(plc: &Plc) -> (Vec<f64>, f64) {
        let mut areas = vec![0.0; 1 + plc.markers.iter().copied().max().unwrap_or(0) as usize];
        let mut volume = 0.0;
        for (t, &marker) in plc.surface.triangles.iter().zip(&plc.markers) {
            let [a, b, c] = t.map(|v| plc.surface.points[v as usize]);
            areas[marker as usize] += (b - a).cross(&(c - a)).norm() / 2.0;
            volume += a.coords.dot(&b.coords.cross(&c.coords)) / 6.0;
        }
        (areas, volume)
    }

    fn improved(plc: &Plc) -> Pieces {
        let mut pieces = Pieces::new(plc.clone());
        pieces.improve(1.4, 100_000, &Watch::NOBODY).expect("not stopped");
        let (before, after) = (sizes(plc), sizes(&pieces.plc));
        for (x, y) in before.0.iter().zip(&after.0) {
            assert!((x - y).abs() <= 1e-9 * before.0.iter().sum::<f64>(), "{before:?} {after:?}");
        }
        assert!((before.1 - after.1).abs() <= 1e-9 * before.1);
        for (edge, triangles) in &pieces.at_edge {
            assert!(triangles.is_empty() || triangles.len() == 2, "{edge:?} {triangles:?}");
        }
        pieces
    }

    #[test]
    fn a_plate_of_needles_becomes_good_triangles() {
        let angles: Vec<f64> = (0..48).map(|i| f64::from(i) * std::f64::consts::TAU / 48.0).collect();
        let pieces = improved(&prism(&angles, 0.05));
        let count = pieces.plc.surface.triangles.len();
        assert!((500..6000).contains(&count), "{count}");
        // The spacing keeps some a little above the bound.
        let ratios: Vec<f64> = (0..count as u32).map(|t| ratio(&pieces, t)).collect();
        let above = ratios.iter().filter(|&&r| r > 1.4).count();
        assert!(ratios.iter().all(|&r| r <= 2.0) && 20 * above < count, "{above} of {count}");
    }

    #[test]
    fn tetrahedra_in_a_plate_of_needles_meet_the_bound() {
        let angles: Vec<f64> = (0..48).map(|i| f64::from(i) * std::f64::consts::TAU / 48.0).collect();
        let plate = prism(&angles, 0.05);
        let bound = Refinement::default().max_radius_edge(1.4);
        let split = Tetrahedralizer::new().boundary(Boundary::Split).refine(bound).run(&plate).expect("certified");
        let after = Plc { markers: split.face_markers.clone(), ..surface(&split) };
        for (x, y) in sizes(&plate).0.iter().zip(&sizes(&after).0) {
            assert!((x - y).abs() < 1e-9, "{x} {y}");
        }
        let quality = TetQuality::of(&split.mesh);
        assert!(quality.dihedral_min > 8.0 && quality.mean > 0.6, "{quality:?}");
        let left = split.summary.refine.map_or(0, |report| report.left);
        assert!(5 * left < split.mesh.tets.len(), "{left} of {}", split.mesh.tets.len());
    }

    fn surface(made: &Tetrahedralization) -> Plc {
        Plc::from(TriMesh { points: made.mesh.points.clone(), triangles: made.faces.clone() })
    }

    #[test]
    fn small_angles_end_the_refinement() {
        let pieces = improved(&prism(&[0.0, 0.02, 3.1], 0.7));
        assert!(pieces.plc.surface.triangles.len() < 3000, "{}", pieces.plc.surface.triangles.len());
    }

    #[test]
    fn a_stop_ends_it() {
        let mut pieces = Pieces::new(prism(&[0.0, 1e-3, 2.0, 4.0], 1e-3));
        let stops = anastomesh_mesh::progress::StopsAfter::new(0);
        assert!(pieces.improve(1.4, 100_000, &Watch::of(&stops)).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn facets_keep_their_area_and_become_delaunay(
            steps in prop::collection::vec(0.01..1.0_f64, 4..30),
            height in 0.01..3.0_f64,
        ) {
            let total: f64 = steps.iter().sum();
            let mut angle = 0.0;
            let angles: Vec<f64> = steps.iter().map(|step| { angle += step * 0.999 * std::f64::consts::TAU / total; angle }).collect();
            let pieces = improved(&prism(&angles, height));
            let edges = pieces.edges_at(&(0..pieces.plc.surface.triangles.len() as u32).collect::<Vec<_>>());
            for edge in edges {
                prop_assert!(!pieces.hinge(edge).is_some_and(|hinge| pieces.is_illegal(&hinge)));
            }
        }
    }
}
