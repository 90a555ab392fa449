//! What is tetrahedralized: a piecewise linear complex of points, triangles and segments, and how it is read.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;

/// Points, triangles and segments that the mesh has to keep, and what lies between them.
///
/// Lengths are in any unit. Triangles and segments may meet in common points and edges only. What a [`Plc`] has to be
/// beyond that, an [`InputKind`] says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plc {
    /// Positions; all of them become points of the mesh, with their index.
    pub points: Vec<Point3>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Marker of each triangle, handed on to the faces; may be empty.
    pub markers: Vec<i32>,
    /// Segments to keep besides the edges of the triangles, for instance dangling ones.
    pub edges: Vec<[u32; 2]>,
    /// A point in each part of space that is to stay empty. Looked at for [`InputKind::Plc`] only: what bounds a volume
    /// says itself where its holes are.
    pub holes: Vec<Point3>,
    /// Regions with an id of their own.
    pub regions: Vec<Region>,
}

/// A connected part of the volume, bounded by triangles: the one around a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// A point in the region.
    pub seed: Point3,
    /// Id that its tetrahedra get.
    pub id: i32,
    /// Bound on the volume of its tetrahedra, looked at when the mesh is refined.
    pub max_volume: Option<f64>,
}

impl From<&TriMesh> for Plc {
    fn from(surface: &TriMesh) -> Self {
        Self { points: surface.points.clone(), triangles: surface.triangles.clone(), ..Self::default() }
    }
}

impl From<TriMesh> for Plc {
    fn from(surface: TriMesh) -> Self {
        Self { points: surface.points, triangles: surface.triangles, ..Self::default() }
    }
}

/// What a complex must be, and which part of space is filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InputKind {
    /// Surfaces that bound a volume: each edge has two triangles, which run through it in opposite directions. Space is
    /// filled where a way from infinity crosses the surface an odd number of times: shells may be nested, whatever way
    /// they are turned. Segments may dangle inside.
    #[default]
    Closed,
    /// Any facets: they may lie inside, dangle, and meet in edges by threes and more, turned one way or the other. All
    /// that cannot be reached from infinity or from a hole without crossing a facet is filled.
    Plc,
}

/// Triangles and segments of an input that the mesh does not have, because both of their sides lie outside or in a hole.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LeftOut {
    /// The triangles, ascending.
    pub triangles: Vec<u32>,
    /// The segments as indices into [`Plc::edges`], ascending.
    pub segments: Vec<u32>,
}

impl LeftOut {
    /// Whether the mesh has all of the input.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.segments.is_empty()
    }
}
