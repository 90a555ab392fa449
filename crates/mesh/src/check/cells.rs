//! Conditions on points and tetrahedra.

use super::result::{Line, LineResult, Offender, OffenderKind, Tally};
use crate::TetMesh;
use crate::adjacency::{NONE, TetAdjacency, face_vertices};
use crate::geometry::DisjointSets;
use crate::geometry::Point3;
use crate::geometry::place_key;
use crate::geometry::predicates::{in_exact_range, orient3d};
use crate::{face_key, same_turn, tet_key};
use rayon::prelude::*;

pub(super) fn centroid(points: &[Point3], ids: &[u32]) -> Point3 {
    let sum = ids.iter().fold(crate::geometry::Vec3::zeros(), |sum, &v| sum + points[v as usize].coords);
    Point3::from(sum / ids.len() as f64)
}

/// Mean of points.
pub(super) fn middle<'a>(points: impl IntoIterator<Item = &'a Point3>) -> Point3 {
    let sum = |(sum, n), p: &Point3| (sum + p.coords, n + 1.0);
    let (sum, n): (crate::geometry::Vec3, f64) = points.into_iter().fold((crate::geometry::Vec3::zeros(), 0.0), sum);
    Point3::from(sum / n)
}

fn tet_offender(mesh: &TetMesh, tet: u32) -> Offender {
    let place = centroid(&mesh.points, &mesh.tets[tet as usize]);
    Offender::new(OffenderKind::Tet, &[tet], Some(place))
}

pub(super) fn point_offender(points: &[Point3], point: u32) -> Offender {
    Offender::new(OffenderKind::Point, &[point], Some(points[point as usize]))
}

pub(super) fn not_empty(mesh: &TetMesh) -> LineResult {
    let mut tally = Tally::new(Line::NotEmpty);
    if mesh.tets.is_empty() {
        tally.add(|| Offender { kind: OffenderKind::Tet, ids: Vec::new(), position: None });
    }
    tally.done()
}

/// Finds points with coordinates that are not finite or for which the predicates are not exact.
pub(super) fn finite_points(mesh: &TetMesh) -> LineResult {
    let mut tally = Tally::new(Line::FinitePoints);
    for (i, p) in mesh.points.iter().enumerate() {
        if !p.iter().all(|&x| in_exact_range(x)) {
            tally.add(|| Offender::new(OffenderKind::Point, &[i as u32], None));
        }
    }
    tally.done()
}

pub(super) fn indices_in_range(mesh: &TetMesh) -> LineResult {
    let mut tally = Tally::new(Line::IndicesInRange);
    for (i, t) in mesh.tets.iter().enumerate() {
        if t.iter().any(|&v| v as usize >= mesh.points.len()) {
            tally.add(|| Offender::new(OffenderKind::Tet, &[i as u32], None));
        }
    }
    tally.done()
}

fn has_repeated_vertex(&[a, b, c, d]: &[u32; 4]) -> bool {
    a == b || a == c || a == d || b == c || b == d || c == d
}

fn no_repeated_vertex(mesh: &TetMesh) -> LineResult {
    let mut tally = Tally::new(Line::NoRepeatedVertex);
    for (i, _) in mesh.tets.iter().enumerate().filter(|(_, t)| has_repeated_vertex(t)) {
        tally.add(|| tet_offender(mesh, i as u32));
    }
    tally.done()
}

/// Finds tetrahedra that are not positive.
fn positive_tets(mesh: &TetMesh) -> LineResult {
    let positive = |&[a, b, c, d]: &[u32; 4]| {
        let p = |v: u32| &mesh.points[v as usize];
        orient3d(p(a), p(b), p(c), p(d)) > 0.0
    };
    let wrong: Vec<u32> = mesh
        .tets
        .par_iter()
        .enumerate()
        .with_min_len(1 << 14)
        .filter(|(_, t)| !positive(t))
        .map(|(i, _)| i as u32)
        .collect();
    let mut tally = Tally::new(Line::PositiveTets);
    for tet in wrong {
        tally.add(|| tet_offender(mesh, tet));
    }
    tally.done()
}

/// Finds duplicate tetrahedra. Two equal ones share all their faces, so only those with the same apex as a neighbour,
/// and those at crowded faces, are compared.
fn no_duplicate_tets(mesh: &TetMesh, adjacency: &TetAdjacency) -> LineResult {
    let mut suspects: Vec<u32> = adjacency.crowded.iter().map(|handle| handle / 4).collect();
    for (tet, row) in adjacency.neighbors.iter().enumerate() {
        let t = &mesh.tets[tet];
        let apex = |handle: u32| mesh.tets[handle as usize / 4][handle as usize % 4];
        if row.iter().enumerate().any(|(i, &n)| n != NONE && apex(n) == t[i]) {
            suspects.push(tet as u32);
        }
    }
    suspects.sort_unstable();
    suspects.dedup();
    suspects.sort_by_key(|&tet| tet_key(mesh.tets[tet as usize]));
    let mut tally = Tally::new(Line::NoDuplicateTets);
    for pair in suspects.windows(2) {
        if tet_key(mesh.tets[pair[0] as usize]) == tet_key(mesh.tets[pair[1] as usize]) {
            let place = centroid(&mesh.points, &mesh.tets[pair[0] as usize]);
            tally.add(|| Offender::new(OffenderKind::TetPair, pair, Some(place)));
        }
    }
    tally.done()
}

pub(super) fn face_offender(points: &[Point3], face: [u32; 3]) -> Offender {
    Offender::new(OffenderKind::Face, &face, Some(centroid(points, &face)))
}

fn faces_shared_by_two(mesh: &TetMesh, adjacency: &TetAdjacency) -> LineResult {
    let mut faces: Vec<[u32; 3]> =
        adjacency.crowded.iter().map(|&handle| face_key(face_vertices(&mesh.tets, handle))).collect();
    faces.sort_unstable();
    faces.dedup();
    let mut tally = Tally::new(Line::FacesSharedByTwo);
    for face in faces {
        tally.add(|| face_offender(&mesh.points, face));
    }
    tally.done()
}

/// Finds interior faces whose two tetrahedra lie on the same side: both see the face with the same orientation from
/// outside. For positive tetrahedra, this is the geometric condition.
fn opposite_sides(mesh: &TetMesh, adjacency: &TetAdjacency) -> LineResult {
    let mut tally = Tally::new(Line::OppositeSides);
    for (handle, &neighbor) in adjacency.neighbors.as_flattened().iter().enumerate() {
        if neighbor != NONE && (handle as u32) < neighbor {
            let face = face_vertices(&mesh.tets, handle as u32);
            if same_turn(face, face_vertices(&mesh.tets, neighbor)) {
                tally.add(|| face_offender(&mesh.points, face));
            }
        }
    }
    tally.done()
}

fn hash(p: &Point3) -> u64 {
    place_key(p).iter().fold(0, |h: u64, &x| (h.rotate_left(23) ^ x).wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

pub(super) fn no_duplicate_points(mesh: &TetMesh) -> LineResult {
    let mut order: Vec<(u64, u32)> = mesh.points.iter().enumerate().map(|(i, p)| (hash(p), i as u32)).collect();
    order.par_sort_unstable();
    let mut tally = Tally::new(Line::NoDuplicatePoints);
    for run in order.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        let mut points: Vec<([u64; 3], u32)> =
            run.iter().map(|&(_, i)| (place_key(&mesh.points[i as usize]), i)).collect();
        points.sort_unstable();
        for pair in points.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            tally.add(|| {
                Offender::new(OffenderKind::Edge, &[pair[0].1, pair[1].1], Some(mesh.points[pair[0].1 as usize]))
            });
        }
    }
    tally.done()
}

fn no_unused_points(mesh: &TetMesh) -> LineResult {
    let used = crate::adjacency::vertices_of(&mesh.tets, mesh.points.len());
    let mut tally = Tally::new(Line::NoUnusedPoints);
    for (i, _) in used.iter().enumerate().filter(|&(_, &used)| !used) {
        tally.add(|| point_offender(&mesh.points, i as u32));
    }
    tally.done()
}

/// Conditions on tetrahedra and their points, for a mesh with valid arrays.
pub(super) fn lines(mesh: &TetMesh, adjacency: &TetAdjacency) -> [LineResult; 6] {
    [
        no_repeated_vertex(mesh),
        no_duplicate_tets(mesh, adjacency),
        positive_tets(mesh),
        faces_shared_by_two(mesh, adjacency),
        opposite_sides(mesh, adjacency),
        no_unused_points(mesh),
    ]
}

/// First tetrahedron of each component. Components are tetrahedra of one region connected by faces.
pub(super) fn components(adjacency: &TetAdjacency, region: impl Fn(u32) -> i32) -> impl Iterator<Item = u32> {
    let n = adjacency.neighbors.len();
    let mut sets = DisjointSets::new(n);
    for (tet, row) in (0..).zip(&adjacency.neighbors) {
        for other in row.iter().filter(|&&handle| handle != NONE).map(|handle| handle / 4) {
            if other > tet && region(other) == region(tet) {
                sets.join(tet, other);
            }
        }
    }
    (0..n as u32).filter(move |&tet| sets.root(tet) == tet)
}

/// Total volume, summed in order.
pub(super) fn volume(mesh: &TetMesh) -> f64 {
    let p = |v: u32| &mesh.points[v as usize];
    let six = |&[a, b, c, d]: &[u32; 4]| crate::quality::volume6(p(a), p(b), p(c), p(d));
    mesh.tets.iter().map(six).sum::<f64>() / 6.0
}

#[cfg(test)]
#[path = "cells_tests.rs"]
mod tests;
