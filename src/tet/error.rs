//! What can go wrong in the tetrahedralizer.

use super::complex::ComplexError;
use crate::geometry::Point3;

/// A part of the surface that another part meets; ids are those of the surface's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Obstacle {
    /// A triangle, met in its inside.
    Triangle([u32; 3]),
    /// An edge, met between its ends.
    Edge([u32; 2]),
    /// A point.
    Point(u32),
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

/// Why there is no tetrahedral mesh. Ids are those of the input's points and triangles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TetError {
    /// No points or no triangles.
    #[error("nothing to tetrahedralize: {points} points, {triangles} triangles")]
    Empty {
        /// Number of points.
        points: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// More points than `u32` ids can carry.
    #[error("{points} points are more than the tetrahedralizer can number")]
    TooLarge {
        /// Number of points.
        points: usize,
    },
    /// A coordinate that is not finite, or too large or too close to zero for exact arithmetic.
    #[error("point {point} at {position} is not finite or out of the range of exact arithmetic")]
    OutOfRange {
        /// The point.
        point: u32,
        /// Where it is.
        position: Point3,
    },
    /// Points at the same place.
    #[error("points {first} and {second} coincide at {position}, and {more} further pairs", more = count - 1)]
    DuplicatePoints {
        /// A point.
        first: u32,
        /// Another point at the same place.
        second: u32,
        /// The place.
        position: Point3,
        /// Number of points that repeat an earlier one.
        count: usize,
    },
    /// All points lie in one plane.
    #[error("all points lie in one plane")]
    Flat,
    /// A triangle with an index out of range or a repeated vertex.
    #[error("triangle {triangle} has vertices {vertices:?}, which are out of range or not distinct")]
    BadTriangle {
        /// The triangle.
        triangle: u32,
        /// Its vertices.
        vertices: [u32; 3],
    },
    /// A triangle whose vertices lie on one line.
    #[error("triangle {triangle} has no area: its vertices {vertices:?} lie on one line")]
    FlatTriangle {
        /// The triangle.
        triangle: u32,
        /// Its vertices.
        vertices: [u32; 3],
    },
    /// Edges that only one triangle has.
    #[error("the surface is open: edge {edge:?} has one triangle only ({count} such edges)")]
    Open {
        /// Ends of one such edge.
        edge: [u32; 2],
        /// Number of such edges.
        count: usize,
    },
    /// Edges that more than two triangles share.
    #[error("the surface is not manifold: more than two triangles share edge {edge:?} ({count} such edges)")]
    NotManifold {
        /// Ends of one such edge.
        edge: [u32; 2],
        /// Number of such edges.
        count: usize,
    },
    /// Two triangles run through an edge in the same direction.
    #[error("the surface is not consistently oriented at edge {edge:?} ({count} such edges)")]
    NotOriented {
        /// Ends of one such edge.
        edge: [u32; 2],
        /// Number of such edges.
        count: usize,
    },
    /// The surface encloses a negative volume: its triangles face inwards.
    #[error("the surface is oriented inwards: it encloses the volume {volume}")]
    InsideOut {
        /// The volume enclosed, negative.
        volume: f64,
    },
    /// An interior point that lies on the surface or coincides with another point.
    #[error("interior point {index} at {position} coincides with another point")]
    BadInteriorPoint {
        /// Index among the interior points given.
        index: u32,
        /// Where it is.
        position: Point3,
    },
    /// The surface meets itself: one of its edges runs through another part of it. Found by the way, exact where
    /// reported; there may be more.
    #[error("the surface meets itself: edge {} {} runs through {obstacle}", edge[0], edge[1])]
    SelfIntersection {
        /// Ends of the edge.
        edge: [u32; 2],
        /// What it meets.
        obstacle: Obstacle,
    },
    /// Recovery ended before all of the surface was in the mesh: the surface meets itself, or is too hard for the
    /// tiers that exist.
    #[error("{} edges and {} triangles of the surface could not be recovered", edges.len(), triangles.len())]
    NotRecovered {
        /// Edges that are not in the mesh.
        edges: Vec<[u32; 2]>,
        /// Triangles that are not in the mesh.
        triangles: Vec<u32>,
    },
    /// The orientation of the surface does not tell inside from outside: shells are nested the wrong way.
    #[error("triangle {triangle} does not separate inside from outside")]
    NotSeparating {
        /// The triangle.
        triangle: u32,
    },
    /// The finished mesh did not pass the certificate. A bug of this program, or a surface that meets itself.
    #[error("the mesh did not pass the certificate")]
    NotCertified(#[from] super::certify::CertifyError),
    /// The complex broke. A bug of this program.
    #[error("the tetrahedral complex is broken")]
    Broken(#[from] ComplexError),
}
