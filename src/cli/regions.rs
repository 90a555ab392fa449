//! Regions around a lumen, in memory or in parts.

use crate::pipeline::{Estimate, Store};
use anastomesh_domain::{Domain, DomainError, DomainInParts, DomainPlan, ShellsReport};
use anastomesh_mesh::NamedRegion;
use anastomesh_mesh::check::{CheckReport, Expectation};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_skeleton::Skeleton;
use anastomesh_tet::TetError;

/// Maximum boundary faces of a lumen whose regions are made in memory.
const IN_MEMORY: usize = 1_000_000;

/// Tetrahedra of the tissue per triangle of the wall, as measured with kidneys at a growth of 1.3.
const TISSUE_PER_TRIANGLE: f64 = 9.4;
/// Bytes of memory per tetrahedron of regions that are made in memory, the lumen included.
const BYTES_PER_TET: f64 = 90.0;
/// Bytes of memory per triangle of the wall for regions in parts: the largest need of growing shells, dividing tissue and the
/// check.
const BYTES_PER_TRIANGLE: f64 = 310.0;

/// Maximum tetrahedra of tissue that is made in memory, if no limit of memory is given. They need 9 GB.
const TETS: usize = 100_000_000;
/// Maximum tetrahedra of tissue in parts. A mesh has at most 2³² points, and five to six times as many tetrahedra.
const TETS_IN_PARTS: usize = (u32::MAX as usize).saturating_mul(5);

/// True if the regions around a lumen are expected to be made in parts.
fn are_in_parts(lumen: &Estimate, plan: &DomainPlan) -> bool {
    plan.may_be_in_parts() && lumen.wall > IN_MEMORY as f64
}

/// Limits the tetrahedra of the tissue to what a limit of memory holds.
pub fn limit(plan: &mut DomainPlan, lumen: &Estimate, memory: Option<u64>) {
    let is_in_parts = are_in_parts(lumen, plan);
    let in_memory = memory.map_or(TETS, |bytes| (bytes as f64 / BYTES_PER_TET - lumen.tets).max(0.0) as usize);
    if let Some(tissue) = &mut plan.tissue {
        tissue.max_tets = if is_in_parts { TETS_IN_PARTS } else { in_memory };
    }
}

/// Advice for a failure of regions. `size` is the option for their edge length.
pub fn advice(error: &DomainError, size: &str) -> String {
    match error {
        DomainError::Tissue(TetError::TooMany { .. }) => {
            format!("; give a larger {size} or --tissue-growth, or raise --memory")
        }
        _ => String::new(),
    }
}

/// Estimate of a mesh with regions from that of its lumen.
pub fn with_regions(lumen: &Estimate, plan: &DomainPlan) -> Estimate {
    if plan.is_plain() {
        return *lumen;
    }
    let layers: u32 = plan.shells.iter().map(|shell| shell.layers).sum();
    let of_shells = 3.0 * f64::from(layers) * lumen.wall;
    let of_tissue = if plan.tissue.is_some() { TISSUE_PER_TRIANGLE * lumen.wall } else { 0.0 };
    let tets = of_shells + of_tissue;
    if are_in_parts(lumen, plan) {
        lumen.with_regions(tets, of_tissue, (BYTES_PER_TRIANGLE * lumen.wall) as u64)
    } else {
        lumen.with_regions(tets, 0.0, (BYTES_PER_TET * (lumen.tets + tets)) as u64)
    }
}

/// Regions around a lumen. Both kinds have the same content.
pub enum Regions<'a> {
    Whole(Box<Domain>),
    Parts(Box<DomainInParts<'a>>),
}

/// The mesh of a lumen with its network.
pub struct Lumen<'a> {
    pub mesh: &'a dyn MeshSource,
    pub network: &'a Skeleton,
    pub expectation: &'a Expectation,
    pub check: &'a CheckReport,
}

impl<'a> Regions<'a> {
    /// Makes the regions, in parts if they are large and all formats allow it. Parts are kept in the store.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn around(
        lumen: &Lumen<'a>,
        plan: &DomainPlan,
        store: Option<&'a Store>,
        bars: &dyn Progress,
    ) -> Result<Self, DomainError> {
        let Lumen { mesh, network, expectation, check } = *lumen;
        match store {
            Some(store) if plan.may_be_in_parts() && mesh.counts().boundary > IN_MEMORY => {
                let made = DomainInParts::around(mesh, network, plan, check, store, bars)?;
                Ok(Self::Parts(Box::new(made)))
            }
            _ => Ok(Self::Whole(Box::new(Domain::around(gather(mesh)?, network, plan, expectation, bars)?))),
        }
    }

    /// The mesh.
    pub fn mesh(&self) -> &dyn MeshSource {
        match self {
            Self::Whole(made) => &made.mesh,
            Self::Parts(made) => &made.mesh,
        }
    }

    /// The regions, by ascending id.
    pub fn list(&self) -> &[NamedRegion] {
        match self {
            Self::Whole(made) => &made.regions,
            Self::Parts(made) => &made.regions,
        }
    }

    /// Thickness of the shells.
    pub fn shells(&self) -> Option<&ShellsReport> {
        match self {
            Self::Whole(made) => made.shells.as_ref(),
            Self::Parts(made) => made.shells.as_ref(),
        }
    }

    /// Report of the validity check.
    pub fn check(&self) -> &CheckReport {
        match self {
            Self::Whole(made) => &made.check,
            Self::Parts(made) => &made.check,
        }
    }
}
