//! Piecewise linear complexes: points, facets, holes, regions.

use anastomesh_mesh::geometry::Point3;

/// File format of a piecewise linear complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlcFormat {
    /// `.poly`: a facet is a list of polygons and holes.
    Poly,
    /// `.smesh`: a facet is one polygon on one line.
    Smesh,
}

/// Piecewise linear complex as stored in its file. Only the syntax and the indices of corners are validated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plc {
    /// Positions.
    pub points: Vec<Point3>,
    /// Boundary marker of each point; empty if the file has none.
    pub point_markers: Vec<i32>,
    /// Attributes of all points, point by point.
    pub point_attributes: Vec<f64>,
    /// Number of attributes per point.
    pub attribute_count: usize,
    /// Flat pieces of the boundary, outer or inner.
    pub facets: Vec<Facet>,
    /// A point in each part of space that is not meshed.
    pub holes: Vec<Point3>,
    /// Parts of the volume with individual attributes.
    pub regions: Vec<Region>,
    /// True if the points are in the `.node` file beside it.
    pub points_beside: bool,
    /// Number of the first point in the file, 0 or 1. Indices here always start at 0.
    pub first: u32,
}

/// Flat piece of the boundary: the area enclosed by its polygons, minus its holes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facet {
    /// Point indices around each polygon. Two points are a segment, one is an isolated point in the facet.
    pub polygons: Vec<Vec<u32>>,
    /// A point in (or above) each hole of the facet.
    pub holes: Vec<Point3>,
    /// Boundary marker; 0 if the file has none.
    pub marker: i32,
}

/// Part of the volume around a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Point in the region.
    pub point: Point3,
    /// Label of its tetrahedra.
    pub attribute: f64,
    /// Maximum volume of its tetrahedra; `None` if not positive. A line with one number gives both attribute and bound.
    pub max_volume: Option<f64>,
}
