//! Parameters and errors of the surface stage.

use anastomesh_mesh::budget::Stop;
use anastomesh_skeleton::resolution::KAPPA;

/// Parameters of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceParams {
    /// Cell size of the grid, in the unit of the tubes: `2 r_min / ρ`.
    pub voxel: f64,
    /// Kernel width σ / r.
    pub kappa: f64,
    /// Origin of the grid, in cells. A different shift gives a different triangulation of the wall.
    pub shift: [f64; 3],
    /// Target edge length, in cells, on vessels with radius at most `thin`.
    pub edge: f64,
    /// Reference radius for `edge`.
    pub thin: f64,
    /// Exponent by which edge length grows with the radius of wider vessels: 0 for constant, 1 for proportional.
    pub follow: f64,
    /// Number of relaxation rounds.
    pub rounds: u32,
    /// Maximum number of cells that the wall may cross.
    pub max_cells: usize,
}

/// Factor on the target edge length of coarsened contours. Collapsing edges of a too fine contour leaves longer edges
/// than contouring at the right size.
const COARSENED: f64 = 0.93;

/// Maximum number of cells that a wall may cross. Contours of that size take about 6 GB.
pub(crate) const MAX_CELLS: usize = 20_000_000;

impl SurfaceParams {
    /// Default parameters for a cell size, with constant edge length.
    pub fn with_voxel(voxel: f64) -> Self {
        Self {
            voxel,
            kappa: KAPPA,
            shift: [0.0; 3],
            edge: 0.965,
            thin: 1.0,
            follow: 0.0,
            rounds: 2,
            max_cells: MAX_CELLS,
        }
    }

    /// Target edge length on a vessel of this radius.
    pub fn edge_at(&self, radius: f64) -> f64 {
        let wider = libm::pow((radius / self.thin).max(1.0), self.follow);
        self.edge * self.voxel * (COARSENED * wider).max(1.0)
    }
}

/// Reasons for a missing surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// No tube has a length.
    #[error("no tube has a length")]
    Empty,
    /// A tube has a coordinate or radius that is not finite, or a radius that is not positive.
    #[error("tube {tube} has a coordinate or radius that is not finite, or a radius that is not positive")]
    InvalidTube {
        /// Index of the tube.
        tube: u32,
    },
    /// A parameter is out of its range.
    #[error("{name} = {value} is out of range")]
    InvalidParameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The wall would cross too many cells.
    #[error("the wall crosses about {cells:.3e} grid cells, more than the limit of {limit}")]
    TooLarge {
        /// Estimated or counted cells.
        cells: f64,

        /// Largest number of cells.
        limit: usize,
    },
    /// The grid is too coarse to resolve a tube.
    #[error("the grid (cell size {voxel}) is too coarse for tube {tube}")]
    Unresolved {
        /// Index of the tube.
        tube: u32,
        /// Cell size.
        voxel: f64,
    },
    /// The tubes do not form one connected vessel.
    #[error("tubes {} and {} are not connected: the wall has {components} components", tubes[0], tubes[1])]
    Disconnected {
        /// Number of components.
        components: u32,
        /// One tube of each of two components.
        tubes: [u32; 2],
    },
    /// The caller asked for a stop, or the budget is exceeded.
    #[error(transparent)]
    Stopped(#[from] Stop),
    /// The contour is not a closed manifold, which is a bug.
    #[error("the contour is not a closed manifold at edge {} – {}", edge[0], edge[1])]
    NotManifold {
        /// Vertices of the edge; both are equal if a vertex is at fault.
        edge: [u32; 2],
    },
}
