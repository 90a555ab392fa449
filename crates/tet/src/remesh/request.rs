//! Request for a remeshed surface.

use anastomesh_mesh::geometry::Point3;

/// Request for a remeshed surface.
pub struct Wanted<'a> {
    /// Maximum distance from the input; `None`: the default.
    pub tolerance: Option<f64>,
    /// Edge lengths in place of the input's own.
    pub size: Option<&'a dyn Fn(&Point3) -> f64>,
    /// Maximum edge length.
    pub longest: f64,
    /// Maximum number of triangles.
    pub most: usize,
}
