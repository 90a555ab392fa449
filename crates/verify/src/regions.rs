//! Meshes with regions: each region is a mesh of its own, and faces between regions are labelled.

use crate::labels::WALL;
use crate::mesh::Mesh;
use crate::report::{Condition as C, Ids, Report};
use crate::sides::{FACES, is_odd, key};
use std::collections::HashSet;

/// Name of the region to which the expectation of a file applies.
pub const LUMEN: &str = "lumen";
/// Beginning of the names of interface patches.
const INTERFACE: &str = "interface_";

type Side = crate::sides::Side<3>;
type Sides<'a> = crate::sides::Sides<'a, 3, 4>;

/// Checks each region with `check`, and the labels of interfaces. Indices must be in range.
pub fn verify(mesh: &Mesh, report: &mut Report, check: impl Fn(&Mesh) -> Report) {
    let sides = Sides::new(&mesh.tets, FACES);
    interfaces(mesh, &sides, report);
    let is_named = |tet: &usize| mesh.regions.iter().any(|(id, _)| *id == mesh.region_of(*tet));
    let outside = (0..mesh.tets.len()).filter(|tet| !is_named(tet)).map(|tet| format!("tetrahedron {tet}"));
    let empty = mesh.regions.iter().filter(|(id, _)| !mesh.tet_regions.contains(id));
    report.add(C::RegionsNamed, outside.chain(empty.map(|(_, name)| format!("region {name} is empty"))));
    for (id, name) in &mesh.regions {
        let part = part(mesh, &sides, *id, name == LUMEN);
        if !part.tets.is_empty() {
            let mut found = check(&part);
            if mesh.expected_loops.is_none() {
                found.allow_touching();
            }
            report.merge(found, name);
        }
    }
}

/// Region of a side.
fn region(mesh: &Mesh, side: &Side) -> i64 {
    mesh.region_of(side.1 as usize / 4)
}

/// Smaller and larger region of a face between two.
fn regions(mesh: &Mesh, sides: &[Side]) -> Option<[i64; 2]> {
    let [a, b] = sides else { return None };
    let [a, b] = [a, b].map(|side| region(mesh, side));
    (a != b).then_some([a.min(b), a.max(b)])
}

fn interfaces(mesh: &Mesh, sides: &Sides, report: &mut Report) {
    let (mut labelled, mut wrong) = (HashSet::new(), Vec::new());
    for (triangle, label) in mesh.labelled() {
        let own = sides.of(triangle);
        let (pair, named) = (regions(mesh, own), named_pair(mesh, mesh.patch_name(label)));
        let mut add = |is_wrong: bool| wrong.extend(is_wrong.then(|| format!("{} of patch {label}", Ids(triangle))));
        add((own.len() == 2 && pair.is_none()) || (named.is_some() && named != pair));
        if let Some([smaller, _]) = pair {
            let is_out = |side: &Side| region(mesh, side) == smaller && sides.is_odd(side) == is_odd(triangle);
            add(!labelled.insert(key(triangle)) || !(mesh.is_undirected || own.iter().any(is_out)));
        }
    }
    // Files without expectation may leave all interfaces without a label.
    if !labelled.is_empty() || mesh.expected_loops.is_some() {
        let is_missing = |own: &&[Side]| regions(mesh, own).is_some() && !labelled.contains(&own[0].0);
        wrong.extend(sides.groups().filter(is_missing).map(|own| format!("{} without label", Ids(own[0].0))));
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
fn part(mesh: &Mesh, sides: &Sides, id: i64, is_lumen: bool) -> Mesh {
    let mut numbers = vec![u32::MAX; mesh.points.len()];
    let mut part = Mesh { is_undirected: mesh.is_undirected, ..Mesh::default() };
    for (_, tet) in mesh.tets.iter().enumerate().filter(|(i, _)| mesh.region_of(*i) == id) {
        for &v in tet {
            if numbers[v as usize] == u32::MAX {
                numbers[v as usize] = part.points.len() as u32;
                part.points.push(mesh.points[v as usize]);
            }
        }
        part.tets.push(tet.map(|v| numbers[v as usize]));
    }
    if !is_lumen || mesh.expected_loops.is_none() {
        return part;
    }
    for (triangle, label) in mesh.labelled() {
        let all = sides.of(triangle);
        let own: Vec<&Side> = all.iter().filter(|side| region(mesh, side) == id).collect();
        let [side] = own[..] else { continue };
        // The direction of an interface is checked with the others.
        let face = if all.len() == 2 { sides.vertices(side.1) } else { triangle };
        part.triangles.push(face.map(|v| numbers[v as usize]));
        let has_cap = mesh.caps.iter().any(|cap| cap.patch == label);
        let is_wall = !has_cap && mesh.patch_name(label).starts_with(INTERFACE);
        part.labels.push(if is_wall { WALL } else { label });
    }
    Mesh {
        patches: mesh.patches.clone(),
        caps: mesh.caps.clone(),
        expected_loops: mesh.expected_loops.clone(),
        expected_terminals: mesh.expected_terminals.clone(),
        ..part
    }
}
