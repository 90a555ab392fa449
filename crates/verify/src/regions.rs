//! Meshes with regions: each region is a mesh of its own, and faces between regions are labelled.

use crate::faces::{SIDES, is_odd, key};
use crate::labels::WALL;
use crate::mesh::Mesh;
use crate::report::{Condition as C, Ids, Report};
use std::collections::HashMap;

/// Name of the region to which the expectation of a file applies.
pub const LUMEN: &str = "lumen";
/// Beginning of the names of interface patches.
const INTERFACE: &str = "interface_";

/// Checks each region with `check`, and the labels of interfaces. Indices must be in range.
pub fn verify(mesh: &Mesh, report: &mut Report, check: impl Fn(&Mesh) -> Report) {
    let faces = faces(mesh);
    interfaces(mesh, &faces, report);
    let ids: Vec<i64> = mesh.regions.iter().map(|(id, _)| *id).collect();
    let outside = (0..mesh.tets.len()).filter(|&tet| !ids.contains(&mesh.region_of(tet)));
    let empty = mesh.regions.iter().filter(|(id, _)| !mesh.tet_regions.contains(id));
    let empty = empty.map(|(_, name)| format!("region {name} is empty"));
    report.add(C::RegionsNamed, outside.map(|tet| format!("tetrahedron {tet}")).chain(empty));
    for (id, name) in &mesh.regions {
        let part = part(mesh, &faces, *id, name == LUMEN);
        if !part.tets.is_empty() {
            let mut found = check(&part);
            if mesh.expected_loops.is_none() {
                found.allow_touching();
            }
            report.merge(found, name);
        }
    }
}

/// Tetrahedra at each face, with the vertices as seen from outside of each.
type Faces = HashMap<[u32; 3], Vec<(usize, [u32; 3])>>;

fn faces(mesh: &Mesh) -> Faces {
    let mut faces = Faces::new();
    for (tet, t) in mesh.tets.iter().enumerate() {
        for face in SIDES.map(|side| side.map(|i| t[i])) {
            faces.entry(key(face)).or_default().push((tet, face));
        }
    }
    faces
}

/// Smaller and larger region of a face between two.
fn regions(mesh: &Mesh, sides: &[(usize, [u32; 3])]) -> Option<[i64; 2]> {
    let [a, b] = sides else { return None };
    let [a, b] = [a, b].map(|side| mesh.region_of(side.0));
    (a != b).then_some([a.min(b), a.max(b)])
}

fn interfaces(mesh: &Mesh, faces: &Faces, report: &mut Report) {
    let mut labelled: HashMap<[u32; 3], usize> = HashMap::new();
    let mut wrong = Vec::new();
    for (&triangle, label) in mesh.triangles.iter().zip(&mesh.labels) {
        let sides = faces.get(&key(triangle)).map_or(&[][..], Vec::as_slice);
        let pair = regions(mesh, sides);
        let name = mesh.patches.iter().find(|(id, _)| id == label).map_or("", |(_, name)| name.as_str());
        let named = named_pair(mesh, name);
        if (sides.len() == 2 && pair.is_none()) || (named.is_some() && named != pair) {
            wrong.push(format!("{} of patch {label}", Ids(triangle)));
        }
        let Some([smaller, _]) = pair else { continue };
        let out = sides.iter().find(|side| mesh.region_of(side.0) == smaller);
        let is_out = mesh.is_undirected || out.is_some_and(|(_, face)| is_odd(*face) == is_odd(triangle));
        let count = labelled.entry(key(triangle)).or_default();
        *count += 1;
        if *count > 1 || !is_out {
            wrong.push(format!("{} of patch {label}", Ids(triangle)));
        }
    }
    // Files without expectation may leave all interfaces without a label.
    if !labelled.is_empty() || mesh.expected_loops.is_some() {
        let is_missing =
            |(face, sides): &(&[u32; 3], &Vec<_>)| regions(mesh, sides).is_some() && !labelled.contains_key(*face);
        let mut missing: Vec<[u32; 3]> = faces.iter().filter(is_missing).map(|(face, _)| *face).collect();
        missing.sort_unstable();
        wrong.extend(missing.into_iter().map(|face| format!("{} without label", Ids(face))));
    }
    report.add(C::Interfaces, wrong);
}

/// Regions of a patch named `interface_A_B`, the smaller id first.
fn named_pair(mesh: &Mesh, patch: &str) -> Option<[i64; 2]> {
    let rest = patch.strip_prefix(INTERFACE)?;
    mesh.regions.iter().find_map(|(a, first)| {
        let second = rest.strip_prefix(first.as_str())?.strip_prefix('_')?;
        let (b, _) = mesh.regions.iter().find(|(_, name)| name == second)?;
        Some([*a.min(b), *a.max(b)])
    })
}

/// A region as a mesh. Only the lumen has the labels, caps and expectation of a network; its interfaces without a cap are
/// wall.
fn part(mesh: &Mesh, faces: &Faces, id: i64, is_lumen: bool) -> Mesh {
    let mut numbers = vec![u32::MAX; mesh.points.len()];
    let mut part = Mesh { is_undirected: mesh.is_undirected, ..Mesh::default() };
    let tets: Vec<usize> = (0..mesh.tets.len()).filter(|&tet| mesh.region_of(tet) == id).collect();
    for &tet in &tets {
        let own = mesh.tets[tet].map(|v| {
            let number = &mut numbers[v as usize];
            if *number == u32::MAX {
                *number = part.points.len() as u32;
                part.points.push(mesh.points[v as usize]);
            }
            *number
        });
        part.tets.push(own);
    }
    if !is_lumen || mesh.expected_loops.is_none() {
        return part;
    }
    let has_cap = |label: i64| mesh.caps.iter().any(|cap| cap.patch == label);
    for (&triangle, &label) in mesh.triangles.iter().zip(&mesh.labels) {
        let sides = faces.get(&key(triangle)).map_or(&[][..], Vec::as_slice);
        let own: Vec<_> = sides.iter().filter(|side| mesh.region_of(side.0) == id).collect();
        let ([(_, outwards)], is_interface) = (&own[..], sides.len() == 2) else { continue };
        let name = mesh.patches.iter().find(|(patch, _)| *patch == label).map_or("", |(_, name)| name.as_str());
        let is_wall = !has_cap(label) && name.starts_with(INTERFACE);
        // The direction of an interface is checked with the others.
        let face = if is_interface { *outwards } else { triangle };
        part.triangles.push(face.map(|v| numbers[v as usize]));
        part.labels.push(if is_wall { WALL } else { label });
    }
    part.patches.clone_from(&mesh.patches);
    part.caps.clone_from(&mesh.caps);
    part.expected_loops.clone_from(&mesh.expected_loops);
    part.expected_terminals.clone_from(&mesh.expected_terminals);
    part
}
