//! The lines of the whole.

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

/// The lines from which it follows that no two points are equal.
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

/// Checks a mesh that is made of parts. Of walls some `memory` bytes are held at a time (two walls at least), of every
/// part some 300 bytes. The result does not depend on the number of threads.
///
/// # Errors
/// What reading the parts fails with, and `InvalidData` where certificates, walls and joints do not belong together.
pub fn check_parts(
    parts: &dyn Parts,
    patches: &[Patch],
    expectation: Option<&Expectation>,
    memory: usize,
) -> io::Result<PartsCheck> {
    Looked::at(parts, memory)?.check(patches, expectation)
}

/// The first half of a check: certificates are read, walls are held against each other. Whoever has something to do about
/// walls that meet does without the second half.
pub struct Looked<'a> {
    parts: &'a dyn Parts,
    held: Held,
    tallies: Tallies,
    /// A line about the arrays of a part that is broken: then nothing else was looked at.
    unusable: Option<Line>,
    boxes: Boxes,
    /// For each joint whether it is joined to something.
    is_joined: Vec<bool>,
    meetings: Meetings,
}

impl<'a> Looked<'a> {
    /// Looks at parts, with some `memory` bytes of walls at a time.
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
        let mut looked = Self { parts, held, tallies, unusable, boxes, is_joined, meetings: Meetings::default() };
        if unusable.is_none() {
            looked.meetings = walls::meetings(looked.reader(), &looked.boxes, memory)?;
            looked.meetings.parts.sort_unstable();
        }
        Ok(looked)
    }

    fn reader(&self) -> Reader<'_> {
        Reader { parts: self.parts, held: &self.held, is_joined: &self.is_joined }
    }

    /// Pairs of parts whose walls meet elsewhere than at the rims of their joints, ascending.
    pub fn meeting(&self) -> &[[u32; 2]] {
        &self.meetings.parts
    }

    /// The boxes of the parts.
    pub fn into_boxes(self) -> Vec<Aabb> {
        self.boxes.into_vec()
    }

    /// The rest of the check.
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
        // What follows from joints is only looked at where they are sound.
        let sound = self.joined.broken.is_none()
            && self.looked.tallies.first_of(&[Line::BoundaryFans, Line::LabelsMatchBoundary]).is_none();
        if sound {
            ids::check(self.looked.parts, &self.looked.held, &self.joined, &mut self.looked.tallies)?;
        }
        let glued = Glued::new(&self.looked.held, &self.joined.pairs);
        let mut meetings = std::mem::take(&mut self.looked.meetings);
        let meeting = std::mem::take(&mut meetings.parts);
        let intersections = self.take_meetings(meetings);
        let roots: Vec<u32> = glued.surfaces().collect();
        let needed = [Line::PositiveTets, Line::BoundaryEdges, Line::NoSelfIntersection];
        if sound && roots.len() > 1 && self.looked.tallies.first_of(&needed).is_none() {
            for offender in nests::within(self.looked.reader(), &glued, &self.looked.boxes)? {
                self.looked.tallies.add(Line::NoSelfIntersection, offender);
            }
        }
        counts.points = ids::count(&self.looked.held, &self.joined) as usize;
        counts.volume = self.looked.held.volume;
        counts.components = glued.components;
        counts.boundary_components = roots.len();
        counts.boundary_faces = (0..self.looked.held.count())
            .map(|part| self.looked.held.faces_of(part, &self.looked.is_joined) as usize)
            .sum();
        counts.caps = self.patches.iter().filter(|patch| patch.cap.is_some()).count();
        let mut lines = vec![components(self.expectation, glued.components), self.loops(&glued, &roots)];
        // That no points are equal follows from the other lines: when one of them fails, it has not been shown.
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
        lines.retain(|result| is_filled || result.line.concerns_surfaces());
        let quality = is_filled.then(|| self.looked.held.quality.quality());
        let report = CheckReport::new(counts, lines, quality, intersections);
        Ok(PartsCheck { report, meeting })
    }

    /// All pairs of faces that meet, ascending.
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

    /// A surface is named by the smallest of the vertices that name its parts' surfaces.
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

    /// The lines about the shapes of caps, and caps that no patch names.
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
                // Several are one patch in pieces.
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
    fn is(&self, cap: &crate::Cap) -> bool {
        let same = |a: &[f64; 3], b: &[f64]| a.iter().zip(b).all(|(x, y)| x.to_bits() == y.to_bits());
        self.node == cap.node
            && self.radius.to_bits() == cap.radius.to_bits()
            && same(&self.center, cap.center.coords.as_slice())
            && same(&self.normal, cap.normal.as_slice())
    }
}
