//! Errors of the tetrahedralizer.

use super::complex::{ComplexError, face_key};
use super::layer::LayersError;
use super::plc::InputPart;
use anastomesh_mesh::Bound;
use anastomesh_mesh::budget::{OverBudget, Stop};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::units::{counted, grouped};

/// Part of the surface that another part intersects. Ids are those of the surface's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Obstacle {
    /// A triangle, intersected in its interior.
    Triangle([u32; 3]),
    /// An edge, intersected between its ends.
    Edge([u32; 2]),
    /// A point.
    Point(u32),
}

impl Obstacle {
    /// Replaces a triangle by its form in the input, because a face of a complex may begin with another corner.
    pub(super) fn as_given(self, triangles: &[[u32; 3]]) -> Self {
        let Self::Triangle(face) = self else { return self };
        let key = face_key(face);
        Self::Triangle(triangles.iter().copied().find(|&t| face_key(t) == key).unwrap_or(face))
    }
}

impl std::fmt::Display for Obstacle {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Triangle([a, b, c]) => write!(f, "triangle {a} {b} {c}"),
            Self::Edge([a, b]) => write!(f, "edge {a} {b}"),
            Self::Point(p) => write!(f, "point {p}"),
        }
    }
}

/// Maximum number of offenders that an error lists; it counts all of them.
pub(super) const NAMED: usize = 10;

/// Lists the ids of the first offenders as text. Repeated ids are listed once, because the pieces of a polygon have its
/// number.
fn list<T: std::fmt::Debug + PartialEq>(ids: &[T], count: usize) -> String {
    list_as(ids, count, |id| format!("{id:?}"))
}

fn list_as<T: PartialEq>(ids: &[T], count: usize, shown: impl Fn(&T) -> String) -> String {
    let named: Vec<String> = ids.chunk_by(|a, b| a == b).map(|same| shown(&same[0])).collect();
    let more = if count > ids.len() { format!(" and {} more", count - ids.len()) } else { String::new() };
    named.join(", ") + &more
}

/// Edges with a fault, and the triangles at them.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct EdgeFaults {
    /// The first triangles with such an edge.
    pub triangles: Vec<u32>,
    /// Number of such triangles.
    pub count: usize,
    /// Ends of the first such edge.
    pub edge: [u32; 2],
    /// Number of such edges.
    pub edges: usize,
}

impl EdgeFaults {
    /// Text that counts the triangles, which are `at` the edges in a given way.
    fn text(&self, at: &str) -> String {
        let Self { triangles, count, edge, .. } = self;
        format!("{} {at}: {}; one edge is {edge:?}", counted(*count, "triangle"), list(triangles, *count))
    }
}

/// Text on duplicate triangles.
fn twice(pairs: &[[u32; 2]], count: usize) -> String {
    match pairs {
        [[first, again]] if count == 1 => format!("triangle {first} is duplicated by {again}"),
        _ => {
            let named = list_as(pairs, count, |[first, again]| format!("{first} (again as {again})"));
            format!("{count} duplicate triangles: {named}")
        }
    }
}

/// Array of the input with one value per point or triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InputArray {
    /// Markers, one for each triangle.
    Markers,
    /// Edge lengths, one for each point.
    Sizes,
    /// Caps, one for each triangle.
    Caps,
    /// Thicknesses of a shell, one for each point.
    Thicknesses,
}

impl std::fmt::Display for InputArray {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Markers => "markers of triangles",
            Self::Sizes => "edge lengths at points",
            Self::Caps => "caps of triangles",
            Self::Thicknesses => "thicknesses of a shell at points",
        })
    }
}

/// Kind of a seed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeedKind {
    /// Seed of a hole.
    Hole,
    /// Seed of a region.
    Region,
}

impl std::fmt::Display for SeedKind {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Hole => "hole",
            Self::Region => "region",
        })
    }
}

/// Inputs and options that exclude layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LayersConflict {
    /// The boundary may be split.
    SplitBoundary,
    /// A marker of the layers is unknown.
    Marker,
    /// A region of the layers is unknown.
    Region,
    /// All facets chosen have one region on both sides, or belong to none of the regions chosen.
    Baffles,
}

impl std::fmt::Display for LayersConflict {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::SplitBoundary => "the boundary may be split",
            Self::Marker => "no triangle of the input has one of their markers",
            Self::Region => "no region of the input has one of their numbers",
            Self::Baffles => "none of their facets bounds one of their regions",
        })
    }
}

/// Reasons for which exact recovery fails at a part of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stuck {
    /// The surface intersects itself there.
    Intersection,
    /// No position for a vertex was found between the parts of the surface that meet there, although one may exist.
    Precision,
    /// The edge has fewer than two triangles, and no position for a vertex was found beside it.
    Dangling,
    /// The budget of work was used up.
    Budget,
    /// Layers at a triangle of the wall would invert, and its corners cannot move.
    Layer,
}

impl std::fmt::Display for Stuck {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Intersection => "the surface intersects itself there",
            Self::Precision => "no position for a Steiner point was found between the parts that meet there",
            Self::Dangling => {
                "it has fewer than two triangles, and no position for a Steiner point was found beside it"
            }
            Self::Budget => "the work budget was used up",
            Self::Layer => "layers along it would invert",
        })
    }
}

/// Errors of the tetrahedralizer. Ids are those of the input's points and triangles, in ascending order. The first ten are
/// listed, and `count` counts all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TetError {
    /// No points or no triangles.
    #[error("nothing to tetrahedralize: {}, {}", counted(*points, "point"), counted(*triangles, "triangle"))]
    Empty {
        /// Number of points.
        points: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// More points than `u32` ids can carry.
    #[error("{points} points exceed the limit of 32-bit indices")]
    TooLarge {
        /// Number of points.
        points: usize,
    },
    /// Coordinates that are not finite, or too large or too close to zero for exact arithmetic.
    #[error(
        "{} with coordinates that are not finite or exceed the range of exact arithmetic: {}; \
         the first is at {position}", counted(*count, "point"), list(points, *count)
    )]
    OutOfRange {
        /// The points.
        points: Vec<u32>,
        /// Number of points.
        count: usize,
        /// Position of the first.
        position: Point3,
    },
    /// Points at the same place.
    #[error("{}: {}; the first pair is at {position}", counted(*count, "duplicate point"), list(pairs, *count))]
    DuplicatePoints {
        /// A point, and one before it at the same place; the earlier first.
        pairs: Vec<[u32; 2]>,
        /// Number of points that repeat an earlier one.
        count: usize,
        /// Place of the first pair.
        position: Point3,
    },
    /// All points lie in one plane.
    #[error("all points lie in one plane")]
    Flat,
    /// Triangles with an index out of range or a repeated vertex.
    #[error(
        "{} with vertices out of range or not distinct: {}; the first has {vertices:?}",
        counted(*count, "triangle"), list(triangles, *count)
    )]
    BadTriangle {
        /// The triangles.
        triangles: Vec<u32>,
        /// Number of triangles.
        count: usize,
        /// Vertices of the first.
        vertices: [u32; 3],
    },
    /// Segments with an index out of range or equal ends.
    #[error("{} with ends out of range or not distinct: {}", counted(*count, "segment"), list(segments, *count))]
    BadSegment {
        /// The segments, as indices into [`super::Plc::segments`].
        segments: Vec<u32>,
        /// Number of segments.
        count: usize,
    },
    /// Triangles whose vertices lie on one line.
    #[error(
        "{} without area: {}; the first has the collinear vertices {vertices:?}",
        counted(*count, "triangle"), list(triangles, *count)
    )]
    FlatTriangle {
        /// The triangles.
        triangles: Vec<u32>,
        /// Number of triangles.
        count: usize,
        /// Vertices of the first.
        vertices: [u32; 3],
    },
    /// Triangles with the vertices of an earlier one, turned one way or the other.
    #[error("{}", twice(pairs, *count))]
    DuplicateTriangles {
        /// A triangle, and one after it with the same vertices.
        pairs: Vec<[u32; 2]>,
        /// Number of triangles that repeat an earlier one.
        count: usize,
    },
    /// An array of the input has the wrong length.
    #[error("the number of {array} is {found}, expected {expected}")]
    WrongLength {
        /// The array.
        array: InputArray,
        /// Length found.
        found: usize,
        /// Required length.
        expected: usize,
    },
    /// Edges that only one triangle has.
    #[error("the surface is open: {}", .0.text("with an unshared edge"))]
    Open(EdgeFaults),
    /// Coincident edges of different triangles whose vertices are not merged.
    #[error("vertices are not merged: {}", .0.text("with an edge that coincides with another"))]
    NotShared(EdgeFaults),
    /// Edges that more than two triangles share.
    #[error("the surface is not manifold: {}", .0.text("at edges with more than two triangles"))]
    NotManifold(EdgeFaults),
    /// Two triangles have a common edge in the same direction.
    #[error("the surface is not consistently oriented: {}", .0.text("with a neighbour of opposite orientation"))]
    NotOriented(EdgeFaults),
    /// The surface encloses a negative volume: its triangles face inwards. [`Tetrahedralizer::run`](crate::Tetrahedralizer::run)
    /// accepts either orientation and does not return this error.
    #[error("the surface is oriented inwards: it encloses the volume {volume}")]
    InsideOut {
        /// The volume enclosed, negative.
        volume: f64,
    },
    /// An interior point that lies on the surface or coincides with another point.
    #[error("interior point {index} at {position} coincides with another point, or is not finite")]
    BadInteriorPoint {
        /// Index among the interior points given.
        index: u32,
        /// Its position.
        position: Point3,
    },
    /// The seed of a hole or region that lies in no such part of space.
    #[error("the {seed} seed {index} at {position} lies in no {seed}")]
    BadSeed {
        /// The kind of seed.
        seed: SeedKind,
        /// Index among them.
        index: u32,
        /// Its position.
        position: Point3,
    },
    /// An edge length of [`Sizing`](crate::Sizing) that is not positive and finite.
    #[error("the edge length {value} is not a positive finite number")]
    BadSize {
        /// The edge length.
        value: f64,
    },
    /// A bound of [`Refinement`](crate::Refinement) that no mesh satisfies.
    #[error("the bound {bound} = {value} cannot be satisfied")]
    BadBound {
        /// The bound.
        bound: Bound,
        /// Its value.
        value: f64,
    },
    /// A growth of [`Interior::Growing`](crate::Interior::Growing) that is not finite or too small.
    #[error("the growth {value} is not a finite number of at least {least}")]
    BadGrowth {
        /// The growth.
        value: f64,
        /// Minimum growth.
        least: f64,
    },
    /// The mesh would have more tetrahedra than allowed.
    #[error("the mesh would have about {} tetrahedra, more than the limit of {}", grouped(*estimate), grouped(*limit))]
    TooMany {
        /// Expected number of tetrahedra, or a lower bound.
        estimate: usize,
        /// Maximum number of tetrahedra.
        limit: usize,
    },
    /// The parameters of layers are invalid.
    #[error(transparent)]
    Layers(#[from] LayersError),
    /// Layers need facets that bound a region and a fixed boundary.
    #[error("layers need facets that bound a region and stay unchanged: {0}")]
    LayersAlong(LayersConflict),
    /// The surface intersects itself: pairs of triangles intersect outside shared vertices and edges.
    #[error(
        "the surface intersects itself: {}{}: {}",
        if *complete { "" } else { "at least " }, counted(*count, "intersecting triangle pair"), list(pairs, *count)
    )]
    SelfIntersection {
        /// The triangles of each pair.
        pairs: Vec<[u32; 2]>,
        /// Number of pairs.
        count: usize,
        /// True if all pairs were counted; counting stops at a limit.
        complete: bool,
    },
    /// An edge runs through a triangle, another edge, or a point.
    #[error("edge {} {} intersects {obstacle}", edge[0], edge[1])]
    EdgeMeets {
        /// Ends of the edge.
        edge: [u32; 2],
        /// Obstacle that it intersects.
        obstacle: Obstacle,
    },
    /// Recovery ended before all of the surface was in the mesh, although the surface does not intersect itself.
    #[error("{} and {} of the surface could not be recovered", counted(edges.len(), "edge"), counted(triangles.len(), "triangle"))]
    NotRecovered {
        /// Edges that are not in the mesh.
        edges: Vec<[u32; 2]>,
        /// Triangles that are not in the mesh.
        triangles: Vec<u32>,
    },
    /// The exact tier of recovery could not keep a part of the surface.
    #[error("{part} of the surface could not be recovered: {reason}")]
    Stuck {
        /// The part.
        part: Obstacle,
        /// Why.
        reason: Stuck,
    },
    /// A triangle of a closed surface has the inside on both of its sides, or the outside.
    #[error("triangle {triangle} does not separate inside from outside")]
    NotSeparating {
        /// The triangle.
        triangle: u32,
    },
    /// The facets enclose nothing: infinity or a hole reaches all of space without crossing a facet.
    #[error("the facets enclose no volume")]
    NothingEnclosed,
    /// Facets or segments that are not part of the volume: both sides of the facet lie outside or in a hole.
    #[error("{} outside the filled region: {}", counted(*count, part.noun()), list(ids, *count))]
    Outside {
        /// Triangles or segments.
        part: InputPart,
        /// Their ids.
        ids: Vec<u32>,
        /// Number of them.
        count: usize,
    },
    /// The progress callback cancelled the run.
    #[error("cancelled")]
    Cancelled,
    /// The work exceeds its budget. Only callers that set one see this.
    #[error("it exceeds its budget of {:.3} million operations", *limit as f64 / 1e6)]
    OverBudget {
        /// Maximum number of operations.
        limit: u64,
    },
    /// The finished mesh did not pass the certificate. A bug of this program, or a surface that intersects itself.
    #[error("the mesh failed its certificate")]
    NotCertified(#[from] super::certify::CertifyError),
    /// The complex broke. A bug of this program.
    #[error("the tetrahedral complex is inconsistent")]
    Broken(#[from] ComplexError),
}

impl TetError {
    /// True if the run was cancelled or exceeded a limit, so that no other attempt helps.
    pub(super) fn is_stop(&self) -> bool {
        matches!(self, Self::Cancelled | Self::OverBudget { .. } | Self::TooMany { .. })
    }
}

impl From<Stop> for TetError {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::Cancelled => Self::Cancelled,
            Stop::OverBudget(OverBudget { limit }) => Self::OverBudget { limit },
        }
    }
}
