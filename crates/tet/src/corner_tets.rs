//! Splitting of corner tetrahedra, which have two faces on the boundary. They occur where a wall meets a cap.
//!
//! All four vertices of a corner tetrahedron are on the boundary. Linear finite elements have no unknown inside it, and
//! finite volume solvers find its face matrix nearly singular. Either a flip replaces one of its inner faces by an edge, or
//! its inner edge is split, whichever leaves the better tetrahedra.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::quality::radius_ratio;
use anastomesh_mesh::{TetMesh, TriMesh, face_key};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// Maximum passes over tetrahedra with two boundary faces. One pass changes only tetrahedra that are not neighbours.
const MAX_CORNER_PASSES: usize = 8;
/// Factor on the radius ratio of tetrahedra with a new vertex: they are smaller than their neighbours.
const NEW_VERTEX_FACTOR: f64 = 0.85;
/// Smallest radius ratio that a change may leave; otherwise the corner stays.
const MIN_RATIO: f64 = 0.15;
/// Smoothing sweeps over the inner vertices next to changes.
const SWEEPS: usize = 2;
/// Lengths of smoothing steps to try, as shares of the distance to the centre of the neighbours.
const STEPS: [f64; 3] = [0.2, 0.5, 1.0];
/// Positions to try for a new vertex, as shares of the distance from the edge's midpoint to the centre of its link.
const LINK_SHARES: [f64; 4] = [0.0, 0.15, 0.3, 0.5];

/// Changes the tetrahedra of a filled surface until none, or few, have two boundary faces. `outer` is true for triangles on
/// the boundary of the final mesh. The surface and its vertex indices do not change.
pub fn split_corner_tets(mesh: &mut TetMesh, surface: &TriMesh, outer: impl Fn(usize) -> bool) {
    let outer = surface.triangles.iter().enumerate().filter(|(i, _)| outer(*i));
    let faces: FxHashSet<[u32; 3]> = outer.map(|(_, &triangle)| face_key(triangle)).collect();
    let inner = surface.points.len() as u32;
    let of = |mesh: &TetMesh, tet: usize| CornerTet::of(&faces, inner, mesh.tets[tet], tet);
    let mut changed: Vec<u32> = Vec::new();
    for _ in 0..MAX_CORNER_PASSES {
        let corners: Vec<CornerTet> = (0..mesh.tets.len()).filter_map(|tet| of(mesh, tet)).collect();
        changed.extend(corners.iter().flat_map(|corner| mesh.tets[corner.tet]));
        if corners.is_empty() || !split_disjoint(mesh, &corners) {
            break;
        }
    }
    smooth(mesh, inner, &changed);
}

/// Smooths the inner vertices of all tetrahedra at some vertices.
fn smooth(mesh: &mut TetMesh, inner: u32, beside: &[u32]) {
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

/// Moves a vertex towards the centre of its neighbours where that raises the worst radius ratio around it.
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

/// A tetrahedron with two boundary faces.
struct CornerTet {
    tet: usize,
    /// The edge that these two faces share: its other faces lack one vertex of it each.
    outside: [u32; 2],
    /// The edge that neither of the two has.
    inside: [u32; 2],
}

impl CornerTet {
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

/// Applies changes to disjoint sets of tetrahedra; returns whether there were any.
fn split_disjoint(mesh: &mut TetMesh, corners: &[CornerTet]) -> bool {
    let incidence = CornerIncidence::of(mesh, corners);
    let mut touched = FxHashSet::default();
    let mut done = false;
    for corner in corners {
        if touched.contains(&corner.tet) {
            continue;
        }
        let mut ways: Vec<LocalChange> =
            corner.outside.iter().filter_map(|&v| incidence.flip(mesh, corner, v)).collect();
        ways.extend(incidence.split(mesh, corner.inside));
        let worth = |way: &LocalChange| way.worst * if way.vertex.is_some() { NEW_VERTEX_FACTOR } else { 1.0 };
        let best = ways.into_iter().reduce(|best, way| if worth(&way) > worth(&best) { way } else { best });
        let Some(change) = best.or_else(|| split_tet(mesh, corner.tet)).filter(|way| way.worst > MIN_RATIO) else {
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

/// New tetrahedra for the region of old ones.
struct LocalChange {
    old: Vec<usize>,
    new: Vec<[u32; 4]>,
    /// Position of their new vertex, if they have one.
    vertex: Option<Point3>,
    /// The smallest radius ratio among the new ones.
    worst: f64,
}

impl LocalChange {
    /// Chooses the best of some positions for the new vertex. `None` if no position makes all tetrahedra positive.
    fn with_vertex(mesh: &TetMesh, old: Vec<usize>, new: Vec<[u32; 4]>, positions: &[Point3]) -> Option<Self> {
        let mut best = None;
        for &position in positions {
            let above = best.map_or(0.0, |(worst, _)| worst);
            best = worst(mesh, &new, Some(position), above).map(|worst| (worst, position)).or(best);
        }
        let (worst, position) = best?;
        Some(Self { old, new, vertex: Some(position), worst })
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

/// The tetrahedra at the inner edges and inner faces of corner tetrahedra.
struct CornerIncidence {
    around: FxHashMap<[u32; 2], Vec<usize>>,
    beside: FxHashMap<[u32; 3], Vec<usize>>,
}

impl CornerIncidence {
    fn of(mesh: &TetMesh, corners: &[CornerTet]) -> Self {
        let inside = corners.iter().map(|corner| (corner.inside, Vec::new()));
        let faces = corners.iter().flat_map(|c| c.outside.map(|v| (face_without(mesh.tets[c.tet], v), Vec::new())));
        let mut incidence = Self { around: inside.collect(), beside: faces.collect() };
        // Most tetrahedra have nothing to do with corners.
        let of_corner = marked(mesh, corners.iter().flat_map(|c| mesh.tets[c.tet]));
        let is_near = |tet: &[u32; 4]| tet.iter().filter(|&&v| of_corner[v as usize]).count() > 1;
        for (i, tet) in mesh.tets.iter().enumerate().filter(|(_, tet)| is_near(tet)) {
            for edge in edges(*tet) {
                if let Some(ring) = incidence.around.get_mut(&edge) {
                    ring.push(i);
                }
            }
            for &v in tet {
                if let Some(both) = incidence.beside.get_mut(&face_without(*tet, v)) {
                    both.push(i);
                }
            }
        }
        incidence
    }

    /// Replaces the corner's face opposite a vertex by the edge from this vertex to the one behind the face (2-3 flip).
    fn flip(&self, mesh: &TetMesh, corner: &CornerTet, vertex: u32) -> Option<LocalChange> {
        let tet = mesh.tets[corner.tet];
        let face = face_without(tet, vertex);
        let behind = *self.beside.get(&face)?.iter().find(|&&t| t != corner.tet)?;
        let apex = *mesh.tets[behind].iter().find(|v| !face.contains(v))?;
        let new: Vec<[u32; 4]> = face.iter().map(|&lost| tet.map(|v| if v == lost { apex } else { v })).collect();
        let worst = worst(mesh, &new, None, 0.0)?;
        Some(LocalChange { old: vec![corner.tet, behind], new, vertex: None, worst })
    }

    /// Splits an edge and each tetrahedron around it in two. `None` if the edge is on the surface.
    fn split(&self, mesh: &TetMesh, edge: [u32; 2]) -> Option<LocalChange> {
        let ring = self.around.get(&edge)?;
        let mut link: Vec<u32> = ring.iter().flat_map(|&t| mesh.tets[t]).filter(|v| !edge.contains(v)).collect();
        link.sort_unstable();
        if link.chunk_by(|a, b| a == b).any(|same| same.len() != 2) {
            return None;
        }
        let at = |v: u32| mesh.points[v as usize].coords;
        let middle = 0.5 * (at(edge[0]) + at(edge[1]));
        let around = link.iter().fold(middle * 0.0, |sum, &v| sum + at(v)) / link.len() as f64;
        let positions = LINK_SHARES.map(|share| Point3::from(middle + (around - middle) * share));
        let next = mesh.points.len() as u32;
        let half = |lost: u32| ring.iter().map(move |&t| mesh.tets[t].map(|v| if v == lost { next } else { v }));
        LocalChange::with_vertex(mesh, ring.clone(), half(edge[0]).chain(half(edge[1])).collect(), &positions)
    }
}

/// Splits a tetrahedron into four at its centroid.
fn split_tet(mesh: &TetMesh, tet: usize) -> Option<LocalChange> {
    let vertices = mesh.tets[tet];
    let next = mesh.points.len() as u32;
    let sum = vertices.iter().fold(nalgebra::Vector3::zeros(), |sum, &v| sum + mesh.points[v as usize].coords);
    let quarters = vertices.iter().map(|&lost| vertices.map(|v| if v == lost { next } else { v })).collect();
    LocalChange::with_vertex(mesh, vec![tet], quarters, &[Point3::from(sum / 4.0)])
}

/// Smallest radius ratio of tetrahedra, with the next vertex at `next`. `None` if it is at most `above`, or if a
/// tetrahedron is not positive.
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

/// Returns one flag per point of the mesh, true for the given vertices.
fn marked(mesh: &TetMesh, vertices: impl Iterator<Item = u32>) -> Vec<bool> {
    let mut marks = vec![false; mesh.points.len()];
    for v in vertices {
        marks[v as usize] = true;
    }
    marks
}

/// Returns the face opposite a vertex of a tetrahedron.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::cube;
    use crate::{Tetrahedralizer, certify};

    fn corner_count(mesh: &TetMesh, surface: &TriMesh, outer: impl Fn(usize) -> bool) -> usize {
        let outer = surface.triangles.iter().enumerate().filter(|(i, _)| outer(*i));
        let faces: FxHashSet<[u32; 3]> = outer.map(|(_, &triangle)| face_key(triangle)).collect();
        let boundary_faces = |tet: &[u32; 4]| tet.iter().filter(|&&v| faces.contains(&face_without(*tet, v))).count();
        mesh.tets.iter().filter(|tet| boundary_faces(tet) > 1).count()
    }

    #[test]
    fn a_filled_cube_loses_its_corner_tetrahedra_and_stays_certified() {
        let surface = cube(4);
        let mut mesh = Tetrahedralizer::new().run(&surface).unwrap().mesh;
        let before = corner_count(&mesh, &surface, |_| true);
        split_corner_tets(&mut mesh, &surface, |_| true);
        let after = corner_count(&mesh, &surface, |_| true);
        assert!(before > 0 && after < before, "{before} before, {after} after");
        assert_eq!(mesh.points[..surface.points.len()], surface.points);
        certify(&mesh, &surface).unwrap();
    }

    #[test]
    fn triangles_that_are_not_on_the_boundary_of_the_whole_make_no_corner() {
        let surface = cube(4);
        let given = Tetrahedralizer::new().run(&surface).unwrap().mesh;
        let mut mesh = given.clone();
        split_corner_tets(&mut mesh, &surface, |_| false);
        assert_eq!((mesh.points, mesh.tets), (given.points, given.tets));
    }
}
