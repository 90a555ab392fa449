//! How a surface is made, and why there may be none.

use anastomesh_skeleton::resolution::KAPPA;

/// How a surface is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceParams {
    /// Edge of a grid cell, in the unit of the tubes: `2 r_min / ρ`.
    pub voxel: f64,
    /// Kernel width σ / r.
    pub kappa: f64,
    /// Where the grid lies: its origin, in cells. Another shift gives another triangulation of the same wall.
    pub shift: [f64; 3],
    /// Edge length to aim at, in cells, where vessels have the radius `thin` or less.
    pub edge: f64,
    /// A radius.
    pub thin: f64,
    /// How far edges follow the radius of wider vessels: they grow with the radius to this power. 0: not at all; 1: in
    /// proportion.
    pub follow: f64,
    /// Rounds of relaxation.
    pub rounds: u32,
    /// Most cells that the wall may cross.
    pub max_cells: usize,
}

/// Collapsing a contour that is too fine leaves longer edges than a contour of the right size has: so much less is aimed
/// at.
const COARSENED: f64 = 0.93;

impl SurfaceParams {
    /// Usual parameters for a cell edge; edges are as long everywhere.
    pub fn with_voxel(voxel: f64) -> Self {
        Self {
            voxel,
            kappa: KAPPA,
            shift: [0.0; 3],
            edge: 0.965,
            thin: 1.0,
            follow: 0.0,
            rounds: 2,
            max_cells: 20_000_000,
        }
    }

    /// The edge length to aim at where a vessel has this radius.
    pub fn edge_at(&self, radius: f64) -> f64 {
        let wider = (radius / self.thin).max(1.0).powf(self.follow);
        self.edge * self.voxel * (COARSENED * wider).max(1.0)
    }
}

/// Why there is no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// There is no tube with a length.
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
    /// The grid is too coarse to see a tube.
    #[error("the grid (cell {voxel}) does not see tube {tube}")]
    Unresolved {
        /// Index of the tube.
        tube: u32,
        /// The cell edge.
        voxel: f64,
    },
    /// The tubes do not make one connected vessel.
    #[error("tubes {} and {} are not connected: the wall has {components} components", tubes[0], tubes[1])]
    Disconnected {
        /// Number of components.
        components: u32,
        /// One tube of each of two components.
        tubes: [u32; 2],
    },
    /// Contouring gave a surface that is not a closed manifold, which is a bug.
    #[error("the contour is not a closed manifold at edge {} – {}", edge[0], edge[1])]
    NotManifold {
        /// Vertices of the edge (equal: of the vertex).
        edge: [u32; 2],
    },
}
