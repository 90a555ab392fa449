//! Tetrahedra with two faces on the boundary, as they are in the corner between wall and cap. All four vertices of such a one
//! are on the boundary: linear elements have nothing to solve for in it, and solvers by volumes find its matrix of faces all
//! but singular. One of its faces inside gives way to an edge, or its edge inside is split, whichever leaves the better
//! tetrahedra.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::quality::radius_ratio;
use anastomesh_mesh::{TetMesh, TriMesh, face_key};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// Maximum passes over tetrahedra with two boundary faces. One pass changes only tetrahedra that are not neighbours.
const MAX_CORNER_PASSES: usize = 8;
/// What tetrahedra with a new vertex are worth beside those without: they are smaller than what is around them.
const NEW: f64 = 0.85;
/// A corner stays where it would give way to a flatter tetrahedron than this, by its radius ratio.
const LEAST: f64 = 0.15;
/// Sweeps in which vertices next to what was changed are moved,
const SWEEPS: usize = 2;
/// and how far, as shares of the way to the middle of their neighbours.
const STEPS: [f64; 3] = [0.2, 0.5, 1.0];
/// How far a new vertex is drawn from its edge towards the middle of what is around it, one after the other.
const DRAWN: [f64; 4] = [0.0, 0.15, 0.3, 0.5];

/// Changes the tetrahedra inside a filled surface until none has two faces on the boundary, or all but; `outer` says of each triangle
/// whether it is on the boundary of the whole. The surface stays as it is, and its vertices keep their numbers.
pub(super) fn part_corners(mesh: &mut TetMesh, surface: &TriMesh, outer: impl Fn(usize) -> bool) {
    let outer = surface.triangles.iter().enumerate().filter(|(i, _)| outer(*i));
    let faces: FxHashSet<[u32; 3]> = outer.map(|(_, &triangle)| face_key(triangle)).collect();
    let inner = surface.points.len() as u32;
    let of = |mesh: &TetMesh, tet: usize| Corner::of(&faces, inner, mesh.tets[tet], tet);
    let mut changed: Vec<u32> = Vec::new();
    for _ in 0..MAX_CORNER_PASSES {
        let corners: Vec<Corner> = (0..mesh.tets.len()).filter_map(|tet| of(mesh, tet)).collect();
        changed.extend(corners.iter().flat_map(|corner| mesh.tets[corner.tet]));
        if corners.is_empty() || !part(mesh, &corners) {
            break;
        }
    }
    relax(mesh, inner, &changed);
}

/// Moves the vertices inside that are next to some others until no tetrahedron of theirs gains by it.
fn relax(mesh: &mut TetMesh, inner: u32, beside: &[u32]) {
    let is_beside = marked(mesh, beside.iter().copied());
    let mut stars: BTreeMap<u32, Vec<[u32; 4]>> = BTreeMap::new();
    for tet in mesh.tets.iter().filter(|tet| tet.iter().any(|&v| is_beside[v as usize])) {
        stars.extend(tet.iter().filter(|&&v| v >= inner).map(|&v| (v, Vec::new())));
    }
    let has_star = marked(mesh, stars.keys().copied());
    for tet in &mesh.tets {
        for v in tet.iter().filter(|&&v| has_star[v as usize]) {
            if let Some(star) = stars.get_mut(v) {
                star.push(*tet);
            }
        }
    }
    for _ in 0..SWEEPS {
        for (&v, star) in &stars {
            improve(mesh, v, star);
        }
    }
}

/// Moves a vertex towards the middle of its neighbours as far as the worst of its tetrahedra gains by it.
fn improve(mesh: &mut TetMesh, vertex: u32, star: &[[u32; 4]]) {
    let given = mesh.points[vertex as usize];
    let others = star.iter().flatten().filter(|&&v| v != vertex).map(|&v| mesh.points[v as usize].coords);
    let (sum, count) = others.fold((nalgebra::Vector3::zeros(), 0.0), |(sum, n), p| (sum + p, n + 1.0));
    let way = sum / count - given.coords;
    let mut best = (worst(mesh, star, None, 0.0).unwrap_or(0.0), given);
    for share in STEPS {
        let place = given + way * share;
        mesh.points[vertex as usize] = place;
        if let Some(found) = worst(mesh, star, None, best.0) {
            best = (found, place);
        }
    }
    mesh.points[vertex as usize] = best.1;
}

/// A tetrahedron with two faces on the boundary.
struct Corner {
    tet: usize,
    /// The edge that these two faces share: its other faces lack one vertex of it each.
    outside: [u32; 2],
    /// The edge that neither of the two has.
    inside: [u32; 2],
}

impl Corner {
    fn of(faces: &FxHashSet<[u32; 3]>, inner: u32, vertices: [u32; 4], tet: usize) -> Option<Self> {
        if vertices.iter().any(|&v| v >= inner) {
            return None;
        }
        // A face by the vertex that it lacks.
        let mut lacking = (0..4).filter(|&k| faces.contains(&face_key([1, 2, 3].map(|j| vertices[(k + j) % 4]))));
        let (i, j) = (lacking.next()?, lacking.next()?);
        let mut others = (0..4).filter(|&k| k != i && k != j).map(|k| vertices[k]);
        let outside = [others.next()?, others.next()?];
        Some(Self { tet, outside, inside: edge_key([vertices[i], vertices[j]]) })
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
        let mut ways: Vec<Change> = corner.outside.iter().filter_map(|&v| places.flip(mesh, corner, v)).collect();
        ways.extend(places.split(mesh, corner.inside));
        let worth = |way: &Change| way.worst * if way.vertex.is_some() { NEW } else { 1.0 };
        let best = ways.into_iter().reduce(|best, way| if worth(&way) > worth(&best) { way } else { best });
        let Some(change) = best.or_else(|| split_tet(mesh, corner.tet)).filter(|way| way.worst > LEAST) else {
            continue;
        };
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
        let mut best = None;
        for &place in places {
            let above = best.map_or(0.0, |(worst, _)| worst);
            best = worst(mesh, &new, Some(place), above).map(|worst| (worst, place)).or(best);
        }
        let (worst, place) = best?;
        Some(Self { old, new, vertex: Some(place), worst })
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
        let inside = corners.iter().map(|corner| (corner.inside, Vec::new()));
        let faces = corners.iter().flat_map(|c| c.outside.map(|v| (face_without(mesh.tets[c.tet], v), Vec::new())));
        let mut places = Self { around: inside.collect(), beside: faces.collect() };
        // Most tetrahedra have nothing to do with corners.
        let of_corner = marked(mesh, corners.iter().flat_map(|c| mesh.tets[c.tet]));
        let is_near = |tet: &[u32; 4]| tet.iter().filter(|&&v| of_corner[v as usize]).count() > 1;
        for (i, tet) in mesh.tets.iter().enumerate().filter(|(_, tet)| is_near(tet)) {
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
        let worst = worst(mesh, &new, None, 0.0)?;
        Some(Change { old: vec![corner.tet, behind], new, vertex: None, worst })
    }

    /// An edge is split, and the tetrahedra around it in two each; none when the edge is on the surface.
    fn split(&self, mesh: &TetMesh, edge: [u32; 2]) -> Option<Change> {
        let ring = self.around.get(&edge)?;
        let mut link: Vec<u32> = ring.iter().flat_map(|&t| mesh.tets[t]).filter(|v| !edge.contains(v)).collect();
        link.sort_unstable();
        if link.chunk_by(|a, b| a == b).any(|same| same.len() != 2) {
            return None;
        }
        let at = |v: u32| mesh.points[v as usize].coords;
        let middle = 0.5 * (at(edge[0]) + at(edge[1]));
        let around = link.iter().fold(middle * 0.0, |sum, &v| sum + at(v)) / link.len() as f64;
        let places = DRAWN.map(|share| Point3::from(middle + (around - middle) * share));
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

/// The smallest radius ratio of tetrahedra, with the next vertex where it is said to be; none when it is not above a bound, or
/// one of them is not positive.
fn worst(mesh: &TetMesh, tets: &[[u32; 4]], next: Option<Point3>, above: f64) -> Option<f64> {
    let corners = |tet: &[u32; 4]| tet.map(|v| mesh.points.get(v as usize).copied().or(next).unwrap_or_default());
    let mut worst = f64::INFINITY;
    for [a, b, c, d] in tets.iter().map(corners) {
        worst = worst.min(radius_ratio(&a, &b, &c, &d));
        if worst <= above {
            return None;
        }
    }
    tets.iter().map(corners).all(|[a, b, c, d]| orient3d(&a, &b, &c, &d) > 0.0).then_some(worst)
}

/// For each point of a mesh whether it is one of some vertices.
fn marked(mesh: &TetMesh, vertices: impl Iterator<Item = u32>) -> Vec<bool> {
    let mut marks = vec![false; mesh.points.len()];
    for v in vertices {
        marks[v as usize] = true;
    }
    marks
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
