//! Conditions on the boundary as a surface: closed, manifold, embedded, with the expected components and genera.

use crate::crossing::{crossings, winding};
use crate::exact::volume_sign;
use crate::faces::Boundary;
use crate::mesh::Mesh;
use crate::report::{Condition as C, Ids, Report};
use crate::sets::Sets;
use crate::sides::{EDGES, Side, Sides};
use crate::space::{Bounds, Point};
use itertools::Itertools as _;
use rstar::Envelope as _;

/// Checks the boundary, and compares it with the expectation of the file.
pub fn check(mesh: &Mesh, boundary: &Boundary, report: &mut Report) {
    let faces = &boundary.faces;
    let (mut surfaces, mut fans) = (Sets::new(faces.len()), Sets::new(3 * faces.len()));
    let mut wrong = Vec::new();
    let edges = Sides::new(faces, EDGES);
    for group in edges.groups() {
        // Corners of a face at both ends of an edge, that of the smaller vertex first.
        let ends = |side: &Side<2>| {
            let (from, to) = (side.1, side.1 / 3 * 3 + (side.1 + 1) % 3);
            if edges.is_odd(side) { [to, from] } else { [from, to] }
        };
        for (a, b) in group.iter().tuple_windows() {
            surfaces.join(a.1 / 3, b.1 / 3);
            std::iter::zip(ends(a), ends(b)).for_each(|(a, b)| fans.join(a, b));
        }
        if group.len() != 2 || edges.is_odd(&group[0]) == edges.is_odd(&group[1]) {
            wrong.push(Ids(group[0].0));
        }
    }
    report.add(C::BoundaryEdges, wrong);
    report.add(C::BoundaryFans, several_fans(faces, fans));
    let shown = |pair: [u32; 2]| pair.map(|i| Ids(faces[i as usize]).to_string()).join(" and ");
    report.add(C::NoSelfIntersection, crossings(&mesh.points, faces).into_iter().map(shown));
    if let Some(expected) = mesh.expected_loops.as_ref().map(Vec::len) {
        let found = report.figures.components;
        report.add(C::Components, (found != expected).then(|| format!("expected {expected}, found {found}")));
    }
    if report.holds(C::BoundaryEdges) && report.holds(C::BoundaryFans) {
        let surfaces = surfaces.groups();
        genera(mesh, boundary, &surfaces, report);
        if report.holds(C::NoSelfIntersection) {
            nesting(mesh, boundary, &surfaces, report);
        }
    }
}

/// Vertices whose faces form more than one fan.
fn several_fans(faces: &[[u32; 3]], fans: Sets) -> Vec<u32> {
    let (fan, _) = fans.numbered();
    let at = faces.as_flattened().iter().copied().zip(fan).sorted_unstable().dedup();
    at.map(|(vertex, _)| vertex).dedup_with_count().filter(|(count, _)| *count > 1).map(|(_, vertex)| vertex).collect()
}

/// Checks the genus of each component. Surfaces are lists of faces.
fn genera(mesh: &Mesh, boundary: &Boundary, surfaces: &[Vec<u32>], report: &mut Report) {
    let genus = |surface: &Vec<u32>| {
        let vertices = surface.iter().flat_map(|&i| boundary.faces[i as usize]).sorted_unstable().dedup().count();
        // The Euler characteristic is 2 - 2g. Each face has a half of three edges.
        (4 + surface.len() as i64 - 2 * vertices as i64) / 4
    };
    let genera: Vec<i64> = surfaces.iter().map(genus).collect();
    report.figures.genus = genera.iter().sum();
    let Some(expected) = &mesh.expected_loops else { return };
    let expected = expected.iter().copied().sorted_unstable().collect_vec();
    let mut found: Vec<Vec<i64>> = vec![Vec::new(); report.figures.components];
    for (surface, &genus) in surfaces.iter().zip(&genera) {
        found[boundary.component[surface[0] as usize] as usize].push(genus);
    }
    let others = found.iter().map(Vec::len).enumerate().filter(|(_, count)| *count != 1);
    let several = |(component, count)| format!("component {component} has {count} boundary surfaces");
    let mut violations = others.map(several).collect_vec();
    let found = found.concat().into_iter().sorted_unstable().collect_vec();
    if violations.is_empty() && found != expected {
        let differs = found.iter().zip(&expected).find(|(f, e)| f != e);
        let (f, e) = differs.map_or((found.len() as i64, expected.len() as i64), |(&f, &e)| (f, e));
        violations.push(format!("expected {e}, found {f}"));
    }
    report.add(C::Loops, violations);
}

/// Checks that every point of space is covered at most once. An outer surface must lie outside all others, and a cavity
/// inside exactly one.
fn nesting(mesh: &Mesh, boundary: &Boundary, surfaces: &[Vec<u32>], report: &mut Report) {
    let corners = |&i: &u32| boundary.faces[i as usize].map(|v| mesh.points[v as usize]);
    let own: Vec<Vec<[Point; 3]>> = surfaces.iter().map(|surface| surface.iter().map(corners).collect()).collect();
    let boxes: Vec<Bounds> = own.iter().map(|triangles| Bounds::from_points(triangles.as_flattened())).collect();
    let is_wrong = |&s: &usize| {
        let point = own[s][0][0];
        let others = (0..own.len()).filter(|&other| other != s && boxes[other].contains_point(&point));
        let depth: i32 = others.map(|other| winding(&point, &own[other])).sum();
        depth != i32::from(volume_sign(&point, &own[s]) < 0)
    };
    let first = |s: usize| Ids(boundary.faces[surfaces[s][0] as usize]);
    report.add(C::NoNesting, (0..own.len()).filter(is_wrong).map(|s| format!("surface of face {}", first(s))));
}
