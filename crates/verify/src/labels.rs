//! Conditions on labelled triangles, patches and caps.

use crate::faces::Boundary;
use crate::mesh::Mesh;
use crate::report::{Condition as C, Ids, Report};
use crate::sets::Sets;
use crate::sides::{EDGES, Side, Sides, is_odd, key};
use crate::space::{Point, cross, dot, minus};
use itertools::Itertools as _;
use std::array::from_fn;
use std::collections::HashSet;
use std::f64::consts::PI;

/// Id of the wall's patch.
pub const WALL: i64 = 1;
/// Maximum distance of a cap's vertices from their middle plane, in radii.
const FLATNESS: f64 = 1e-9;
/// Maximum relative change of a number rounded to 32 bits, and error of one computed with 64 bits.
const ROUNDING: [f64; 2] = [6e-8, 1e-15];
/// Beginnings of names of patches that consist of flat discs.
const FLAT: [&str; 3] = ["inlet", "outlet", "missing"];

/// Checks the labels of a mesh that has them.
pub fn check(mesh: &Mesh, boundary: &Boundary, report: &mut Report) {
    if mesh.triangles.is_empty() {
        return;
    }
    let are_inside = mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.points.len());
    report.add(C::LabelsMatchBoundary, differences(mesh, boundary).into_iter().map(Ids));
    if let Some(expected) = &mesh.expected_terminals {
        let mut found: Vec<i64> = mesh.caps.iter().map(|cap| cap.node).collect();
        let mut missing = expected.clone();
        found.retain(|node| missing.iter().position(|m| m == node).map(|at| missing.swap_remove(at)).is_none());
        report.add(C::CapPerTerminal, missing.iter().chain(&found).map(|node| format!("node {node}")));
    }
    let is_named = !mesh.patches.is_empty() || !mesh.caps.is_empty();
    if is_named && are_inside {
        patches(mesh, report);
        caps(mesh, report);
    }
}

/// Boundary faces without a label, and labelled triangles that are no boundary face, repeated or reversed. A mesh without
/// an expectation may label interior faces.
fn differences(mesh: &Mesh, boundary: &Boundary) -> Vec<[u32; 3]> {
    let may_be_inside = mesh.expected_loops.is_none();
    let is_allowed = |face: &[u32; 3]| may_be_inside && boundary.labelled_inside.binary_search(face).is_ok();
    let entry = |face: [u32; 3], is_label| (key(face), is_odd(face) && !mesh.is_undirected, is_label);
    let labels = mesh.triangles.iter().map(|&face| entry(face, true)).filter(|(face, ..)| !is_allowed(face));
    let real = boundary.faces.iter().map(|&face| entry(face, false));
    let all = real.chain(labels).sorted_unstable().collect_vec();
    let groups = all.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    let wrong = groups.filter(|group| !matches!(group, [(.., false), (.., true)]));
    wrong.map(|group| group[0].0).dedup().collect()
}

fn patches(mesh: &Mesh, report: &mut Report) {
    let (mut ids, mut names, mut with_caps) = (HashSet::new(), HashSet::new(), HashSet::from([WALL]));
    let mut equal: Vec<i64> = Vec::new();
    equal.extend(mesh.patches.iter().filter(|(id, _)| !ids.insert(*id)).map(|(id, _)| id));
    equal.extend(mesh.patches.iter().filter(|(_, name)| !names.insert(name)).map(|(id, _)| id));
    equal.extend(
        mesh.caps.iter().filter(|cap| !with_caps.insert(cap.patch) || !ids.contains(&cap.patch)).map(|cap| cap.patch),
    );
    report.add(C::OwnPatch, equal.iter().map(|id| format!("patch {id}")));
    let Some(terminals) = &mesh.expected_terminals else { return };
    // Outlets that share a patch have no caps of their own: then every named patch is allowed.
    let is_grouped = |(id, name): &(i64, String)| is_cap_name(name) && !with_caps.contains(id);
    if !terminals.is_empty() && mesh.patches.iter().any(is_grouped) {
        with_caps.extend(ids);
    }
    let unknown = mesh.labelled().filter(|(_, label)| !with_caps.contains(label));
    report.add(C::WallOrCap, unknown.map(|(face, label)| format!("patch {label} of face {}", Ids(face))));
}

fn is_cap_name(name: &str) -> bool {
    FLAT.iter().any(|start| name.starts_with(start))
}

/// Checks the shapes of caps, and of patches that are named like caps.
fn caps(mesh: &Mesh, report: &mut Report) {
    let labelled = mesh.labelled().filter(|(_, label)| *label != WALL);
    let triangles = labelled.map(|(face, label)| (label, face)).into_group_map();
    let of = |patch: i64| triangles.get(&patch).map_or(&[][..], Vec::as_slice);
    let mut violations: [Vec<String>; 5] = Default::default();
    let mut add = |holds: &[bool], place: String| {
        let violated = violations.iter_mut().zip(holds).filter(|(_, holds)| !**holds);
        violated.for_each(|(list, _)| list.push(place.clone()));
    };
    for cap in &mesh.caps {
        let own = of(cap.patch);
        let shape = Shape::of(&mesh.points, own, cap.center, Some(cap.normal), cap.radius);
        let is_one_disc = discs(own).len() == 1 && is_disc(own);
        let has_area = cap.radius.is_sign_positive() && (shape.area - PI).abs() <= 0.05 * PI;
        let holds = [is_one_disc, shape.is_flat(1.0), shape.off_centre <= 0.1, has_area, shape.faces_along];
        add(&holds, format!("patch {}", cap.patch));
    }
    let is_described = |id: i64| mesh.caps.iter().any(|cap| cap.patch == id);
    for (id, _) in mesh.patches.iter().filter(|(id, name)| is_cap_name(name) && !is_described(*id)) {
        for part in discs(of(*id)) {
            let center = mesh.points[part[0][0] as usize];
            let corners = part.iter().flatten().flat_map(|&v| minus(mesh.points[v as usize], center));
            let unit = corners.map(f64::abs).fold(0.0, f64::max);
            let shape = Shape::of(&mesh.points, &part, center, None, unit);
            let holds = [is_disc(&part), shape.is_flat((shape.area / PI).sqrt())];
            add(&holds, format!("patch {id} at face {}", Ids(part[0])));
        }
    }
    let conditions = [C::CapDisc, C::CapFlat, C::CapCentred, C::CapArea, C::CapNormal];
    let applicable = if mesh.caps.is_empty() { 2 } else { 5 };
    for (condition, list) in conditions.into_iter().zip(violations).take(applicable) {
        report.add(condition, list);
    }
}

/// Shape of triangles, with lengths in a unit.
struct Shape {
    area: f64,
    /// Distance of the centroid from the given centre.
    off_centre: f64,
    /// Half the extent along the normal.
    height: f64,
    /// Part of the extent that rounding of coordinates explains.
    rounding: f64,
    faces_along: bool,
}

impl Shape {
    /// Shape of triangles around a centre; without a normal, along their mean one.
    fn of(points: &[Point], triangles: &[[u32; 3]], center: Point, normal: Option<Point>, unit: f64) -> Self {
        let corner = |v: u32| minus(points[v as usize], center).map(|x| x / unit);
        let corners: Vec<[Point; 3]> = triangles.iter().map(|t| t.map(corner)).collect();
        // Half of the cross product is as long as the area.
        let areas = corners.iter().map(|[a, b, c]| cross(minus(*b, *a), minus(*c, *a)).map(|x| x / 2.0));
        let areas: Vec<Point> = areas.collect();
        let normal = normal.unwrap_or_else(|| areas.iter().fold([0.0; 3], |sum, a| from_fn(|k| sum[k] + a[k])));
        let length = dot(normal, normal).sqrt();
        let normal = normal.map(|x| x / length);
        let (mut area, mut moment) = (0.0, [0.0; 3]);
        for (t, own) in corners.iter().zip(areas.iter().map(|a| dot(*a, *a).sqrt())) {
            area += own;
            moment = t.iter().fold(moment, |moment, p| from_fn(|k| moment[k] + own / 3.0 * p[k]));
        }
        let heights = || corners.iter().flatten().map(|p| dot(*p, normal));
        let vertices = || triangles.iter().flatten().map(|&v| points[v as usize]);
        let is_rounded = vertices().flatten().all(|x| f64::from(x as f32) == x);
        let rounding = ROUNDING[usize::from(!is_rounded)];
        let shift = |p: Point| rounding * dot(p.map(|x| (x / unit).abs()), normal.map(f64::abs));
        Self {
            area,
            off_centre: dot(moment, moment).sqrt() / area,
            height: (heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min)) / 2.0,
            rounding: vertices().map(shift).fold(0.0, f64::max),
            faces_along: !areas.is_empty() && areas.iter().all(|&a| dot(a, normal) > 0.0),
        }
    }

    /// False without triangles.
    fn is_flat(&self, radius: f64) -> bool {
        self.area > 0.0 && self.height <= FLATNESS * radius + self.rounding
    }
}

/// Parts of triangles that are connected by edges.
fn discs(triangles: &[[u32; 3]]) -> Vec<Vec<[u32; 3]>> {
    let mut sets = Sets::new(triangles.len());
    for (a, b) in Sides::new(triangles, EDGES).groups().flat_map(|group| group.iter().tuple_windows()) {
        sets.join(a.1 / 3, b.1 / 3);
    }
    let triangle = |i: u32| triangles[i as usize];
    sets.groups().into_iter().map(|part| part.into_iter().map(triangle).collect()).collect()
}

/// True if triangles that are connected by edges form a disc: an oriented surface with a rim and the Euler number 1.
fn is_disc(triangles: &[[u32; 3]]) -> bool {
    let edges = Sides::new(triangles, EDGES);
    let is_sound = |group: &[Side<2>]| match group {
        [a, b] => edges.is_odd(a) != edges.is_odd(b),
        _ => group.len() == 1,
    };
    let has_rim = edges.groups().any(|group| group.len() == 1);
    let vertices = triangles.as_flattened().iter().unique().count();
    edges.groups().all(is_sound) && has_rim && vertices + triangles.len() == edges.groups().count() + 1
}
