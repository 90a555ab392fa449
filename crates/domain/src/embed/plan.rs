//! Options of an embedding.

use super::organ::check_edges;
use crate::before::contains_nodes;
use crate::error::DomainError;
use crate::plan::{DomainPlanError, Thickness, TissuePlan, TissueShape};
use anastomesh_skeleton::Skeleton;
use anastomesh_tet::Tetrahedralizer;

/// Tissue around vessels that are lines.
///
/// ```
/// use anastomesh_domain::{EmbedPlan, Thickness, TissuePlan, TissueShape};
///
/// let tissue = TissuePlan::new(TissueShape::Box { margin: Some(20.0) }).growth(2.0);
/// let plan = EmbedPlan::default().tissue(tissue).size(Thickness::Law { length: 0.0, radii: 4.0 });
/// assert!(plan.validate().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EmbedPlan {
    /// Edge length of the tetrahedra at a vessel.
    pub size: Thickness,
    /// Shape of the tissue, maximum edge length, and growth of edge lengths away from the vessels.
    pub tissue: TissuePlan,
    /// Maximum number of tetrahedra. A plan that needs more fails before the work.
    pub max_tets: usize,
}

anastomesh_mesh::setters!(EmbedPlan { size: Thickness, tissue: TissuePlan, max_tets: usize });

impl Default for EmbedPlan {
    fn default() -> Self {
        Self {
            size: Thickness::Law { length: 0.0, radii: Self::RADII },
            tissue: TissuePlan::new(TissueShape::Box { margin: None }),
            max_tets: Tetrahedralizer::MAX_TETS,
        }
    }
}

impl EmbedPlan {
    /// Default edge length at a vessel, in its radii.
    pub const RADII: f64 = 2.0;

    /// Checks ranges.
    ///
    /// # Errors
    /// The first fault.
    pub fn validate(&self) -> Result<(), DomainPlanError> {
        if let Some(value) = self.size.invalid() {
            return Err(DomainPlanError::Size(value));
        }
        if self.tissue.remesh || !self.tissue.regions.is_empty() {
            return Err(DomainPlanError::Embedded);
        }
        self.tissue.validate()
    }

    /// Checks ranges, and that the tissue's surface contains a network. Nodes exactly on the surface are inside. `name` is
    /// the name of a node in the file.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, network: &Skeleton, name: &dyn Fn(u32) -> String) -> Result<(), DomainError> {
        self.validate()?;
        let TissueShape::Organ(surface) = &self.tissue.shape else { return Ok(()) };
        Tetrahedralizer::new().check(surface).map_err(DomainError::Organ)?;
        contains_nodes(surface, network, &[], true, name)?;
        check_edges(surface, network, name)
    }
}
