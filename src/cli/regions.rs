//! Regions around a lumen, in memory or in parts.

use crate::pipeline::Store;
use anastomesh_domain::{Domain, DomainError, DomainInParts, DomainPlan, ShellsReport};
use anastomesh_mesh::NamedRegion;
use anastomesh_mesh::check::{CheckReport, Expectation};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_skeleton::Skeleton;

/// Maximum boundary faces of a lumen whose regions are made in memory.
const IN_MEMORY: usize = 1_000_000;

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
