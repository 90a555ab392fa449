//! Request to the tetrahedralizer, and its result.

use super::certify::Place;
use super::input::SurfaceEdges;
use super::optimize::{Effort, OptimizeReport};
use super::options::{Interior, Refinement, Sizing};
use super::plc::LeftOut;
use super::plc::{InputKind, Region};
use super::progress::Watch;
use super::recover::RecoverySummary;
use super::refine::RefineReport;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{TetMesh, TriMesh};

/// A checked input with its options.
pub(super) struct Request<'a> {
    pub surface: &'a TriMesh,
    pub edges: &'a SurfaceEdges,
    pub segments: &'a [[u32; 2]],
    pub kind: InputKind,
    /// Number of last triangles of a closed surface that lie inside and separate nothing.
    pub baffles: usize,
    pub holes: &'a [Point3],
    pub regions: &'a [Region],
    /// Region that the whole volume belongs to. Its seed is not located.
    pub region: Option<&'a Region>,
    pub interior: &'a Interior,
    /// True if the points of [`Interior::Growing`] are selected, so that edge lengths grow as fast as they may.
    pub spaced: bool,
    /// Edge lengths at points inside, from which the points of [`Interior::Growing`] grow apart, too.
    pub sources: &'a [(Point3, f64)],
    pub refinement: Option<&'a Refinement>,
    pub sizing: &'a Sizing,
    /// Height wanted for the first tetrahedra at each point of the surface, where it is more than that of a regular
    /// tetrahedron at its edges. Empty without layers.
    pub heights: &'a [f64],
    pub optimize: bool,
    /// True if the mesh is to be certified against the surface.
    pub certify: bool,
    /// True if the improvement spends less on tetrahedra beside needles of the surface.
    pub spare_needles: bool,
    pub effort: Effort,
    /// True if triangles and segments outside are an error.
    pub strict: bool,
    /// Maximum number of tetrahedra; `None`: any.
    pub max_tets: Option<usize>,
    /// True if tetrahedra are labelled by region.
    pub label: bool,
    pub watch: &'a Watch<'a>,
}

/// A certified mesh.
pub(super) struct Filled {
    pub mesh: TetMesh,
    /// Position in the mesh of each input triangle that is not left out; empty without the certificate.
    pub places: Vec<Place>,
    /// Parts of the input outside.
    pub left_out: LeftOut,
    /// Region of each tetrahedron, empty for a single unnamed region.
    pub regions: Vec<i32>,
    pub region_count: usize,
    /// Region seeds in regions with an earlier one, each with that one.
    pub ignored_seeds: Vec<[u32; 2]>,
    /// Seed of each region, in the order of their first tetrahedra; empty if not labelled.
    pub seeds: Vec<Option<u32>>,
    pub recovery: RecoverySummary,
    pub optimize: Option<OptimizeReport>,
    pub refine: Option<RefineReport>,
}
