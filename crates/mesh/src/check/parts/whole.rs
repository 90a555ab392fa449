//! Conditions on the whole.

use super::boxes::Boxes;
use super::glue::{Glued, Held, needs_sound_arrays};
use super::joints::Joined;
use super::nests;
use super::tallies::Tallies;
use super::walls::{self, Meetings, Reader};
use super::{HeldCap, Parts, PartsCheck, ids, joints};
use crate::Patch;
use crate::check::labels;
use crate::check::result::{
    CheckReport, Counts, Expectation, Intersection, Line, LineResult, Offender, OffenderKind, Skipped, Tally,
    components,
};
use crate::check::surface::{compare_loops, genus};
use crate::geometry::Aabb;
use rustc_hash::FxHashMap;
use std::io;

/// Conditions that together exclude equal points.
const EXCLUDE_EQUAL_POINTS: [Line; 8] = [
    Line::NoRepeatedVertex,
    Line::NoDuplicateTets,
    Line::PositiveTets,
    Line::FacesSharedByTwo,
    Line::OppositeSides,
    Line::BoundaryEdges,
    Line::BoundaryFans,
    Line::NoSelfIntersection,
];

/// Checks a mesh in parts. Holds about `memory` bytes of walls at a time (at least two walls), and about 200 bytes per
/// part. The result does not depend on the number of threads.
///
/// # Errors
/// Errors of reading the parts, and `InvalidData` if certificates, walls and joints are inconsistent.
pub fn check_parts(
    parts: &dyn Parts,
    patches: &[Patch],
    expectation: Option<&Expectation>,
    memory: usize,
) -> io::Result<PartsCheck> {
    Looked::at(parts, memory)?.check(patches, expectation)
}

/// First half of a check: reads the certificates and tests walls against each other. Callers that repair intersecting
/// walls skip the second half.
pub struct Looked<'a> {
    parts: &'a dyn Parts,
    held: Held,
    tallies: Tallies,
    /// Violated condition on the arrays of a part, if any; nothing else was tested then.
    unusable: Option<Line>,
    /// Boxes of the parts.
    boxes: Vec<Aabb>,
    /// Flags per joint, true for connected joints.
    is_joined: Vec<bool>,
    meetings: Meetings,
}

impl<'a> Looked<'a> {
    /// Reads and tests parts, with about `memory` bytes of walls at a time.
    ///
    /// # Errors
    /// As [`check_parts`].
    pub fn at(parts: &'a dyn Parts, memory: usize) -> io::Result<Self> {
        let mut tallies = Tallies::default();
        let (held, list) = Held::read(parts, &mut tallies)?;
        if held.is_empty() {
            tallies.add(Line::NotEmpty, Offender { kind: OffenderKind::Tet, ids: Vec::new(), position: None });
        }
        let unusable = tallies.first_of(&[Line::NotEmpty, Line::FinitePoints, Line::IndicesInRange]);
        let boxes = Boxes::new(if unusable.is_none() { list } else { Vec::new() });
        let is_joined = if unusable.is_none() { joints::flags(parts, &held)? } else { Vec::new() };
        let mut meetings = Meetings::default();
        if unusable.is_none() {
            let reader = Reader { parts, held: &held, is_joined: &is_joined };
            meetings = walls::meetings(reader, &boxes, memory)?;
            meetings.parts.sort_unstable();
        }
        Ok(Self { parts, held, tallies, unusable, boxes: boxes.into_vec(), is_joined, meetings })
    }

    fn reader(&self) -> Reader<'_> {
        Reader { parts: self.parts, held: &self.held, is_joined: &self.is_joined }
    }

    /// Pairs of parts with walls that intersect elsewhere than at the rims of their joints, ascending.
    pub fn meeting(&self) -> &[[u32; 2]] {
        &self.meetings.parts
    }

    /// Boxes of the parts.
    pub fn into_boxes(self) -> Vec<Aabb> {
        self.boxes
    }

    /// Second half of the check.
    ///
    /// # Errors
    /// As [`check_parts`].
    pub fn check(mut self, patches: &[Patch], expectation: Option<&Expectation>) -> io::Result<PartsCheck> {
        let counts = Counts { points: self.held.points as usize, tets: self.held.tets as usize, ..Counts::default() };
        if let Some(line) = self.unusable {
            let result = |l| {
                if needs_sound_arrays(l) {
                    LineResult::skipped(l, Skipped::Because(line))
                } else {
                    self.tallies.take(l)
                }
            };
            let lines = Line::ALL.into_iter().map(result).collect();
            return Ok(PartsCheck { report: CheckReport::new(counts, lines, None, Vec::new()), meeting: Vec::new() });
        }
        let joined = joints::check(self.parts, &self.held, &mut self.tallies)?;
        Whole { looked: self, patches, expectation, joined }.check(counts)
    }
}

struct Whole<'a> {
    looked: Looked<'a>,
    patches: &'a [Patch],
    expectation: Option<&'a Expectation>,
    joined: Joined,
}

impl Whole<'_> {
    fn check(mut self, mut counts: Counts) -> io::Result<PartsCheck> {
        // Consequences of joints are only checked if the joints are valid.
        let sound = self.joined.broken.is_none()
            && self.looked.tallies.first_of(&[Line::BoundaryFans, Line::LabelsMatchBoundary]).is_none();
        if sound {
            ids::check(self.looked.parts, &self.looked.held, &self.joined, &mut self.looked.tallies)?;
        }
        let glued = Glued::new(&self.looked.held, self.joined.pairs(self.looked.parts));
        let mut meetings = std::mem::take(&mut self.looked.meetings);
        let meeting = std::mem::take(&mut meetings.parts);
        let intersections = self.take_meetings(meetings);
        let roots: Vec<u32> = glued.surfaces().collect();
        let needed = [Line::PositiveTets, Line::BoundaryEdges, Line::NoSelfIntersection];
        if sound && roots.len() > 1 && self.looked.tallies.first_of(&needed).is_none() {
            let boxes = Boxes::new(std::mem::take(&mut self.looked.boxes));
            for offender in nests::within(self.looked.reader(), &glued, &boxes)? {
                self.looked.tallies.add(Line::NoSelfIntersection, offender);
            }
        }
        counts.points = ids::count(self.looked.parts, &self.looked.held, &self.joined) as usize;
        counts.volume = self.looked.held.volume;
        counts.components = glued.components;
        counts.boundary_components = roots.len();
        counts.boundary_faces = (0..self.looked.held.count())
            .map(|part| self.looked.held.faces_of(part, &self.looked.is_joined) as usize)
            .sum();
        counts.caps = self.patches.iter().filter(|patch| patch.cap.is_some()).count();
        let mut lines = vec![components(self.expectation, glued.components), self.loops(&glued, &roots)];
        // Distinct points follow from the other conditions, so this is not checked if one of them fails.
        if let Some(line) = self.joined.broken.or(self.looked.tallies.first_of(&EXCLUDE_EQUAL_POINTS))
            && !self.looked.tallies.fails(Line::NoDuplicatePoints)
        {
            lines.push(LineResult::skipped(Line::NoDuplicatePoints, Skipped::Because(line)));
        }
        lines.extend(self.labels());
        for line in Line::ALL {
            if lines.iter().all(|result| result.line != line) {
                lines.push(self.looked.tallies.take(line));
            }
        }
        let is_filled = self.looked.held.tets > 0;
        lines.retain(|result| is_filled || result.fails() || result.line.concerns_surfaces());
        let quality = is_filled.then(|| self.looked.held.quality.quality());
        let report = CheckReport::new(counts, lines, quality, intersections);
        Ok(PartsCheck { report, meeting })
    }

    /// All pairs of intersecting faces, ascending.
    fn take_meetings(&mut self, mut meetings: Meetings) -> Vec<Intersection> {
        let pair = |i: &Intersection| {
            let mut faces = i.faces.as_flattened().to_vec();
            if i.faces[0] == i.faces[1] {
                faces.truncate(3);
            }
            faces
        };
        meetings.intersections.sort_by_key(|(i, _)| (i.faces, i.kind));
        for (intersection, place) in &meetings.intersections {
            let offender = Offender::new(OffenderKind::FacePair, &pair(intersection), Some(*place));
            self.looked.tallies.add(Line::NoSelfIntersection, offender);
        }
        for (line, edges) in [(Line::BoundaryEdges, meetings.edges), (Line::NoDuplicatePoints, meetings.twins)] {
            let mut edges = edges;
            edges.sort_by_key(|edge| edge.0);
            edges.dedup_by_key(|edge| edge.0);
            for (edge, place) in edges {
                self.looked.tallies.add(line, Offender::new(OffenderKind::Edge, &edge, Some(place)));
            }
        }
        let mut all = std::mem::take(&mut self.looked.held.intersections);
        all.extend(meetings.intersections.into_iter().map(|(intersection, _)| intersection));
        all.sort_by_key(|i| (i.faces, i.kind));
        all
    }

    fn loops(&self, glued: &Glued, roots: &[u32]) -> LineResult {
        let Some(expected) = self.expectation else {
            return LineResult::skipped(Line::Loops, Skipped::NoExpectation);
        };
        let open = self.looked.tallies.first_of(&[Line::BoundaryEdges, Line::BoundaryFans]).or(self.joined.broken);
        if let Some(line) = open {
            return LineResult::skipped(Line::Loops, Skipped::Because(line));
        }
        let found = roots.iter().map(|&root| (genus(glued.euler(root)), root)).collect();
        compare_loops(&expected.loops, found, |root| self.surface_offender(glued, root))
    }

    /// Identifies a surface by the smallest of its parts' surface vertices.
    fn surface_offender(&self, glued: &Glued, root: u32) -> Offender {
        let named = |surface: u32| {
            let part = self.looked.held.part_of_surface(surface);
            (self.looked.parts.vertex(part, self.looked.held.surface(surface).vertex), part)
        };
        let (vertex, part) = glued.joined_to(root).map(named).min().unwrap_or_default();
        let place = || {
            let wall = self.looked.parts.wall(part).ok()?;
            let i = wall.vertices.iter().position(|&v| v == vertex)?;
            wall.points.get(i).copied()
        };
        Offender::new(OffenderKind::Point, &[vertex], place())
    }

    fn labels(&mut self) -> Vec<LineResult> {
        if let Some(lines) = labels::lines_without_caps(self.patches, self.expectation) {
            return lines;
        }
        let mut lines =
            vec![labels::own_patch(self.patches), labels::terminals_with_caps(self.patches, self.expectation)];
        lines.extend(self.caps());
        lines
    }

    /// Conditions on the shapes of caps, and caps without a patch.
    fn caps(&mut self) -> Vec<LineResult> {
        let mut tallies = labels::SHAPE_LINES.map(Tally::new);
        let mut by_node: FxHashMap<u32, Vec<(bool, &HeldCap)>> = FxHashMap::default();
        for cap in &self.looked.held.caps {
            by_node.entry(cap.node).or_default().push((false, cap));
        }
        for (patch, cap) in self.patches.iter().filter_map(|patch| Some((patch, patch.cap.as_ref()?))) {
            let held = by_node.get_mut(&cap.node).into_iter().flatten().filter(|(_, held)| held.is(cap));
            let mut shape = [false; 5];
            for (i, (named, held)) in held.enumerate() {
                *named = true;
                // Several caps are one patch in pieces.
                shape = if i == 0 { held.shape } else { [false; 5] };
            }
            for (tally, _) in tallies.iter_mut().zip(shape).filter(|(_, holds)| !holds) {
                tally.add(|| labels::patch_offender(patch.id, Some(cap)));
            }
        }
        let unnamed = self.looked.held.caps.iter().filter(|cap| {
            by_node.get(&cap.node).into_iter().flatten().any(|(named, held)| !named && std::ptr::eq(*held, *cap))
        });
        for cap in unnamed {
            let offender =
                Offender { kind: OffenderKind::Node, ids: vec![i64::from(cap.node)], position: Some(cap.center) };
            self.looked.tallies.add_some(Line::WallOrCap, u64::from(cap.faces), [offender]);
        }
        tallies.map(Tally::done).into()
    }
}

impl HeldCap {
    /// True for the disc of a cap of the same node.
    fn is(&self, cap: &crate::Cap) -> bool {
        let same = |a: &[f64; 3], b: &[f64]| a.iter().zip(b).all(|(x, y)| x.to_bits() == y.to_bits());
        self.radius.to_bits() == cap.radius.to_bits()
            && same(&self.center, cap.center.coords.as_slice())
            && same(&self.normal, cap.normal.as_slice())
    }
}
