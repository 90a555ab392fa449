//! Piecewise linear complexes: points, facets, holes, regions.

use anastomesh_mesh::geometry::Point3;

/// A format of files with a piecewise linear complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlcFormat {
    /// `.poly`: a facet is a list of polygons and holes.
    Poly,
    /// `.smesh`: a facet is one polygon in one line.
    Smesh,
}

/// A piecewise linear complex, as it stands in its file: nothing is checked but that its numbers are numbers and its
/// corners exist.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plc {
    /// Positions.
    pub points: Vec<Point3>,
    /// Boundary marker of each point; empty when the file has none.
    pub point_markers: Vec<i32>,
    /// Attributes of all points, those of one after those of another.
    pub point_attributes: Vec<f64>,
    /// How many attributes a point has.
    pub attribute_count: usize,
    /// Flat pieces of the boundary, outer or inner.
    pub facets: Vec<Facet>,
    /// A point in each part of space that is not to be meshed.
    pub holes: Vec<Point3>,
    /// Parts of the volume with an attribute of their own.
    pub regions: Vec<Region>,
    /// Whether the points stand in the `.node` file beside it.
    pub points_beside: bool,
    /// Number of the first point in the file, 0 or 1. Indices here run from 0 in any case.
    pub first: u32,
}

/// A flat piece of the boundary: the area that its polygons enclose, without its holes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facet {
    /// Indices of points around each polygon. A polygon of two is a segment, of one an isolated point in the facet.
    pub polygons: Vec<Vec<u32>>,
    /// A point in (or above) each hole of the facet.
    pub holes: Vec<Point3>,
    /// Boundary marker; 0 when the file has none.
    pub marker: i32,
}

/// The part of the volume around a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// A point in it.
    pub point: Point3,
    /// What its tetrahedra are labelled with.
    pub attribute: f64,
    /// Bound on the volume of its tetrahedra; none when it is not positive. A line with one number says the same with
    /// it as attribute and as bound.
    pub max_volume: Option<f64>,
}
