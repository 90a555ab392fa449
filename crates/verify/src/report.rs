//! Conditions of a valid mesh, and the violations of a file.

use itertools::Itertools as _;
use serde::Serialize;
use serde_json::{Value, json};
use std::fmt::{self, Display};

/// Maximum violations of a condition whose ids are listed.
const LISTED: usize = 3;

/// Declares the conditions with their names in JSON and the words for a violation.
macro_rules! conditions {
    ($($(#[$doc:meta])* $variant:ident, $name:literal, $violation:literal;)*) => {
        /// Condition of a valid mesh.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Condition { $($(#[$doc])* $variant,)* }

        impl Condition {
            /// Name in JSON and in certificates.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Noun phrase for the violations.
            pub fn violation(self) -> &'static str {
                match self { $(Self::$variant => $violation,)* }
            }
        }
    };
}

conditions! {
    /// The mesh has tetrahedra.
    NotEmpty, "not_empty", "no tetrahedra";
    /// Every coordinate is finite.
    FinitePoints, "finite_points", "points that are not finite";
    /// Every tetrahedron refers to existing points.
    IndicesInRange, "indices_in_range", "tetrahedra with missing vertices";
    /// The vertices of a tetrahedron differ.
    NoRepeatedVertex, "no_repeated_vertex", "tetrahedra with a repeated vertex";
    /// No two tetrahedra have the same vertices.
    NoDuplicateTets, "no_duplicate_tets", "duplicate tetrahedra";
    /// Every tetrahedron has a positive volume, by an exact sign.
    PositiveTets, "positive_tets", "inverted or flat tetrahedra";
    /// Every face belongs to at most two tetrahedra.
    FacesSharedByTwo, "faces_shared_by_two", "faces of more than two tetrahedra";
    /// Both tetrahedra of an interior face lie on opposite sides.
    OppositeSides, "opposite_sides", "faces with both tetrahedra on one side";
    /// No two points are equal.
    NoDuplicatePoints, "no_duplicate_points", "duplicate points";
    /// Every point belongs to a tetrahedron.
    NoUnusedPoints, "no_unused_points", "unused points";
    /// Every boundary edge has two faces, in opposite directions.
    BoundaryEdges, "boundary_edges", "boundary edges without exactly two faces";
    /// The boundary faces around a vertex form one fan.
    BoundaryFans, "boundary_fans", "boundary vertices with several fans";
    /// No two boundary faces intersect outside their common vertices and edges.
    NoSelfIntersection, "no_self_intersection", "pairs of intersecting boundary faces";
    /// No part of the mesh lies inside another part.
    NoNesting, "no_nesting", "boundary surfaces inside another part of the mesh";
    /// The number of components is that of the network.
    Components, "components", "unexpected number of components";
    /// Every component has one boundary surface, with the genus given by the loops of the network.
    Loops, "loops", "unexpected loops";
    /// The labelled triangles are the boundary faces, each once, oriented outwards.
    LabelsMatchBoundary, "labels_match_boundary", "differences between labelled triangles and the boundary";
    /// Every label is the wall or a named patch.
    WallOrCap, "wall_or_cap", "triangles of unknown patches";
    /// Patches have different ids and names, and caps have different patches.
    OwnPatch, "own_patch", "patches with equal ids or names";
    /// Every expected terminal has one cap, and every cap an expected terminal.
    CapPerTerminal, "cap_per_terminal", "terminals without one cap";
    /// Every cap is a disc. Patches of several caps consist of discs.
    CapDisc, "cap_disc", "caps that are not discs";
    /// Every cap is flat within 1e-9 of its radius, or within the rounding of its coordinates.
    CapFlat, "cap_flat", "caps that are not flat";
    /// The centre of a cap is within 0.1 radii of its node.
    CapCentred, "cap_centred", "caps that are not centred on their node";
    /// The area of a cap is within 5 % of that of its disc.
    CapArea, "cap_area", "caps with a wrong area";
    /// The triangles of a cap face along its normal.
    CapNormal, "cap_normal", "caps that face inwards";
    /// Every tetrahedron is in a named region, and no region is empty.
    RegionsNamed, "regions_named", "tetrahedra without a named region, or empty regions";
    /// Every face between two regions is labelled once, out of the smaller id, and no other face inside.
    Interfaces, "interfaces", "labels that differ from the faces between regions";
    /// Every triangle of the input surface is a boundary face.
    SurfaceKept, "surface_kept", "triangles of the surface missing in the mesh";
    /// Every vertex of the wall is near the surface of a vessel.
    WallDistance, "wall_distance", "wall vertices far from the vessels";
    /// The certificate is unchanged since it was written.
    Seal, "seal", "changes of the certificate";
    /// The certificate belongs to this mesh and this input.
    Hashes, "hashes", "differences between the certificate and the files";
    /// The certificate claims what the file shows.
    Claims, "claims", "claims of the certificate that do not hold";
}

/// Result for one condition.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Condition that was checked.
    pub condition: Condition,
    /// Number of violations.
    pub count: usize,
    /// Ids of the first violations.
    pub first: Vec<String>,
}

/// Sizes of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Figures {
    /// Number of points.
    pub points: usize,
    /// Number of tetrahedra.
    pub tets: usize,
    /// Number of boundary faces.
    pub boundary_faces: usize,
    /// Number of parts connected by faces.
    pub components: usize,
    /// Sum of the genera of all boundary surfaces; 0 unless the boundary is a closed manifold.
    pub genus: i64,
    /// Volume in the cube of the file's unit.
    pub volume: f64,
}

/// Result of all conditions that could be checked.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Conditions in the order of checks. Conditions that do not apply are absent.
    pub outcomes: Vec<Outcome>,
    /// Sizes of the mesh.
    pub figures: Figures,
}

impl Report {
    /// True if no checked condition is violated.
    pub fn is_valid(&self) -> bool {
        self.violated().next().is_none()
    }

    /// Violated conditions.
    pub fn violated(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes.iter().filter(|outcome| outcome.count > 0)
    }

    /// Adds a condition with its violations; true if none exist.
    pub(crate) fn add(&mut self, condition: Condition, violations: impl IntoIterator<Item = impl Display>) -> bool {
        let mut violations = violations.into_iter();
        let first: Vec<String> = violations.by_ref().take(LISTED).map(|violation| violation.to_string()).collect();
        let count = first.len() + violations.count();
        self.outcomes.push(Outcome { condition, count, first });
        count == 0
    }

    /// Adds the outcomes of a region.
    pub(crate) fn merge(&mut self, part: Self, region: &str) {
        for mut outcome in part.outcomes {
            outcome.first.iter_mut().for_each(|violation| *violation = format!("region {region}: {violation}"));
            if let Some(known) = self.outcomes.iter_mut().find(|known| known.condition == outcome.condition) {
                known.first.append(&mut outcome.first);
                known.first.truncate(LISTED);
                known.count += outcome.count;
            } else {
                self.outcomes.push(outcome);
            }
        }
    }

    /// Drops the conditions on manifold boundaries. A complex and its regions may touch themselves at edges and vertices, unlike
    /// those of a network.
    pub(crate) fn allow_touching(&mut self) {
        let may_fail = [Condition::BoundaryEdges, Condition::BoundaryFans];
        self.outcomes.retain(|outcome| !may_fail.contains(&outcome.condition));
    }

    /// True if a condition was checked and holds.
    pub(crate) fn holds(&self, condition: Condition) -> bool {
        self.outcomes.iter().any(|outcome| outcome.condition == condition && outcome.count == 0)
    }

    /// JSON object with all conditions.
    pub fn to_json(&self) -> Value {
        let condition = |o: &Outcome| json!({"name": o.condition.name(), "violations": o.count, "first": o.first});
        let mut json = json!(self.figures);
        json["valid"] = self.is_valid().into();
        json["conditions"] = self.outcomes.iter().map(condition).collect();
        json
    }
}

/// One line: `valid` with sizes, or the violated conditions with the first ids.
impl Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        if self.is_valid() {
            let Figures { tets, boundary_faces, components, genus, .. } = self.figures;
            write!(out, "valid: tetrahedra {tets}, boundary faces {boundary_faces}, components {components}, ")?;
            return write!(out, "genus {genus}, conditions {}", self.outcomes.len());
        }
        write!(out, "NOT valid: {}", self.violated().join("; "))
    }
}

impl Display for Outcome {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let Self { condition, count, first } = self;
        let more = if *count > first.len() { ", …" } else { "" };
        write!(out, "{}: {}: {count} ({}{more})", condition.name(), condition.violation(), first.join(", "))
    }
}

/// Ids of vertices, with spaces between them.
pub(crate) struct Ids<const N: usize>(pub [u32; N]);

impl<const N: usize> Display for Ids<N> {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.0.iter().join(" "))
    }
}
