//! Options of the tetrahedralizer.

use anastomesh_mesh::Bounds;
use anastomesh_mesh::geometry::Point3;
use std::sync::Arc;

/// Interior points.
#[derive(Clone, Debug, PartialEq)]
pub enum Interior {
    /// None but those that recovery needs.
    None,
    /// A body-centred cubic lattice; lengths in the unit of the surface.
    Lattice {
        /// Side of the cubes; none: 1.4 mean edge lengths of the surface.
        cell: Option<f64>,
        /// Distance kept from the wall; none: 0.45 mean edge lengths of the surface.
        clearance: Option<f64>,
    },
    /// A lattice whose cubes grow away from the wall; lengths as for `Lattice`, the side is that of the smallest cubes.
    Graded {
        /// Side of the cubes next to the wall.
        cell: Option<f64>,
        /// Distance kept from the wall.
        clearance: Option<f64>,
    },
    /// As `Graded`, with cubes that follow the surface: lengths are in edge lengths of the surface nearby.
    Local {
        /// Side of the cubes next to the wall.
        cell: f64,
        /// Distance kept from the wall.
        clearance: f64,
    },
    /// These points; those outside the surface are dropped.
    Points(Vec<Point3>),
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
    /// As the surface has them nearby.
    #[default]
    Surface,
    /// Uniform length.
    Constant(f64),
    /// Given at each point of the input, interpolated between them.
    PerVertex(Vec<f64>),
    /// Given by a function of the place.
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
    /// Bounds on its shape and volume.
    pub bounds: Bounds,
    /// Most points that are added; none: as many as the tetrahedralizer can number.
    pub max_points: Option<usize>,
}

impl Refinement {
    /// With these bounds on shape and volume.
    #[must_use]
    pub fn bounds(mut self, bounds: Bounds) -> Self {
        self.bounds = bounds;
        self
    }

    /// With a bound on the circumradius over the shortest edge; 2 and above is sure to end, 1.2 to 2 mostly does.
    #[must_use]
    pub fn max_radius_edge(mut self, bound: f64) -> Self {
        self.bounds.max_radius_edge = Some(bound);
        self
    }

    /// With a bound on the smallest dihedral angle, in degrees.
    #[must_use]
    pub fn min_dihedral(mut self, degrees: f64) -> Self {
        self.bounds.min_dihedral = Some(degrees);
        self
    }

    /// With a bound on the volume.
    #[must_use]
    pub fn max_volume(mut self, bound: f64) -> Self {
        self.bounds.max_volume = Some(bound);
        self
    }

    /// With a bound on the number of points that are added.
    #[must_use]
    pub fn max_points(mut self, bound: usize) -> Self {
        self.max_points = Some(bound);
        self
    }
}

/// Treatment of the input triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// Nothing: each is a face of the mesh.
    #[default]
    Keep,
    /// They may be split: each is a union of faces of the mesh.
    Split,
}

impl Boundary {
    /// Edges of the input may be this much longer than wanted before they are split, where they may be.
    pub const LONGER: f64 = 1.5;
}
