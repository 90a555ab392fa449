//! Parameters of a block, including those varied by retries.

use super::error::BlockError;
use anastomesh_mesh::TriMesh;
use anastomesh_skeleton::resolution::{FOLLOW, KAPPA, RHO};
use anastomesh_tet::Effort;
use anastomesh_tet::{Interior, Layers, Tetrahedralizer};

/// Type of a cluster's end at a cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum EndStyle {
    /// Close the wall by a flat disc on the plane, as at a terminal. The tip is removed from the surface before
    /// filling, so no mesh is discarded.
    #[default]
    Disc,
    /// Like `Disc`, with the disc derived from the vessel alone (`SharedDisc`), so that the neighbour is not needed.
    Shared,
    /// Leave the end open: the vessel continues beyond the plane with a round end, which the caller must remove.
    Open,
}

/// Parameters of a block.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BlockParams {
    /// Resolution ρ: voxels across the thinnest vessel of the cluster.
    pub rho: f64,
    /// Exponent by which edge length grows with the radius of wider vessels, from 0 (constant) to 1 (proportional).
    pub follow: f64,
    /// Factor on the voxel size; below 1 is finer. Varied by retries.
    pub voxel_factor: f64,
    /// Origin of the contouring grid in voxels, each in [−1, 1]. Retries vary it to change the triangulation.
    pub shift: [f64; 3],
    /// Kernel width σ / r of the convolution. Retries use smaller kernels, which fuse less.
    pub kappa: f64,
    /// First division of a connector's tube to try, 0 to `DIVISIONS` − 1. Varied by retries.
    #[serde(default)]
    pub first_division: usize,
    /// Type of a cluster's ends at cuts.
    pub ends: EndStyle,
    /// Relax end surfaces after flattening.
    pub relax_ends: bool,
    /// Accept defects where vessels of the network overlap. Walls may have other handles than the skeleton has loops
    /// ([`super::ClusterMesh::handles`]). Tips inside another vessel have no cap ([`super::ClusterMesh::uncapped`]).
    pub allow_fused: bool,
    /// Close narrow gaps between vessels that touch beyond a bifurcation, where the wall has more handles than the skeleton
    /// has loops. Otherwise fill the narrow ends of crotches.
    #[serde(default)]
    pub close_gaps: bool,
    /// Maximum depth of an end surface below its plane, in radii of the cut.
    pub depth: f64,
    /// Elongation of template tetrahedra along the vessel.
    #[serde(default = "unstretched")]
    pub stretch: f64,
    /// Edge length on the axis of a vessel relative to the wall.
    #[serde(default = "unstretched")]
    pub core: f64,
    /// Boundary layers along the wall; only with [`EndStyle::Shared`].
    #[serde(default)]
    pub layers: Option<Layers>,
    /// Create the closed surface only, without tetrahedra.
    #[serde(default)]
    pub hollow: bool,
    /// The block is good only without a folded vertex on the wall.
    #[serde(default)]
    pub unfolded: bool,
}

fn unstretched() -> f64 {
    1.0
}

impl Default for BlockParams {
    fn default() -> Self {
        Self {
            rho: RHO,
            follow: FOLLOW,
            voxel_factor: 1.0,
            shift: [0.0; 3],
            kappa: KAPPA,
            first_division: 0,
            ends: EndStyle::Disc,
            relax_ends: true,
            allow_fused: false,
            close_gaps: false,
            depth: 1.5,
            stretch: unstretched(),
            core: 1.0,
            layers: None,
            hollow: false,
            unfolded: false,
        }
    }
}

impl BlockParams {
    /// Default parameters at a resolution.
    pub fn with_rho(rho: f64) -> Self {
        Self { rho, ..Self::default() }
    }

    /// True if no retry parameter is set: only such blocks may use templates.
    pub(super) fn by_template(&self) -> bool {
        let Self { rho, follow, ends, allow_fused, stretch, core, layers, hollow, unfolded, .. } = *self;
        *self == Self { rho, follow, ends, allow_fused, stretch, core, layers, hollow, unfolded, ..Self::default() }
    }

    pub(super) fn check(&self) -> Result<(), BlockError> {
        let positive =
            [("rho", self.rho), ("voxel_factor", self.voxel_factor), ("kappa", self.kappa), ("depth", self.depth)];
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(BlockError::Parameter { name, value });
            }
        }
        if !(0.0..=1.0).contains(&self.follow) {
            return Err(BlockError::Parameter { name: "follow", value: self.follow });
        }
        if !(self.core > 0.0 && self.core.is_finite()) {
            return Err(BlockError::Parameter { name: "core", value: self.core });
        }
        if !(self.stretch >= 1.0 && self.stretch.is_finite()) {
            return Err(BlockError::Parameter { name: "stretch", value: self.stretch });
        }
        if let Some(layers) = self.layers {
            let usable = layers.check().is_ok() && self.ends == EndStyle::Shared && !self.hollow;
            if !usable {
                return Err(BlockError::Parameter { name: "layers", value: f64::from(layers.count) });
            }
        }
        match self.shift.iter().find(|x| x.is_nan() || x.abs() > 1.0) {
            Some(&value) => Err(BlockError::Parameter { name: "shift", value }),
            None => Ok(()),
        }
    }
}

/// Cell size of the inner lattice and its distance from the wall, in edge lengths of the nearby wall. Dense and close
/// enough for a mean radius ratio of 0.84 in vessels of three voxels across.
const CELL: f64 = 1.38;
const CLEARANCE: f64 = 0.37;

/// Range of block radii, in mean edge lengths, over which `core` takes effect: none at the first, full at the second.
const WIDE: [f64; 2] = [1.0, 3.0];

/// Fill options of a block whose edges are `core` times as long on the vessel axes as at the wall. No certificate is
/// needed, as the whole mesh is checked at the end.
pub(super) fn filling(surface: &TriMesh, core: f64) -> Tetrahedralizer {
    let wide = ((half_width(surface) / surface.mean_edge() - WIDE[0]) / (WIDE[1] - WIDE[0])).clamp(0.0, 1.0);
    let interior = Interior::Local { cell: CELL * (1.0 + (core - 1.0) * wide), clearance: CLEARANCE };
    Tetrahedralizer::new().interior(interior).effort(Effort::Quick)
}

/// Twice the volume over the area of a surface: the radius of a tube.
fn half_width(surface: &TriMesh) -> f64 {
    let Some(&origin) = surface.points.first() else { return 0.0 };
    let (mut volume, mut area) = (0.0, 0.0);
    for t in &surface.triangles {
        let [a, b, c] = t.map(|v| surface.points[v as usize] - origin);
        volume += a.cross(&b).dot(&c) / 6.0;
        area += (b - a).cross(&(c - a)).norm() / 2.0;
    }
    2.0 * volume / area
}
