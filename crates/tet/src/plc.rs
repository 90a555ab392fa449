//! Input of the tetrahedralizer: a piecewise linear complex of points, triangles and segments.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;

/// Piecewise linear complex: points, triangles and segments that the mesh keeps, with holes and regions.
///
/// Lengths are in any unit. Triangles and segments meet in common points and edges only. [`InputKind`] lists the other
/// requirements.
///
/// ```
/// use anastomesh_tet::{InputKind, Plc, Point3, Region, Tetrahedralizer};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let plc = Plc::new(points, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
///     .markers(vec![1, 2, 2, 2])
///     .regions(vec![Region::new(Point3::new(0.1, 0.1, 0.1), 5)]);
/// let made = Tetrahedralizer::new().kind(InputKind::Plc).run(&plc)?;
/// assert!(made.regions.iter().all(|&region| region == 5));
/// # Ok::<(), anastomesh_tet::TetError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Plc {
    /// Points and triangles. All points become points of the mesh, with their index.
    pub surface: TriMesh,
    /// Marker of each triangle, copied to the faces; may be empty.
    pub markers: Vec<i32>,
    /// Segments to keep besides the edges of the triangles, for instance dangling ones.
    pub segments: Vec<[u32; 2]>,
    /// Seeds of holes: one point in each. Used for [`InputKind::Plc`] only.
    pub holes: Vec<Point3>,
    /// Regions with an id of their own.
    pub regions: Vec<Region>,
}

impl Plc {
    /// Complex of points and triangles.
    pub fn new(points: Vec<Point3>, triangles: Vec<[u32; 3]>) -> Self {
        Self::from(TriMesh { points, triangles })
    }
}

anastomesh_mesh::setters!(Plc {
    markers: Vec<i32>,
    segments: Vec<[u32; 2]>,
    holes: Vec<Point3>,
    regions: Vec<Region>,
});

/// Borrowed input of a run, made from a [`TriMesh`] or a [`Plc`] without copying either.
#[derive(Clone, Copy, Debug)]
pub struct PlcRef<'a> {
    pub(super) surface: &'a TriMesh,
    pub(super) markers: &'a [i32],
    pub(super) segments: &'a [[u32; 2]],
    pub(super) holes: &'a [Point3],
    pub(super) regions: &'a [Region],
}

impl PlcRef<'_> {
    /// Copies the input.
    pub(super) fn to_owned(self) -> Plc {
        let (markers, segments) = (self.markers.to_vec(), self.segments.to_vec());
        let (holes, regions) = (self.holes.to_vec(), self.regions.to_vec());
        Plc { surface: self.surface.clone(), markers, segments, holes, regions }
    }
}

impl<'a> From<&'a TriMesh> for PlcRef<'a> {
    fn from(surface: &'a TriMesh) -> Self {
        Self { surface, markers: &[], segments: &[], holes: &[], regions: &[] }
    }
}

impl<'a> From<&'a Plc> for PlcRef<'a> {
    fn from(plc: &'a Plc) -> Self {
        let Plc { surface, markers, segments, holes, regions } = plc;
        Self { surface, markers, segments, holes, regions }
    }
}

/// Connected part of the volume, bounded by triangles, that contains a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Region {
    /// A point in the region.
    pub seed: Point3,
    /// Id that its tetrahedra get.
    pub id: i32,
    /// Maximum volume of its tetrahedra.
    pub max_volume: Option<f64>,
    /// Edge length in the region, if shorter than elsewhere.
    pub size: Option<f64>,
    /// Maximum ratio of edge lengths in adjacent layers, if less than that of
    /// [`Interior::Growing`](crate::Interior::Growing) elsewhere.
    pub growth: Option<f64>,
}

impl Region {
    /// Region around a point, without bounds of its own.
    pub fn new(seed: Point3, id: i32) -> Self {
        Self { seed, id, max_volume: None, size: None, growth: None }
    }

    /// True if the region has bounds of its own.
    pub(super) fn is_bounded(&self) -> bool {
        self.max_volume.is_some() || self.size.is_some() || self.growth.is_some()
    }
}

anastomesh_mesh::setters!(Region {
    max_volume: impl Into<Option<f64>>,
    size: impl Into<Option<f64>>,
    growth: impl Into<Option<f64>>,
});

impl From<&TriMesh> for Plc {
    fn from(surface: &TriMesh) -> Self {
        Self::from(surface.clone())
    }
}

impl From<TriMesh> for Plc {
    fn from(surface: TriMesh) -> Self {
        Self { surface, ..Self::default() }
    }
}

/// Kind of a complex, which determines the part of space that is filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InputKind {
    /// Closed surfaces: each edge has two triangles, which have it in opposite directions. Space is filled where a path from
    /// infinity crosses the surface an odd number of times. So shells may be nested, in any orientation. Segments may
    /// dangle inside.
    #[default]
    Closed,
    /// Any facets, in any orientation. They may lie inside or dangle, and three or more may share an edge. Space is filled
    /// if every path from infinity or a hole crosses a facet.
    Plc,
}

/// Triangles and segments that were left out of the mesh, because all their sides lie outside or in a hole.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LeftOut {
    /// The triangles, ascending.
    pub triangles: Vec<u32>,
    /// The segments as indices into [`Plc::segments`], ascending.
    pub segments: Vec<u32>,
}

impl LeftOut {
    /// True if the mesh contains the whole input.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.segments.is_empty()
    }
}

/// Parts of the input that may lie outside of the filled volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputPart {
    /// Triangles.
    Triangles,
    /// Segments.
    Segments,
}

impl InputPart {
    /// Noun for one part, in the singular.
    pub(super) fn noun(self) -> &'static str {
        match self {
            Self::Triangles => "triangle",
            Self::Segments => "segment",
        }
    }
}

impl std::fmt::Display for InputPart {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Triangles => "triangles",
            Self::Segments => "segments",
        })
    }
}
