//! What is asked of the tetrahedralizer, and what comes of it.

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

/// A checked input and what is wanted of it.
pub(super) struct Request<'a> {
    pub surface: &'a TriMesh,
    pub edges: &'a SurfaceEdges,
    pub segments: &'a [[u32; 2]],
    pub kind: InputKind,
    pub holes: &'a [Point3],
    pub regions: &'a [Region],
    pub interior: &'a Interior,
    pub refinement: Option<&'a Refinement>,
    pub sizing: &'a Sizing,
    pub optimize: bool,
    /// Whether the mesh is proved to fill the surface.
    pub certify: bool,
    pub effort: Effort,
    /// Whether triangles and segments outside are an error.
    pub strict: bool,
    /// Whether tetrahedra are told apart by regions.
    pub label: bool,
    pub watch: &'a Watch<'a>,
}

/// A certified mesh.
pub(super) struct Filled {
    pub mesh: TetMesh,
    /// Where each triangle of the input that is not left out lies in it; empty without the certificate.
    pub places: Vec<Place>,
    /// What of the input lies outside.
    pub left_out: LeftOut,
    /// Region of each tetrahedron, where there is something to say.
    pub regions: Vec<i32>,
    pub region_count: usize,
    pub recovery: RecoverySummary,
    pub optimize: Option<OptimizeReport>,
    pub refine: Option<RefineReport>,
}
