//! Options of the tetrahedralizer.

use anastomesh_mesh::Bounds;
use anastomesh_mesh::geometry::Point3;
use std::sync::Arc;

/// Interior points.
#[derive(Clone, Debug, PartialEq)]
pub enum Interior {
    /// Only points that recovery needs.
    None,
    /// Body-centred cubic lattice; lengths in the unit of the surface.
    Lattice {
        /// Side of the cubes; `None`: 1.4 mean edge lengths of the surface.
        cell: Option<f64>,
        /// Minimum distance from the wall; `None`: 0.45 mean edge lengths of the surface.
        clearance: Option<f64>,
    },
    /// Lattice whose cubes grow away from the wall. Lengths have the units and defaults of `Lattice`.
    Graded {
        /// Side of the cubes next to the wall.
        cell: Option<f64>,
        /// Minimum distance from the wall.
        clearance: Option<f64>,
    },
    /// As `Graded`, with cube sizes that follow the surface. Lengths are in edge lengths of the nearby surface.
    Local {
        /// Side of the cubes next to the wall.
        cell: f64,
        /// Minimum distance from the wall.
        clearance: f64,
    },
    /// Body-centred lattice on a graded octree. Its spacing follows the edges of the surface and of interior facets, and
    /// grows away from them.
    Growing {
        /// Maximum ratio of edge lengths in adjacent layers of tetrahedra.
        growth: f64,
    },
    /// These points; those outside the surface are dropped.
    Points(Vec<Point3>),
}

impl Interior {
    /// Default growth of [`Interior::Growing`]: about as many tetrahedra as TetGen with `-pYq1.4`.
    pub const GROWTH: f64 = 2.0;

    /// Minimum growth of [`Interior::Growing`]. Less fills the interior with the finest size.
    pub const LEAST_GROWTH: f64 = 1.1;

    /// Lattice whose spacing is uniform: 1.4 mean edge lengths of the surface.
    pub const UNIFORM: Self = Self::Lattice { cell: None, clearance: None };
}

impl Default for Interior {
    fn default() -> Self {
        Self::Growing { growth: Self::GROWTH }
    }
}

/// Edge length, in the unit of the surface.
///
/// ```
/// use anastomesh_tet::Sizing;
/// use std::sync::Arc;
///
/// let finer_below = Sizing::Function(Arc::new(|p| if p.z < 0.0 { 0.1 } else { 0.2 }));
/// assert_eq!(format!("{finer_below:?}"), "Function");
/// ```
#[derive(Clone, Default)]
pub enum Sizing {
    /// Edge length of the nearby surface.
    #[default]
    Surface,
    /// Uniform length.
    Constant(f64),
    /// Lengths at the points of the input, interpolated between them.
    PerVertex(Vec<f64>),
    /// Function of the position.
    Function(Arc<dyn Fn(&Point3) -> f64 + Send + Sync>),
}

impl std::fmt::Debug for Sizing {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Surface => write!(f, "Surface"),
            Self::Constant(size) => write!(f, "Constant({size})"),
            Self::PerVertex(sizes) => write!(f, "PerVertex({} values)", sizes.len()),
            Self::Function(_) => write!(f, "Function"),
        }
    }
}

/// Bounds of the refinement. Each bound holds for all tetrahedra, as far as the boundary allows.
///
/// ```
/// use anastomesh_tet::{Refinement, Tetrahedralizer};
///
/// let surface = anastomesh_mesh::shapes::sphere_surface(2);
/// let fine = Refinement::default().max_radius_edge(2.0).max_points(5000);
/// let made = Tetrahedralizer::new().refine(fine).run(&surface)?;
/// assert!(made.summary.refine.is_some());
/// # Ok::<(), anastomesh_tet::TetError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Refinement {
    /// Bounds on the shape and volume of tetrahedra.
    pub bounds: Bounds,
    /// Maximum number of added points; `None`: as many as 32-bit indices allow.
    pub max_points: Option<usize>,
}

impl Refinement {
    /// Sets the bounds on shape and volume.
    #[must_use]
    pub fn bounds(mut self, bounds: Bounds) -> Self {
        self.bounds = bounds;
        self
    }

    /// Sets the maximum ratio of circumradius to shortest edge. Refinement always ends for 2 and above, and usually for 1.2
    /// to 2.
    #[must_use]
    pub fn max_radius_edge(mut self, bound: f64) -> Self {
        self.bounds.max_radius_edge = Some(bound);
        self
    }

    /// Sets the minimum dihedral angle, in degrees.
    #[must_use]
    pub fn min_dihedral(mut self, degrees: f64) -> Self {
        self.bounds.min_dihedral = Some(degrees);
        self
    }

    /// Sets the maximum volume.
    #[must_use]
    pub fn max_volume(mut self, bound: f64) -> Self {
        self.bounds.max_volume = Some(bound);
        self
    }

    /// Sets the maximum number of added points.
    #[must_use]
    pub fn max_points(mut self, bound: usize) -> Self {
        self.max_points = Some(bound);
        self
    }
}

/// Treatment of the input triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Boundary {
    /// Each triangle is a face of the mesh.
    #[default]
    Keep,
    /// Triangles may be split: each is a union of faces of the mesh. If the shape of tetrahedra is bounded, edges between
    /// coplanar triangles with one marker may be flipped, too. Then each plane facet is a union of faces. Triangles count as
    /// coplanar within 1e-4 of their longest edge.
    Split,
    /// The surface is remeshed with well-shaped triangles first, and the new triangles are faces of the mesh.
    ///
    /// Edge lengths are those of [`Sizing`], or those of the input, reduced at curvature and in thin parts. Kept are the topology,
    /// edges at angles above 40°, corners, segments, and edges between markers. A surface that does not intersect itself
    /// gives one that does not. Where that fails, the triangles of the input stay.
    ///
    /// ```
    /// use anastomesh_tet::{Boundary, Tetrahedralizer};
    ///
    /// let surface = anastomesh_mesh::shapes::banded_sphere(20);
    /// let made = Tetrahedralizer::new().boundary(Boundary::Remesh { tolerance: Some(0.01) }).run(&surface)?;
    /// let change = made.summary.remesh.expect("remeshed");
    /// assert!(change.distance <= 0.01 && change.smallest_angle[1] > 2.0 * change.smallest_angle[0]);
    /// assert_eq!(made.origins.len(), made.faces.len());
    /// # Ok::<(), anastomesh_tet::TetError>(())
    /// ```
    Remesh {
        /// Maximum distance between the input and the new surface; `None`: 0.001 of the diagonal of the bounding box. The
        /// distance is also at most 0.1 of the edge lengths.
        tolerance: Option<f64>,
    },
}

impl Boundary {
    /// Edges of the input may be this much longer than wanted before they are split, where they may be.
    pub const LONGER: f64 = 1.5;
}
