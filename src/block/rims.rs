//! Tetrahedra in the corner between wall and cap, with a face in each. All four vertices of such a one are on the boundary:
//! linear elements have nothing to solve for in it, and solvers by volumes find its matrix of faces all but singular. One of
//! its faces inside gives way to an edge, or its edge inside is split, whichever leaves the better tetrahedra, so that none is
//! left.

use crate::geometry::Point3;
use crate::geometry::predicates::orient3d;
use crate::mesh::quality::radius_ratio;
use crate::mesh::{TetMesh, TriMesh, face_key};
use rustc_hash::{FxHashMap, FxHashSet};

/// Rounds at most: what is near each other is changed one after the other.
const ROUNDS: usize = 8;
/// How far a new vertex is drawn from its edge towards the middle of what is around it, one after the other.
const DRAWN: [f64; 4] = [0.0, 0.15, 0.3, 0.5];

/// Changes the tetrahedra inside a filled surface until no tetrahedron has a face both on a cap and on the wall; `cap` says of each
/// triangle whether it is on a cap. The surface stays as it is, and its vertices keep their numbers.
pub(super) fn split_rims(mesh: &mut TetMesh, surface: &TriMesh, cap: impl Fn(usize) -> bool) {
    let rims = Rims::of(surface, cap);
    for _ in 0..ROUNDS {
        let corners: Vec<Corner> = (0..mesh.tets.len()).filter_map(|i| rims.corner(mesh, i)).collect();
        if corners.is_empty() || !part(mesh, &corners) {
            return;
        }
    }
}

/// The surface near its caps.
struct Rims {
    /// Whether a vertex is on a cap.
    on_cap: Vec<bool>,
    /// The triangles with a vertex on a cap: whether they are of one.
    faces: FxHashMap<[u32; 3], bool>,
    edges: FxHashSet<[u32; 2]>,
}

/// A tetrahedron between wall and cap.
struct Corner {
    tet: usize,
    /// The vertices that its faces inside lack: those of the edge that its faces on the boundary share.
    opposite: [u32; 2],
    /// The edge that neither of its two faces on the boundary has; none when it is on the boundary, too.
    inside: Option<[u32; 2]>,
}

impl Rims {
    fn of(surface: &TriMesh, cap: impl Fn(usize) -> bool) -> Self {
        let mut on_cap = vec![false; surface.points.len()];
        let of_caps = surface.triangles.iter().enumerate().filter(|(i, _)| cap(*i));
        of_caps.for_each(|(_, triangle)| triangle.iter().for_each(|&v| on_cap[v as usize] = true));
        let mut rims = Self { on_cap, faces: FxHashMap::default(), edges: FxHashSet::default() };
        for (i, &[a, b, c]) in surface.triangles.iter().enumerate() {
            if [a, b, c].iter().any(|&v| rims.on_cap[v as usize]) {
                rims.faces.insert(face_key([a, b, c]), cap(i));
                rims.edges.extend([[a, b], [b, c], [c, a]].map(edge_key));
            }
        }
        rims
    }

    /// Whether a tetrahedron has a face on a cap and one on the wall.
    fn corner(&self, mesh: &TetMesh, tet: usize) -> Option<Corner> {
        let vertices = mesh.tets[tet];
        let on_cap = |v: &&u32| self.on_cap.get(**v as usize).is_some_and(|&on| on);
        if vertices.iter().filter(on_cap).count() < 3 {
            return None;
        }
        // The faces by the vertex that they lack.
        let face = |k: usize| self.faces.get(&face_key([1, 2, 3].map(|j| vertices[(k + j) % 4])));
        let of = |kind: bool| (0..4).find(|&k| face(k) == Some(&kind));
        let (i, j) = (of(true)?, of(false)?);
        let inside = edge_key([vertices[i], vertices[j]]);
        let [k, l] = [1, 2, 3].map(|n| (i + n) % 4).into_iter().filter(|&k| k != j).collect::<Vec<_>>()[..] else {
            return None;
        };
        let opposite = [vertices[k], vertices[l]];
        Some(Corner { tet, opposite, inside: Some(inside).filter(|edge| !self.edges.contains(edge)) })
    }
}

/// Changes what does not touch what is changed already; whether anything was.
fn part(mesh: &mut TetMesh, corners: &[Corner]) -> bool {
    let places = Places::of(mesh, corners);
    let mut touched = FxHashSet::default();
    let mut done = false;
    for corner in corners {
        if touched.contains(&corner.tet) {
            continue;
        }
        let mut ways: Vec<Change> = corner.opposite.iter().filter_map(|&v| places.flip(mesh, corner, v)).collect();
        ways.extend(corner.inside.and_then(|edge| places.split(mesh, edge)));
        // What is there already is worth more than a new vertex: the first of equals.
        let best = ways.into_iter().reduce(|best, way| if way.worst > best.worst { way } else { best });
        let Some(change) = best.or_else(|| split_tet(mesh, corner.tet)) else { continue };
        if change.old.iter().any(|tet| touched.contains(tet)) {
            continue;
        }
        touched.extend(change.old.iter().copied());
        change.apply(mesh);
        done = true;
    }
    done
}

/// Tetrahedra that take the place of others.
struct Change {
    old: Vec<usize>,
    new: Vec<[u32; 4]>,
    /// Where the next vertex is, which they have.
    vertex: Option<Point3>,
    /// The smallest radius ratio among the new ones.
    worst: f64,
}

impl Change {
    /// With the best of some places for a vertex; none when a tetrahedron is not positive at any.
    fn with_vertex(mesh: &TetMesh, old: Vec<usize>, new: Vec<[u32; 4]>, places: &[Point3]) -> Option<Self> {
        let ranked = places.iter().map(|&place| (worst(mesh, &new, Some(place)), place));
        // The first of equals.
        let (worst, place) = ranked.reduce(|best, x| if x.0 > best.0 { x } else { best })?;
        (worst > 0.0).then_some(Self { old, new, vertex: Some(place), worst })
    }

    fn apply(self, mesh: &mut TetMesh) {
        mesh.points.extend(self.vertex);
        let (kept, more) = self.new.split_at(self.old.len());
        for (&tet, &new) in self.old.iter().zip(kept) {
            mesh.tets[tet] = new;
        }
        mesh.tets.extend(more);
    }
}

/// Which tetrahedra are beside the corners.
struct Places {
    around: FxHashMap<[u32; 2], Vec<usize>>,
    beside: FxHashMap<[u32; 3], Vec<usize>>,
}

impl Places {
    fn of(mesh: &TetMesh, corners: &[Corner]) -> Self {
        let inside = corners.iter().filter_map(|corner| Some((corner.inside?, Vec::new())));
        let faces = corners.iter().flat_map(|c| c.opposite.map(|v| (face_without(mesh.tets[c.tet], v), Vec::new())));
        let mut places = Self { around: inside.collect(), beside: faces.collect() };
        for (i, tet) in mesh.tets.iter().enumerate() {
            for edge in edges(*tet) {
                if let Some(ring) = places.around.get_mut(&edge) {
                    ring.push(i);
                }
            }
            for &v in tet {
                if let Some(both) = places.beside.get_mut(&face_without(*tet, v)) {
                    both.push(i);
                }
            }
        }
        places
    }

    /// The face of a corner that lacks a vertex gives way to the edge from this vertex to the one behind the face.
    fn flip(&self, mesh: &TetMesh, corner: &Corner, vertex: u32) -> Option<Change> {
        let tet = mesh.tets[corner.tet];
        let face = face_without(tet, vertex);
        let behind = *self.beside.get(&face)?.iter().find(|&&t| t != corner.tet)?;
        let apex = *mesh.tets[behind].iter().find(|v| !face.contains(v))?;
        let new: Vec<[u32; 4]> = face.iter().map(|&lost| tet.map(|v| if v == lost { apex } else { v })).collect();
        let worst = worst(mesh, &new, None);
        (worst > 0.0).then(|| Change { old: vec![corner.tet, behind], new, vertex: None, worst })
    }

    /// An edge is split, and the tetrahedra around it in two each.
    fn split(&self, mesh: &TetMesh, edge: [u32; 2]) -> Option<Change> {
        let ring = self.around.get(&edge)?;
        let at = |v: u32| mesh.points[v as usize].coords;
        let middle = 0.5 * (at(edge[0]) + at(edge[1]));
        let all = ring.iter().flat_map(|&t| mesh.tets[t]).filter(|v| !edge.contains(v));
        let (sum, count) = all.fold((middle * 0.0, 0.0), |(sum, n), v| (sum + at(v), n + 1.0));
        let places = DRAWN.map(|share| Point3::from(middle + (sum / count - middle) * share));
        let next = mesh.points.len() as u32;
        let half = |lost: u32| ring.iter().map(move |&t| mesh.tets[t].map(|v| if v == lost { next } else { v }));
        Change::with_vertex(mesh, ring.clone(), half(edge[0]).chain(half(edge[1])).collect(), &places)
    }
}

/// A tetrahedron is split into four by a vertex in its middle.
fn split_tet(mesh: &TetMesh, tet: usize) -> Option<Change> {
    let vertices = mesh.tets[tet];
    let next = mesh.points.len() as u32;
    let sum = vertices.iter().fold(nalgebra::Vector3::zeros(), |sum, &v| sum + mesh.points[v as usize].coords);
    let quarters = vertices.iter().map(|&lost| vertices.map(|v| if v == lost { next } else { v })).collect();
    Change::with_vertex(mesh, vec![tet], quarters, &[Point3::from(sum / 4.0)])
}

/// The smallest radius ratio of tetrahedra, with the next vertex where it is said to be; zero when one is not positive.
fn worst(mesh: &TetMesh, tets: &[[u32; 4]], next: Option<Point3>) -> f64 {
    let corners = |tet: &[u32; 4]| tet.map(|v| mesh.points.get(v as usize).copied().or(next).unwrap_or_default());
    let ratio = |[a, b, c, d]: [Point3; 4]| {
        if orient3d(&a, &b, &c, &d) > 0.0 { radius_ratio(&a, &b, &c, &d) } else { 0.0 }
    };
    tets.iter().map(corners).map(ratio).fold(f64::INFINITY, f64::min)
}

/// The face of a tetrahedron that lacks a vertex.
fn face_without(tet: [u32; 4], vertex: u32) -> [u32; 3] {
    let k = tet.iter().position(|&v| v == vertex).unwrap_or(0);
    face_key([1, 2, 3].map(|j| tet[(k + j) % 4]))
}

fn edge_key([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn edges([a, b, c, d]: [u32; 4]) -> [[u32; 2]; 6] {
    [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]].map(edge_key)
}
