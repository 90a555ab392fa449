//! Tissue around vessels that are lines, and the vessels in its cells.

use super::organ::surface;
use super::pieces::Pieces;
use super::plan::EmbedPlan;
use super::sources::sources;
use crate::error::DomainError;
use crate::plan::TISSUE;
use anastomesh_mesh::check::{CheckReport, check_regions_watched};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::{NamedRegion, Patch, TriMesh, VolumeMesh, WALL};
use anastomesh_skeleton::Skeleton;
use anastomesh_tet::parts::{Watch, fill_around};
use anastomesh_tet::{Interior, Sizing, Tetrahedralizer};

/// Id of the tissue.
const TISSUE_ID: i32 = 1;

/// Name of the boundary of the tissue.
const ORGAN: &str = "organ";

/// Mesh of tissue, with the vessels divided between its cells.
///
/// ```
/// use anastomesh_domain::{EmbedPlan, Embedding};
/// use anastomesh_mesh::Point3;
/// use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};
///
/// let node = |z: f64, original| Node { position: Point3::new(0.0, 0.0, z), radius: 1.0, original };
/// let edges = vec![Edge { nodes: [NodeId(0), NodeId(1)], radii: [1.0; 2] }];
/// let vessel = Skeleton { nodes: vec![node(0.0, 0), node(9.0, 1)], edges };
/// let made = Embedding::of(&vessel, &EmbedPlan::default(), &())?;
/// let length: f64 = made.pieces.list.iter().map(|piece| piece.length).sum();
/// assert!(made.check.failed().next().is_none() && (length - 9.0).abs() < 1e-12);
/// # Ok::<(), anastomesh_domain::DomainError>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Embedding {
    /// Mesh of the tissue, which is its only block.
    pub mesh: VolumeMesh,
    /// The tissue.
    pub regions: Vec<NamedRegion>,
    /// Vessels in the cells of the mesh.
    pub pieces: Pieces,
    /// Report of the validity check.
    pub check: CheckReport,
}

impl Embedding {
    /// Fills the tissue around a network, divides the network between its cells, and checks the mesh.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn of(network: &Skeleton, plan: &EmbedPlan, progress: &dyn Progress) -> Result<Self, DomainError> {
        plan.validate()?;
        let sources = sources(network, &plan.size, plan.max_tets)?;
        let surface = surface(network, &plan.tissue, &Watch::of(progress))?;
        let mesh = fill(plan, &surface, &sources, progress)?;
        drop((sources, surface));
        let pieces = Pieces::of(&mesh.mesh, network, progress)?;
        let regions = vec![NamedRegion::new(TISSUE_ID, TISSUE)];
        progress.at(Stage::Check, 0, 0);
        let check = check_regions_watched(&mesh, &regions, None, progress)?;
        Ok(Self { mesh, regions, pieces, check })
    }
}

fn fill(
    plan: &EmbedPlan,
    surface: &TriMesh,
    sources: &[(Point3, f64)],
    progress: &dyn Progress,
) -> Result<VolumeMesh, DomainError> {
    let interior = Interior::Growing { growth: plan.tissue.growth };
    let mut filler = Tetrahedralizer::new().interior(interior).max_tets(plan.max_tets);
    if let Some(size) = plan.tissue.size {
        filler = filler.sizing(Sizing::Constant(size));
    }
    let filled = fill_around(&filler, surface, sources, &Watch::of(progress)).map_err(DomainError::Tissue)?;
    let (tets, faces) = (filled.mesh.tets.len(), filled.faces.len());
    Ok(VolumeMesh {
        mesh: filled.mesh,
        tet_block: vec![TISSUE_ID; tets],
        boundary: filled.faces,
        boundary_block: vec![TISSUE_ID; faces],
        boundary_patch: vec![WALL; faces],
        patches: vec![Patch { id: WALL, name: ORGAN.into(), cap: None }],
    })
}
