//! Conditions on the boundary as a surface: closed, manifold, embedded, with the expected components and genera.

use crate::crossing::{crossings, winding};
use crate::exact::volume_sign;
use crate::faces::Boundary;
use crate::mesh::Mesh;
use crate::report::{Condition as C, Ids, Report};
use crate::sets::Sets;
use crate::space::{Bounds, Point};
use rstar::Envelope as _;

/// Checks the boundary, and compares it with the expectation of the file.
pub fn check(mesh: &Mesh, boundary: &Boundary, report: &mut Report) {
    let count = boundary.faces.len();
    let (mut surfaces, mut fans) = (Sets::new(count), Sets::new(3 * count));
    let edges = edges(&boundary.faces);
    let mut wrong = Vec::new();
    for group in edges.chunk_by(|a, b| a.ends == b.ends) {
        for pair in group.windows(2) {
            surfaces.join(pair[0].face, pair[1].face);
            for end in 0..2 {
                fans.join(pair[0].corners[end], pair[1].corners[end]);
            }
        }
        if group.len() != 2 || group[0].is_reversed == group[1].is_reversed {
            wrong.push(group[0].ends);
        }
    }
    report.add(C::BoundaryEdges, wrong.into_iter().map(Ids));
    let several = several_fans(&boundary.faces, fans);
    report.add(C::BoundaryFans, several);
    let crossings = crossings(&mesh.points, &boundary.faces);
    let shown = crossings.iter().map(|pair| pair.map(|i| Ids(boundary.faces[i as usize]).to_string()).join(" and "));
    report.add(C::NoSelfIntersection, shown);
    if let Some(expected) = &mesh.expected_loops {
        let found = report.figures.components;
        let differs = found != expected.len();
        report.add(C::Components, differs.then(|| format!("expected {}, found {found}", expected.len())));
    }
    if report.holds(C::BoundaryEdges) && report.holds(C::BoundaryFans) {
        let (surface, surface_count) = surfaces.numbered();
        genera(mesh, boundary, &surface, surface_count, report);
        if report.holds(C::NoSelfIntersection) {
            nesting(mesh, boundary, &surface, surface_count, report);
        }
    }
}

/// Side of a triangle.
pub struct Edge {
    /// Smaller and larger vertex.
    pub ends: [u32; 2],
    /// True if the triangle passes from the larger to the smaller vertex.
    pub is_reversed: bool,
    /// Number of the triangle.
    pub face: u32,
    /// Corners of the triangle at both ends.
    corners: [u32; 2],
}

/// Sides of triangles, sorted by their ends.
pub fn edges(faces: &[[u32; 3]]) -> Vec<Edge> {
    let vertices = faces.as_flattened();
    let edge = |from: u32| {
        let to = from / 3 * 3 + (from + 1) % 3;
        let [a, b] = [from, to].map(|corner| vertices[corner as usize]);
        let is_reversed = a > b;
        let (ends, corners) = if is_reversed { ([b, a], [to, from]) } else { ([a, b], [from, to]) };
        Edge { ends, is_reversed, face: from / 3, corners }
    };
    let mut edges: Vec<Edge> = (0..vertices.len() as u32).map(edge).collect();
    edges.sort_unstable_by_key(|edge| (edge.ends, edge.corners));
    edges
}

/// Vertices whose faces form more than one fan.
fn several_fans(faces: &[[u32; 3]], fans: Sets) -> Vec<u32> {
    let (fan, _) = fans.numbered();
    let mut at: Vec<(u32, u32)> = faces.as_flattened().iter().copied().zip(fan).collect();
    at.sort_unstable();
    at.dedup();
    at.chunk_by(|a, b| a.0 == b.0).filter(|fans| fans.len() > 1).map(|fans| fans[0].0).collect()
}

/// Checks the genus of each component.
fn genera(mesh: &Mesh, boundary: &Boundary, surface: &[u32], count: u32, report: &mut Report) {
    let (mut euler, mut owner) = (vec![0; count as usize], vec![0; count as usize]);
    let mut is_new = vec![true; mesh.points.len()];
    for (i, face) in boundary.faces.iter().enumerate() {
        let s = surface[i] as usize;
        // With one fan at each vertex, a vertex belongs to one surface. Each face has a half of three edges.
        euler[s] += 2 * face.iter().filter(|&&v| std::mem::take(&mut is_new[v as usize])).count() as i64 - 1;
        owner[s] = boundary.component[i] as usize;
    }
    // Here `euler` is twice the characteristic, 2 (2 - 2g).
    let genera: Vec<i64> = euler.iter().map(|e| (4 - e) / 4).collect();
    report.figures.genus = genera.iter().sum();
    let Some(expected) = &mesh.expected_loops else { return };
    let mut found: Vec<Vec<i64>> = vec![Vec::new(); report.figures.components];
    owner.iter().zip(&genera).for_each(|(&component, &genus)| found[component].push(genus));
    let mut violations: Vec<String> = Vec::new();
    for (component, genera) in found.iter().enumerate().filter(|(_, genera)| genera.len() != 1) {
        violations.push(format!("component {component} has {} boundary surfaces", genera.len()));
    }
    let (mut found, mut expected) = (found.concat(), expected.clone());
    found.sort_unstable();
    expected.sort_unstable();
    if violations.is_empty() && found != expected {
        let differs = found.iter().zip(&expected).find(|(f, e)| f != e);
        let [f, e] = differs.map_or([found.len() as i64, expected.len() as i64], |(&f, &e)| [f, e]);
        violations.push(format!("expected {e}, found {f}"));
    }
    report.add(C::Loops, violations);
}

/// Checks that every point of space is covered at most once. An outer surface must lie outside all others, and a cavity
/// inside exactly one.
fn nesting(mesh: &Mesh, boundary: &Boundary, surface: &[u32], count: u32, report: &mut Report) {
    let corners = |i: usize| boundary.faces[i].map(|v| mesh.points[v as usize]);
    let mut own: Vec<Vec<[Point; 3]>> = vec![Vec::new(); count as usize];
    surface.iter().enumerate().for_each(|(i, &s)| own[s as usize].push(corners(i)));
    let boxes: Vec<Bounds> = own.iter().map(|triangles| Bounds::from_points(triangles.as_flattened())).collect();
    let mut wrong = Vec::new();
    for (s, triangles) in own.iter().enumerate() {
        let point = triangles[0][0];
        let others = (0..own.len()).filter(|&other| other != s && boxes[other].contains_point(&point));
        let depth: i32 = others.map(|other| winding(&point, &own[other])).sum();
        if depth != i32::from(volume_sign(&point, triangles) < 0) {
            let first = surface.iter().position(|&own| own as usize == s).unwrap_or_default();
            wrong.push(format!("surface of face {}", Ids(boundary.faces[first])));
        }
    }
    report.add(C::NoNesting, wrong);
}
