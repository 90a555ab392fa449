//! Result of a check: one entry per condition of the definition of 'valid'.

use crate::geometry::Point3;
use crate::quality::TetQuality;
use serde::{Deserialize, Serialize, Serializer};

/// Requirements on a mesh, known from its network.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Expectation {
    /// Number of independent loops of each component of the skeleton, in any order. It sets the number of components
    /// and the genera of their boundaries.
    pub loops: Vec<u32>,
    /// Nodes that need a cap each (indices in the input network), in any order.
    pub terminals: Vec<u32>,
}

/// Conditions of the definition of 'valid', in the order of reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Line {
    /// The mesh has tetrahedra.
    NotEmpty,
    /// Every coordinate is finite and in the range of the exact predicates.
    FinitePoints,
    /// Every tetrahedron refers to existing points.
    IndicesInRange,
    /// The four vertices of a tetrahedron differ.
    NoRepeatedVertex,
    /// No two tetrahedra have the same four vertices.
    NoDuplicateTets,
    /// Every tetrahedron is positive by the exact predicate.
    PositiveTets,
    /// No face belongs to more than two tetrahedra.
    FacesSharedByTwo,
    /// The two tetrahedra of an interior face lie on opposite sides of it.
    OppositeSides,
    /// No two points are equal.
    NoDuplicatePoints,
    /// Every point belongs to a tetrahedron.
    NoUnusedPoints,
    /// Every boundary edge is in two boundary faces with opposite directions.
    BoundaryEdges,
    /// The boundary faces around a vertex form a single fan.
    BoundaryFans,
    /// The boundary has no self-intersection, and no boundary surface lies inside the mesh.
    NoSelfIntersection,
    /// The number of components (tetrahedra connected by faces) equals the skeleton's.
    Components,
    /// Every component has one boundary surface, of the genus given by its loops.
    Loops,
    /// The labelled triangles are the boundary faces, each once, oriented outwards.
    LabelsMatchBoundary,
    /// Every boundary face is wall or belongs to a cap.
    WallOrCap,
    /// Every cap has a patch of its own, and patches have different ids and names.
    OwnPatch,
    /// Every terminal has one cap, and every cap a terminal.
    CapPerTerminal,
    /// Every cap is one disc: connected, with one boundary loop, Euler number 1.
    CapDisc,
    /// Every cap is flat to 1e-9 of its radius, or to the rounding of its coordinates (of 32 or 64 bits).
    CapFlat,
    /// The centre of every cap is within 0.1 radii of its node.
    CapCentred,
    /// The area of every cap is within 5 % of πr².
    CapArea,
    /// The triangles of every cap face in the direction of its normal.
    CapNormal,
    /// Every tetrahedron belongs to a named region, and every named region has tetrahedra.
    RegionsNamed,
    /// The boundary of every region is a closed 2-manifold.
    RegionBoundaries,
    /// The boundary of no region intersects itself.
    RegionIntersections,
    /// Every labelled face inside the mesh lies between two regions: those that the name of its patch tells.
    InterfaceSides,
    /// Every face between two regions is labelled once, oriented out of the region with the smaller id.
    InterfacesLabelled,
    /// Every edge of a second-order mesh has one midpoint, which all its elements and faces share.
    SharedMidpoints,
    /// Every second-order element has a positive Jacobian determinant everywhere.
    PositiveJacobians,
}

impl Line {
    /// Conditions on regions, in order. A mesh without regions has none of them.
    pub const OF_REGIONS: [Self; 5] = [
        Self::RegionsNamed,
        Self::RegionBoundaries,
        Self::RegionIntersections,
        Self::InterfaceSides,
        Self::InterfacesLabelled,
    ];

    /// Conditions on a second-order mesh, in order. Other meshes have none of them.
    pub const OF_SECOND_ORDER: [Self; 2] = [Self::SharedMidpoints, Self::PositiveJacobians];

    /// All conditions on a linear mesh without regions, in order.
    pub const ALL: [Self; 24] = [
        Self::NotEmpty,
        Self::FinitePoints,
        Self::IndicesInRange,
        Self::NoRepeatedVertex,
        Self::NoDuplicateTets,
        Self::PositiveTets,
        Self::FacesSharedByTwo,
        Self::OppositeSides,
        Self::NoDuplicatePoints,
        Self::NoUnusedPoints,
        Self::BoundaryEdges,
        Self::BoundaryFans,
        Self::NoSelfIntersection,
        Self::Components,
        Self::Loops,
        Self::LabelsMatchBoundary,
        Self::WallOrCap,
        Self::OwnPatch,
        Self::CapPerTerminal,
        Self::CapDisc,
        Self::CapFlat,
        Self::CapCentred,
        Self::CapArea,
        Self::CapNormal,
    ];

    /// True if the condition applies to a boundary that is not filled with tetrahedra.
    pub(super) fn concerns_surfaces(self) -> bool {
        self >= Self::BoundaryEdges || matches!(self, Self::FinitePoints | Self::NoDuplicatePoints)
    }

    /// Statement that is true if the condition holds.
    pub fn statement(self) -> &'static str {
        match self {
            Self::NotEmpty => "the mesh has tetrahedra",
            Self::FinitePoints => "all coordinates are finite",
            Self::IndicesInRange => "all vertex indices are in range",
            Self::NoRepeatedVertex => "no tetrahedron has a repeated vertex",
            Self::NoDuplicateTets => "no duplicate tetrahedra",
            Self::PositiveTets => "every tetrahedron has positive volume",
            Self::FacesSharedByTwo => "every face belongs to at most two tetrahedra",
            Self::OppositeSides => "tetrahedra with a common face lie on opposite sides of it",
            Self::NoDuplicatePoints => "no duplicate points",
            Self::NoUnusedPoints => "no unused points",
            Self::BoundaryEdges => "the boundary is closed",
            Self::BoundaryFans => "the boundary is manifold at every vertex",
            Self::NoSelfIntersection => "the boundary does not intersect itself",
            Self::Components => "the number of components is as expected",
            Self::Loops => "the number of loops (genus) is as expected",
            Self::LabelsMatchBoundary => "the labelled triangles are the boundary faces",
            Self::WallOrCap => "every boundary face belongs to the wall or to a cap",
            Self::OwnPatch => "every cap has its own patch",
            Self::CapPerTerminal => "every terminal has one cap",
            Self::CapDisc => "every cap is a disc",
            Self::CapFlat => "every cap is planar (tolerance 1e-9 r)",
            Self::CapCentred => "every cap is centred on its node (tolerance 0.1 r)",
            Self::CapArea => "every cap has the area πr² (tolerance 5 %)",
            Self::CapNormal => "every cap faces outwards",
            Self::RegionsNamed => "every tetrahedron is in a named region, and no region is empty",
            Self::RegionBoundaries => "the boundary of every region is closed and manifold",
            Self::RegionIntersections => "the boundary of no region intersects itself",
            Self::InterfaceSides => "every interface face lies between its two regions",
            Self::InterfacesLabelled => "every face between two regions is labelled as interface",
            Self::SharedMidpoints => "every edge has one midpoint",
            Self::PositiveJacobians => "every element has a positive Jacobian determinant",
        }
    }

    /// Statement that is true if the condition fails: for one offender, and for `{}` of them.
    pub(super) fn violation(self) -> [&'static str; 2] {
        match self {
            Self::NotEmpty => ["the mesh has no tetrahedra"; 2],
            Self::FinitePoints => ["1 point has invalid coordinates", "{} points have invalid coordinates"],
            Self::IndicesInRange => {
                ["1 tetrahedron has a vertex index out of range", "{} tetrahedra have a vertex index out of range"]
            }
            Self::NoRepeatedVertex => ["1 tetrahedron has a repeated vertex", "{} tetrahedra have a repeated vertex"],
            Self::NoDuplicateTets => ["1 duplicate tetrahedron", "{} duplicate tetrahedra"],
            Self::PositiveTets => ["1 tetrahedron is inverted or flat", "{} tetrahedra are inverted or flat"],
            Self::FacesSharedByTwo => {
                ["1 face belongs to more than two tetrahedra", "{} faces belong to more than two tetrahedra"]
            }
            Self::OppositeSides => [
                "1 pair of tetrahedra lies on one side of the common face",
                "{} pairs of tetrahedra lie on one side of the common face",
            ],
            Self::NoDuplicatePoints => ["1 duplicate point", "{} duplicate points"],
            Self::NoUnusedPoints => ["1 unused point", "{} unused points"],
            Self::BoundaryEdges => ["the boundary is not closed at 1 edge", "the boundary is not closed at {} edges"],
            Self::BoundaryFans => {
                ["the boundary is not manifold at 1 vertex", "the boundary is not manifold at {} vertices"]
            }
            Self::NoSelfIntersection => {
                ["the boundary intersects itself at 1 place", "the boundary intersects itself at {} places"]
            }
            Self::Components => ["number of components"; 2],
            Self::Loops => ["number of loops (genus)"; 2],
            Self::LabelsMatchBoundary => [
                "the labelled triangles differ from the boundary faces at 1 place",
                "the labelled triangles differ from the boundary faces at {} places",
            ],
            Self::WallOrCap => [
                "1 boundary face belongs to neither the wall nor a cap",
                "{} boundary faces belong to neither the wall nor a cap",
            ],
            Self::OwnPatch => ["1 patch id or name is not unique", "{} patch ids or names are not unique"],
            Self::CapPerTerminal => {
                ["terminals and caps do not match at 1 node", "terminals and caps do not match at {} nodes"]
            }
            Self::CapDisc => ["1 cap is not a disc", "{} caps are not discs"],
            Self::CapFlat => ["1 cap is not planar (tolerance 1e-9 r)", "{} caps are not planar (tolerance 1e-9 r)"],
            Self::CapCentred => [
                "1 cap is not centred on its node (tolerance 0.1 r)",
                "{} caps are not centred on their nodes (tolerance 0.1 r)",
            ],
            Self::CapArea => [
                "the area of 1 cap differs from πr² by more than 5 %",
                "the areas of {} caps differ from πr² by more than 5 %",
            ],
            Self::CapNormal => ["1 cap does not face outwards", "{} caps do not face outwards"],
            Self::RegionsNamed => [
                "1 tetrahedron is in no named region, or a region is empty",
                "{} tetrahedra are in no named region, or regions are empty",
            ],
            Self::RegionBoundaries => [
                "the boundary of a region is open or not manifold at 1 place",
                "the boundaries of regions are open or not manifold at {} places",
            ],
            Self::RegionIntersections => [
                "the boundary of a region intersects itself at 1 place",
                "the boundaries of regions intersect themselves at {} places",
            ],
            Self::InterfaceSides => [
                "1 interface face does not lie between its two regions",
                "{} interface faces do not lie between their two regions",
            ],
            Self::InterfacesLabelled => [
                "1 face between two regions is not labelled as interface, or turned",
                "{} faces between two regions are not labelled as interface, or turned",
            ],
            Self::SharedMidpoints => ["1 edge has several midpoints", "{} edges have several midpoints"],
            Self::PositiveJacobians => [
                "1 element has a Jacobian determinant that is not positive everywhere",
                "{} elements have a Jacobian determinant that is not positive everywhere",
            ],
        }
    }
}

/// Reason why a condition was not checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Skipped {
    /// The mesh has no boundary labels.
    NoLabels,
    /// No expectation is given.
    NoExpectation,
    /// No patch has cap data.
    NoCaps,
    /// No region is named `lumen`.
    NoLumen,
    /// No interface face is labelled.
    NoInterfaces,
    /// A complex or its regions touch themselves, which is allowed.
    MayTouch,
    /// Meaningless while this condition fails.
    Because(Line),
}

/// Outcome of a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It holds.
    Pass,
    /// It fails.
    Fail,
    /// It was not checked.
    NotChecked(Skipped),
}

/// Kind of an offender's ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OffenderKind {
    /// One point.
    Point,
    /// Two points.
    Edge,
    /// A tetrahedron.
    Tet,
    /// Two tetrahedra.
    TetPair,
    /// Three points: a face.
    Face,
    /// Six points: two faces.
    FacePair,
    /// A patch of the boundary.
    Patch,
    /// A node of the network.
    Node,
    /// A region of the mesh.
    Region,
}

/// An entity that violates a condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offender {
    /// Kind of the ids.
    pub kind: OffenderKind,
    /// Ids, counted from 0 in the order of the mesh (patches and nodes: their own ids).
    pub ids: Vec<i64>,
    /// Position, if it has one.
    pub position: Option<[f64; 3]>,
}

impl Offender {
    pub(super) fn new(kind: OffenderKind, ids: &[u32], position: Option<Point3>) -> Self {
        let position = position.map(|p| p.coords.into());
        Self { kind, ids: ids.iter().map(|&i| i64::from(i)).collect(), position }
    }
}

/// Maximum offenders kept per condition, so that a viewer can show each. 1,000 take about 0.1 MB.
pub const KEPT_OFFENDERS: usize = 1000;
/// Maximum offenders per condition in JSON and in text.
pub(super) const PRINTED_OFFENDERS: usize = 10;

fn first_offenders<S: Serializer>(offenders: &[Offender], serializer: S) -> Result<S::Ok, S::Error> {
    offenders[..offenders.len().min(PRINTED_OFFENDERS)].serialize(serializer)
}

/// Result of one line of the check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineResult {
    /// The line.
    pub line: Line,
    /// Outcome of the condition.
    pub outcome: Outcome,
    /// Number of offenders.
    pub count: u64,
    /// First offenders, up to 1,000; JSON has up to 10.
    #[serde(serialize_with = "first_offenders")]
    pub offenders: Vec<Offender>,
    /// Expected values, ascending, for conditions that compare.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expected: Option<Vec<u32>>,
    /// Found values, ascending, for conditions that compare.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found: Option<Vec<u32>>,
}

impl LineResult {
    pub(super) fn fails(&self) -> bool {
        self.outcome == Outcome::Fail
    }

    pub(super) fn skipped(line: Line, why: Skipped) -> Self {
        Self { outcome: Outcome::NotChecked(why), ..Tally::new(line).done() }
    }

    /// A failed condition counts as not checked: a complex and its regions may touch themselves. Boundaries of
    /// tetrahedra are closed, so that a manifold condition can only fail there.
    pub(super) fn may_touch(self) -> Self {
        if self.fails() { Self::skipped(self.line, Skipped::MayTouch) } else { self }
    }
}

/// Collects the offenders of one condition.
#[derive(Debug)]
pub(super) struct Tally(LineResult);

impl Tally {
    pub(super) fn new(line: Line) -> Self {
        Self(LineResult { line, outcome: Outcome::Pass, count: 0, offenders: Vec::new(), expected: None, found: None })
    }

    /// Counts an offender; its description is made only if it is kept.
    pub(super) fn add(&mut self, offender: impl FnOnce() -> Offender) {
        self.0.count += 1;
        if self.0.offenders.len() < KEPT_OFFENDERS {
            self.0.offenders.push(offender());
        }
    }

    /// Counts the offenders of another condition, too.
    pub(super) fn add_all(&mut self, other: LineResult) {
        self.0.count += other.count;
        let free = KEPT_OFFENDERS - self.0.offenders.len();
        self.0.offenders.extend(other.offenders.into_iter().take(free));
    }

    /// Compares two ascending lists; fails if they differ.
    pub(super) fn compare(&mut self, expected: Vec<u32>, found: Vec<u32>) {
        if expected != found {
            self.0.outcome = Outcome::Fail;
        }
        (self.0.expected, self.0.found) = (Some(expected), Some(found));
    }

    /// True if nothing has been added, and compared lists agree.
    pub(super) fn holds(&self) -> bool {
        self.0.count == 0 && self.0.outcome == Outcome::Pass
    }

    pub(super) fn done(mut self) -> LineResult {
        if self.0.count > 0 {
            self.0.outcome = Outcome::Fail;
        }
        self.0
    }
}

/// Numbers of a sorted list that are not in another sorted list; equal numbers count one by one.
pub(super) fn without(all: &[u32], other: &[u32]) -> Vec<u32> {
    let mut left = other.iter().peekable();
    let is_unmatched = |n: &&u32| {
        while left.next_if(|other| other < n).is_some() {}
        left.next_if_eq(n).is_none()
    };
    all.iter().filter(is_unmatched).copied().collect()
}

/// Compares the number of components with the skeleton's.
pub(super) fn components(expectation: Option<&Expectation>, found: usize) -> LineResult {
    let Some(expected) = expectation else {
        return LineResult::skipped(Line::Components, Skipped::NoExpectation);
    };
    let mut tally = Tally::new(Line::Components);
    tally.compare(vec![expected.loops.len() as u32], vec![found as u32]);
    tally.done()
}

/// Sizes of the checked mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Counts {
    /// Number of points.
    pub points: usize,
    /// Number of tetrahedra.
    pub tets: usize,
    /// Number of boundary faces.
    pub boundary_faces: usize,
    /// Number of components (tetrahedra connected by faces).
    pub components: usize,
    /// Number of boundary surfaces (faces connected by vertices).
    pub boundary_components: usize,
    /// Number of caps.
    pub caps: usize,
    /// Volume of all tetrahedra, in the cube of the mesh's unit.
    pub volume: f64,
}

/// Sizes of a region.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegionCounts {
    /// Id of the region.
    pub id: i32,
    /// Name of the region.
    pub name: String,
    /// Number of tetrahedra.
    pub tets: usize,
    /// Number of components (tetrahedra of the region connected by faces).
    pub components: usize,
    /// Number of faces on its boundary.
    pub boundary_faces: usize,
    /// Number of edges and vertices where its boundary touches itself.
    pub touches: u64,
    /// Volume, in the cube of the mesh's unit.
    pub volume: f64,
}

/// Verdict over all conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every condition was checked and holds.
    Valid,
    /// All checked conditions hold, but some could not be checked.
    NoFaultFound,
    /// A condition fails.
    Invalid,
}

/// Two boundary faces that intersect improperly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Intersection {
    /// Their vertices; the same face twice if it has no area.
    pub faces: [[u32; 3]; 2],
    /// Kind of the intersection.
    pub kind: crate::geometry::Improper,
}

/// Result of a check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    /// The verdict.
    pub verdict: Verdict,
    /// Sizes.
    pub counts: Counts,
    /// Sizes of the regions, by id; empty if the mesh has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionCounts>,
    /// One entry per condition, in order.
    pub lines: Vec<LineResult>,
    /// Shape of the tetrahedra; `None` if their points are unusable.
    pub quality: Option<TetQuality>,
    /// All pairs of boundary faces that intersect improperly, ascending.
    #[serde(skip)]
    pub intersections: Vec<Intersection>,
}

impl CheckReport {
    pub(super) fn new(
        counts: Counts,
        mut lines: Vec<LineResult>,
        quality: Option<TetQuality>,
        intersections: Vec<Intersection>,
    ) -> Self {
        lines.sort_by_key(|line| line.line);
        let verdict = if lines.iter().any(|line| line.outcome == Outcome::Fail) {
            Verdict::Invalid
        } else if lines.iter().all(|line| line.outcome == Outcome::Pass) {
            Verdict::Valid
        } else {
            Verdict::NoFaultFound
        };
        Self { verdict, counts, regions: Vec::new(), lines, quality, intersections }
    }

    /// True if every condition was checked and holds.
    pub fn is_valid(&self) -> bool {
        self.verdict == Verdict::Valid
    }

    /// Result of one condition.
    pub fn line(&self, line: Line) -> Option<&LineResult> {
        self.lines.iter().find(|result| result.line == line)
    }

    /// Failed conditions.
    pub fn failed(&self) -> impl Iterator<Item = &LineResult> {
        self.lines.iter().filter(|line| line.outcome == Outcome::Fail)
    }
}
