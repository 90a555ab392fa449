//! Conditions on the boundary labels: wall and caps.

use super::cells::face_offender;
use super::result::{Expectation, Line, LineResult, Offender, OffenderKind, Skipped, Tally, without};
use crate::geometry::DisjointSets;
use crate::geometry::{Point3, Vec3};
use crate::quality::triangle_area_vector;
use crate::{Cap, Patch, VolumeMesh, WALL};
use crate::{face_key, same_turn};
use rustc_hash::FxHashMap;
use std::cmp::Ordering;
use std::f64::consts::PI;

/// Maximum distance of a cap's vertices from its plane, in radii.
const FLATNESS: f64 = 1e-9;
/// Maximum relative change of a coordinate rounded to 32 bits: half a unit in the last place.
const ROUNDED: f64 = 0.501 * f32::EPSILON as f64;
/// Relative error of a coordinate that was computed with 64 bits. It counts for caps of less than a millionth of their coordinates.
const COMPUTED: f64 = 4.0 * f64::EPSILON;
/// Maximum distance of a cap's centre from its node, in radii.
const OFF_CENTRE: f64 = 0.1;
/// Maximum relative difference of a cap's area from that of the disc.
pub(super) const AREA: f64 = 0.05;

/// Compares the labelled triangles with the faces of the boundary.
pub(super) fn labels_match(volume: &VolumeMesh, faces: &[[u32; 3]]) -> LineResult {
    let mut tally = Tally::new(Line::LabelsMatchBoundary);
    if volume.boundary == faces {
        return tally.done();
    }
    let points = &volume.mesh.points;
    let (real, labelled) = (by_vertices(faces), by_vertices(&volume.boundary));
    let (mut real, mut labelled) = (real.into_iter().peekable(), labelled.into_iter().peekable());
    loop {
        let first = match (real.peek(), labelled.peek()) {
            (None, None) => break,
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (Some(a), Some(b)) => a.0.cmp(&b.0),
        };
        let face = real.next_if(|_| first.is_le()).map(|(_, i)| faces[i as usize]);
        let label = labelled.next_if(|_| first.is_ge()).map(|(_, j)| volume.boundary[j as usize]);
        match (face, label) {
            (Some(face), Some(label)) if same_turn(face, label) => {}
            (_, Some(label)) => tally.add(|| face_at(points, label)),
            (Some(face), None) => tally.add(|| face_offender(points, face)),
            (None, None) => {}
        }
    }
    tally.done()
}

/// Offender for a labelled triangle, which may refer to missing points.
pub(super) fn face_at(points: &[Point3], face: [u32; 3]) -> Offender {
    if face.iter().all(|&v| (v as usize) < points.len()) {
        face_offender(points, face)
    } else {
        Offender::new(OffenderKind::Face, &face, None)
    }
}

/// Sorted vertices of the triangles with their indices, ascending.
fn by_vertices(triangles: &[[u32; 3]]) -> Vec<([u32; 3], u32)> {
    let mut keys: Vec<_> = triangles.iter().map(|&t| face_key(t)).zip(0..).collect();
    keys.sort_unstable();
    keys
}

/// All lines about labels.
pub(super) const LABEL_LINES: [Line; 9] = [
    Line::LabelsMatchBoundary,
    Line::WallOrCap,
    Line::OwnPatch,
    Line::CapPerTerminal,
    Line::CapDisc,
    Line::CapFlat,
    Line::CapCentred,
    Line::CapArea,
    Line::CapNormal,
];

/// Conditions on patches and caps; the labelled triangles must refer to existing points.
pub(super) fn cap_lines(volume: &VolumeMesh, expectation: Option<&Expectation>) -> Vec<LineResult> {
    if let Some(lines) = lines_without_caps(&volume.patches, expectation) {
        return lines;
    }
    let mut lines = vec![own_patch(&volume.patches), wall_or_cap(volume)];
    lines.push(terminals_with_caps(&volume.patches, expectation));
    lines.extend(cap_shapes(volume));
    lines
}

/// Name, or beginning of the name, of a patch with several outlets. It has no cap of its own.
const GROUP: &str = "outlets";

/// Conditions on patches and caps for boundaries labelled by others, without cap data. Likewise if outlets are grouped.
pub(super) fn lines_without_caps(patches: &[Patch], expectation: Option<&Expectation>) -> Option<Vec<LineResult>> {
    let no_caps = patches.iter().all(|patch| patch.cap.is_none());
    let grouped = patches.iter().any(|patch| patch.name.starts_with(GROUP) && patch.cap.is_none());
    if !(no_caps || grouped) || expectation.is_some_and(|expected| expected.terminals.is_empty()) {
        return None;
    }
    let mut lines = vec![own_patch(patches)];
    let of_caps = LABEL_LINES.into_iter().filter(|line| !matches!(line, Line::LabelsMatchBoundary | Line::OwnPatch));
    lines.extend(of_caps.map(|line| LineResult::skipped(line, Skipped::NoCaps)));
    if let Some(expected) = expectation {
        lines[2] = cap_per_terminal(patches, expected);
    }
    Some(lines)
}

pub(super) fn terminals_with_caps(patches: &[Patch], expectation: Option<&Expectation>) -> LineResult {
    match expectation {
        Some(expected) => cap_per_terminal(patches, expected),
        None => LineResult::skipped(Line::CapPerTerminal, Skipped::NoExpectation),
    }
}

fn wall_or_cap(volume: &VolumeMesh) -> LineResult {
    let mut caps: Vec<i32> = volume.patches.iter().filter(|p| p.cap.is_some()).map(|p| p.id).collect();
    caps.sort_unstable();
    let mut tally = Tally::new(Line::WallOrCap);
    for (i, &face) in volume.boundary.iter().enumerate() {
        let known = volume.boundary_patch.get(i).is_some_and(|&id| id == WALL || caps.binary_search(&id).is_ok());
        if !known {
            tally.add(|| face_at(&volume.mesh.points, face));
        }
    }
    tally.done()
}

pub(super) fn patch_offender(id: i32, cap: Option<&Cap>) -> Offender {
    Offender { kind: OffenderKind::Patch, ids: vec![i64::from(id)], position: cap.map(|cap| cap.center.coords.into()) }
}

pub(super) fn own_patch(patches: &[Patch]) -> LineResult {
    let mut tally = Tally::new(Line::OwnPatch);
    let mut by_id: Vec<&Patch> = patches.iter().collect();
    by_id.sort_by_key(|patch| patch.id);
    for pair in by_id.windows(2).filter(|pair| pair[0].id == pair[1].id) {
        tally.add(|| patch_offender(pair[1].id, pair[1].cap.as_ref()));
    }
    by_id.sort_by(|a, b| a.name.cmp(&b.name));
    for pair in by_id.windows(2).filter(|pair| pair[0].name == pair[1].name && pair[0].id != pair[1].id) {
        tally.add(|| patch_offender(pair[1].id, pair[1].cap.as_ref()));
    }
    for patch in patches.iter().filter(|p| p.id == WALL && p.cap.is_some()) {
        tally.add(|| patch_offender(patch.id, patch.cap.as_ref()));
    }
    tally.done()
}

/// Finds terminals with no cap or several, and caps of nodes that are no terminals.
fn cap_per_terminal(patches: &[Patch], expected: &Expectation) -> LineResult {
    let mut caps: Vec<u32> = patches.iter().filter_map(|p| p.cap.map(|cap| cap.node)).collect();
    let mut terminals = expected.terminals.clone();
    caps.sort_unstable();
    terminals.sort_unstable();
    let mut unmatched = [without(&terminals, &caps), without(&caps, &terminals)].concat();
    unmatched.sort_unstable();
    let mut tally = Tally::new(Line::CapPerTerminal);
    for node in unmatched {
        tally.add(|| Offender::new(OffenderKind::Node, &[node], None));
    }
    tally.done()
}

/// Checks the shape of every cap.
fn cap_shapes(volume: &VolumeMesh) -> Vec<LineResult> {
    let mut tallies = SHAPE_LINES.map(Tally::new);
    let triangles = triangles_by_patch(volume);
    for patch in &volume.patches {
        let Some(cap) = &patch.cap else { continue };
        let own = triangles.get(&patch.id).map_or(&[][..], Vec::as_slice);
        let holds = cap_shape(&volume.mesh.points, cap, own);
        for (tally, _) in tallies.iter_mut().zip(holds).filter(|(_, holds)| !holds) {
            tally.add(|| patch_offender(patch.id, Some(cap)));
        }
    }
    tallies.map(Tally::done).into()
}

/// Conditions on the shape of a cap.
pub(super) const SHAPE_LINES: [Line; 5] =
    [Line::CapDisc, Line::CapFlat, Line::CapCentred, Line::CapArea, Line::CapNormal];

/// Result of each of `SHAPE_LINES` for a cap with these triangles.
pub(super) fn cap_shape(points: &[Point3], cap: &Cap, triangles: &[[u32; 3]]) -> [bool; 5] {
    let shape = CapShape::measure(points, cap, triangles);
    let disc = PI * cap.radius * cap.radius;
    [
        is_disc(triangles),
        shape.off_plane <= FLATNESS * cap.radius + shape.rounding,
        shape.off_centre <= OFF_CENTRE * cap.radius,
        (shape.area - disc).abs() <= AREA * disc,
        shape.faces_outwards,
    ]
}

/// Triangles of each patch except the wall, in file order.
fn triangles_by_patch(volume: &VolumeMesh) -> FxHashMap<i32, Vec<[u32; 3]>> {
    let mut triangles: FxHashMap<i32, Vec<[u32; 3]>> = FxHashMap::default();
    for (&face, &id) in volume.boundary.iter().zip(&volume.boundary_patch) {
        if id != WALL {
            triangles.entry(id).or_default().push(face);
        }
    }
    triangles
}

struct CapShape {
    area: f64,
    /// Distance of the disc's centroid from the node.
    off_centre: f64,
    /// Maximum distance of a vertex from the middle plane of the vertices, along the cap's normal.
    off_plane: f64,
    /// Maximum shift of a vertex along the normal by rounding. Coordinates of 32 bits bend every cap that is not perpendicular to
    /// an axis.
    rounding: f64,
    faces_outwards: bool,
}

impl CapShape {
    fn measure(points: &[Point3], cap: &Cap, triangles: &[[u32; 3]]) -> Self {
        let (mut area, mut moment) = (0.0, Vec3::zeros());
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut is_rounded, mut shift) = (true, 0.0_f64);
        let mut faces_outwards = !triangles.is_empty();
        for t in triangles {
            let corners = t.map(|v| &points[v as usize]);
            let normal = triangle_area_vector(corners[0], corners[1], corners[2]);
            faces_outwards &= normal.dot(&cap.normal) > 0.0;
            let a = normal.norm();
            area += a;
            for p in corners {
                let from_node = p - cap.center;
                moment += from_node * (a / 3.0);
                let height = from_node.dot(&cap.normal);
                (low, high) = (low.min(height), high.max(height));
                is_rounded &= p.coords.iter().all(|&x| f64::from(x as f32).to_bits() == x.to_bits());
                shift = shift.max(p.coords.abs().dot(&cap.normal.abs()));
            }
        }
        // A cap without triangles or area fails every condition.
        Self {
            area,
            off_centre: (moment / area).norm(),
            off_plane: 0.5 * (high - low).abs(),
            rounding: shift * if is_rounded { ROUNDED } else { COMPUTED },
            faces_outwards,
        }
    }
}

/// True if triangles form one disc: connected by edges, with a boundary and the Euler number 1. Every edge is in one triangle,
/// or in two with opposite directions. Without a boundary, it would be a sphere that touches itself at a vertex.
pub(super) fn is_disc(triangles: &[[u32; 3]]) -> bool {
    let Ok(count) = u32::try_from(triangles.len()) else { return false };
    let mut directed: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    let mut vertices: Vec<u32> = triangles.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    for (t, i) in (0..count).flat_map(|t| (0..3).map(move |i| (t, i))) {
        let face = triangles[t as usize];
        directed.push(([face[i], face[(i + 1) % 3]], t));
    }
    directed.sort_unstable();
    if directed.windows(2).any(|pair| pair[0].0 == pair[1].0) {
        return false;
    }
    let find = |edge: [u32; 2]| directed.binary_search_by_key(&edge, |entry| entry.0).ok().map(|i| directed[i].1);
    let mut sets = DisjointSets::new(triangles.len());
    let mut rim = 0;
    for &([a, b], t) in &directed {
        match find([b, a]) {
            Some(other) => sets.join(t, other),
            None => rim += 1,
        }
    }
    let connected = (0..count).all(|t| sets.root(t) == 0);
    let edges = usize::midpoint(directed.len(), rim);
    connected && vertices.len() + triangles.len() == edges + 1 && rim > 0
}

#[cfg(test)]
#[path = "labels_tests.rs"]
mod tests;
