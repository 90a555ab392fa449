//! Validity check of a mesh: every condition of the definition, checked exactly.
//!
//! A mesh is valid if every tetrahedron is positive by the exact predicate. Each interior face is shared by two
//! tetrahedra on opposite sides. The boundary is a closed 2-manifold without self-intersection. No point is duplicate
//! or unused. There is one component per component of the skeleton, with a boundary of the genus given by the
//! skeleton's loops. Every terminal has its flat cap, and every other boundary face is wall.
//!
//! In a mesh with regions, the expectation applies to the region named `lumen`, and every region has a boundary like that
//! of a mesh. Every face between two regions is labelled.
//!
//! In a second-order mesh, these conditions apply to the mesh of the corners ([`CheckReport::with_second_order`]).

mod cells;
mod labels;
mod nested;
pub mod parts;
mod passes;
mod regions;
mod result;
mod second_order;
mod surface;
mod surfaces;
pub mod text;

#[cfg(test)]
mod tests;

pub use passes::check_regions_in_passes;
pub use result::{
    CheckReport, Counts, Expectation, Intersection, Line, LineResult, Offender, OffenderKind, Outcome, RegionCounts,
    Skipped, Verdict,
};

use super::adjacency::{TetAdjacency, face_vertices, tet_adjacency};
use super::progress::{Progress, ask};
use super::quality::TetQuality;
use super::{NamedRegion, TetMesh, VolumeMesh};
use regions::RegionCheck;
use std::io;
use surface::Boundary;

/// Checks a labelled mesh.
///
/// ```
/// use anastomesh_mesh::check::{Expectation, Line, check_volume};
/// use anastomesh_mesh::{Patch, Point3, TetMesh, VolumeMesh, WALL};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let mut volume = VolumeMesh {
///     mesh: TetMesh { points, tets: vec![[0, 1, 2, 3]] },
///     tet_block: vec![0],
///     boundary: vec![[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]],
///     boundary_block: vec![0; 4],
///     boundary_patch: vec![WALL; 4],
///     patches: vec![Patch { id: WALL, name: "wall".into(), cap: None }],
/// };
/// let expected = Expectation { loops: vec![0], terminals: vec![] };
/// assert!(check_volume(&volume, Some(&expected)).is_valid());
/// volume.mesh.tets[0].swap(0, 1);
/// let report = check_volume(&volume, Some(&expected));
/// assert!(report.failed().any(|failed| failed.line == Line::PositiveTets));
/// ```
pub fn check_volume(volume: &VolumeMesh, expectation: Option<&Expectation>) -> CheckReport {
    check_regions(volume, &[], expectation)
}

/// Checks a labelled mesh with regions, which are the blocks of its tetrahedra. Without regions, as [`check_volume`].
///
/// ```
/// use anastomesh_mesh::check::{Line, check_regions};
/// use anastomesh_mesh::shapes::walled_channel;
///
/// let (mut volume, regions) = walled_channel(1);
/// let report = check_regions(&volume, &regions, None);
/// assert_eq!(report.failed().count(), 0);
/// assert_eq!((report.regions[1].name.as_str(), report.regions[1].components), ("wall", 1));
/// volume.tet_block[0] = 2;
/// let report = check_regions(&volume, &regions, None);
/// assert!(report.failed().any(|failed| failed.line == Line::InterfacesLabelled));
/// ```
pub fn check_regions(volume: &VolumeMesh, regions: &[NamedRegion], expectation: Option<&Expectation>) -> CheckReport {
    unwatched(check_regions_watched(volume, regions, expectation, &()))
}

/// As [`check_regions`], with cancellation.
///
/// # Errors
/// Cancellation.
pub fn check_regions_watched(
    volume: &VolumeMesh,
    regions: &[NamedRegion],
    expectation: Option<&Expectation>,
    progress: &dyn Progress,
) -> io::Result<CheckReport> {
    Check { mesh: &volume.mesh, volume: Some(volume), expectation, regions, progress }.run(None)
}

/// As [`check_volume`], for callers that already have the result of [`tet_adjacency`] for this mesh.
pub fn check_volume_with(
    volume: &VolumeMesh,
    adjacency: TetAdjacency,
    expectation: Option<&Expectation>,
) -> CheckReport {
    unwatched(
        Check { mesh: &volume.mesh, volume: Some(volume), expectation, regions: &[], progress: &() }
            .run(Some(adjacency)),
    )
}

/// Checks a mesh without labels; conditions on labels are not checked.
///
/// ```
/// use anastomesh_mesh::check::{Line, Outcome, Verdict, check_tets};
/// use anastomesh_mesh::{Point3, TetMesh};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let report = check_tets(&TetMesh { points, tets: vec![[1, 0, 2, 3]] }, None);
/// assert_eq!(report.verdict, Verdict::Invalid);
/// let inverted = report.line(Line::PositiveTets).expect("it is always looked at");
/// assert_eq!((inverted.outcome, inverted.count), (Outcome::Fail, 1));
/// ```
pub fn check_tets(mesh: &TetMesh, expectation: Option<&Expectation>) -> CheckReport {
    unwatched(Check { mesh, volume: None, expectation, regions: &[], progress: &() }.run(None))
}

fn unwatched(report: io::Result<CheckReport>) -> CheckReport {
    report.expect("only cancellation fails, and no listener can ask for it")
}

struct Check<'a> {
    mesh: &'a TetMesh,
    volume: Option<&'a VolumeMesh>,
    expectation: Option<&'a Expectation>,
    /// Empty for a mesh without regions.
    regions: &'a [NamedRegion],
    progress: &'a dyn Progress,
}

impl Check<'_> {
    fn run(&self, adjacency: Option<TetAdjacency>) -> io::Result<CheckReport> {
        let mesh = self.mesh;
        let counts = Counts { points: mesh.points.len(), tets: mesh.tets.len(), ..Counts::default() };
        let mut lines = vec![cells::not_empty(mesh), cells::finite_points(mesh), cells::indices_in_range(mesh)];
        // All other conditions require valid arrays.
        if let Some(line) = first_failure(&lines) {
            let of_regions = if self.regions.is_empty() { &[][..] } else { &Line::OF_REGIONS };
            let all = Line::ALL.iter().chain(of_regions).copied();
            let missing = all.filter(|l| lines.iter().all(|result| result.line != *l));
            let rest: Vec<LineResult> = missing.map(|l| LineResult::skipped(l, Skipped::Because(line))).collect();
            lines.extend(rest);
            return Ok(CheckReport::new(counts, lines, None, Vec::new()));
        }
        let adjacency = adjacency.unwrap_or_else(|| tet_adjacency(&mesh.tets, mesh.points.len()));
        self.run_on_sound_arrays(counts, lines, adjacency)
    }

    fn run_on_sound_arrays(
        &self,
        mut counts: Counts,
        mut lines: Vec<LineResult>,
        adjacency: TetAdjacency,
    ) -> io::Result<CheckReport> {
        let mesh = self.mesh;
        ask(self.progress)?;
        lines.extend(cells::lines(mesh, &adjacency));
        ask(self.progress)?;
        lines.push(cells::no_duplicate_points(mesh));
        counts.components = cells::components(&adjacency, |_| 0).count();
        counts.volume = cells::volume(mesh);
        let volume = self.volume.filter(|_| !self.regions.is_empty());
        let mut regions = volume.map(|volume| RegionCheck::of(volume, self.regions, &adjacency));
        lines.push(match &regions {
            Some(regions) => regions.components(self.expectation),
            None => result::components(self.expectation, counts.components),
        });
        let faces = boundary_of(mesh, &adjacency);
        drop(adjacency);
        let boundary = Boundary::new(&mesh.points, &faces);
        counts.boundary_faces = faces.len();
        counts.boundary_components = boundary.surfaces().all.len();
        let manifold = boundary.manifold_lines();
        let open = manifold.iter().find(|line| line.fails()).map(|line| line.line);
        let (line, intersections) = boundary.self_intersections(!manifold[0].fails(), self.progress);
        ask(self.progress)?;
        let is_complex = regions.is_some() && self.expectation.is_none();
        lines.extend(manifold.map(|line| if is_complex { line.may_touch() } else { line }));
        lines.push(line);
        match &regions {
            Some(regions) => lines.push(regions.loops(self.expectation)),
            None => lines.push(self.loops(&boundary, open)),
        }
        drop(boundary);
        match &regions {
            Some(regions) => lines.extend(regions.labels(&faces, self.expectation)),
            None => lines.extend(self.labels(&faces)),
        }
        if let Some(regions) = &mut regions {
            lines.extend(regions.lines(self.expectation.is_some(), self.progress));
            ask(self.progress)?;
        }
        counts.caps = self.volume.map_or(0, |v| v.patches.iter().filter(|p| p.cap.is_some()).count());
        let sizes = regions.map_or_else(Vec::new, |regions| regions.counts());
        let report = CheckReport::new(counts, lines, Some(TetQuality::of(mesh)), intersections);
        Ok(CheckReport { regions: sizes, ..report })
    }

    /// Checks the genus of closed manifolds; `open` is the condition that makes the boundary no closed manifold.
    fn loops(&self, boundary: &Boundary, open: Option<Line>) -> LineResult {
        match (self.expectation, open) {
            (None, _) => LineResult::skipped(Line::Loops, Skipped::NoExpectation),
            (_, Some(line)) => LineResult::skipped(Line::Loops, Skipped::Because(line)),
            (Some(expected), None) => boundary.loops(&expected.loops),
        }
    }

    fn labels(&self, faces: &[[u32; 3]]) -> Vec<LineResult> {
        let Some(volume) = self.volume else {
            return labels::LABEL_LINES.map(|line| LineResult::skipped(line, Skipped::NoLabels)).into();
        };
        let mut lines = vec![labels::labels_match(volume, faces)];
        if volume.boundary.as_flattened().iter().all(|&v| (v as usize) < volume.mesh.points.len()) {
            lines.extend(labels::cap_lines(volume, self.expectation));
        } else {
            let why = Skipped::Because(Line::LabelsMatchBoundary);
            lines.extend(labels::LABEL_LINES[1..].iter().map(|&line| LineResult::skipped(line, why)));
        }
        lines
    }
}

fn first_failure(lines: &[LineResult]) -> Option<Line> {
    lines.iter().find(|result| result.outcome == Outcome::Fail).map(|result| result.line)
}

fn boundary_of(mesh: &TetMesh, adjacency: &TetAdjacency) -> Vec<[u32; 3]> {
    adjacency.boundary().map(|handle| face_vertices(&mesh.tets, handle)).collect()
}
