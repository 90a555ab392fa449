//! How blocks are made, and what a retry may change.

use super::error::BlockError;
use anastomesh_mesh::TriMesh;
use anastomesh_skeleton::resolution::{FOLLOW, KAPPA, RHO};
use anastomesh_tet::Effort;
use anastomesh_tet::{Interior, Layers, Tetrahedralizer};

/// How a cluster ends at a cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum EndStyle {
    /// The wall is closed by a flat disc on the plane, as at a terminal: the tip is taken off the surface before it is
    /// filled, and nothing that is meshed is thrown away.
    #[default]
    Disc,
    /// As `Disc`, but the disc is the one that the vessel alone gives (`SharedDisc`), so that the neighbour need
    /// not be known.
    Shared,
    /// It does not: the vessel goes on beyond the plane and ends round. What lies there is for the caller to take off.
    Open,
}

/// Parameters of a block.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BlockParams {
    /// Resolution ρ: voxels across the thinnest vessel of the cluster.
    pub rho: f64,
    /// How far edges follow the radius of vessels wider than the thinnest of the cluster: they grow with it to this power,
    /// 0 (not at all) to 1 (in proportion).
    pub follow: f64,
    /// Factor on the voxel; below 1 is finer. For retries.
    pub voxel_factor: f64,
    /// Origin of the contouring grid in voxels, each in [−1, 1]. For retries: another shift, another triangulation.
    pub shift: [f64; 3],
    /// Kernel width σ / r of the convolution. For retries: thinner kernels fuse less.
    pub kappa: f64,
    /// Which division of a connector's tube is tried first, 0 to `DIVISIONS` − 1. For retries.
    #[serde(default)]
    pub first_division: usize,
    /// How clusters end at cuts.
    pub ends: EndStyle,
    /// Whether end surfaces are relaxed after flattening.
    pub relax_ends: bool,
    /// Take what comes where the network's own vessels overlap: a wall with other handles than the skeleton has loops
    /// ([`super::ClusterMesh::handles`] tells), and tips inside another vessel without a cap
    /// ([`super::ClusterMesh::uncapped`]).
    pub allow_fused: bool,
    /// How deep below its plane an end surface may go, in radii of the cut.
    pub depth: f64,
    /// How much longer than wide tetrahedra of tubes by template are, along the vessel.
    #[serde(default = "unstretched")]
    pub stretch: f64,
    /// How much longer than at the wall edges are on the axis of a vessel.
    #[serde(default = "unstretched")]
    pub core: f64,
    /// Layers along the wall; only with [`EndStyle::Shared`].
    #[serde(default)]
    pub layers: Option<Layers>,
    /// Stop at the closed surface, and do not fill it.
    #[serde(default)]
    pub hollow: bool,
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
            depth: 1.5,
            stretch: unstretched(),
            core: 1.0,
            layers: None,
            hollow: false,
        }
    }
}

impl BlockParams {
    /// Usual parameters at a resolution.
    pub fn with_rho(rho: f64) -> Self {
        Self { rho, ..Self::default() }
    }

    /// Whether nothing is tried in another way than usual: blocks that can be had by template are.
    pub(super) fn by_template(&self) -> bool {
        let Self { rho, follow, ends, allow_fused, stretch, core, layers, hollow, .. } = *self;
        *self == Self { rho, follow, ends, allow_fused, stretch, core, layers, hollow, ..Self::default() }
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

/// Side of the lattice's cubes inside a block and its distance from the wall, in edge lengths of the wall nearby: dense
/// and close enough for a mean radius ratio of 0.84 in vessels of three voxels across.
const CELL: f64 = 1.38;
const CLEARANCE: f64 = 0.37;

/// A block is as wide as its core is far from its wall: from one radius (in mean edge lengths) to another, cubes become longer
/// or shorter there, all that they are to.
const WIDE: [f64; 2] = [1.0, 3.0];

/// How a block is filled whose edges are `core` times as long on the axes of its vessels as at the wall. There is no
/// certificate: the whole mesh is checked in the end.
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
