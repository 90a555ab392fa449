//! Options of the regions around a lumen.

use anastomesh_mesh::{NamedRegion, TriMesh};
use anastomesh_tet::{Layers, LayersError, Tetrahedralizer};

/// Length that depends on the radius of the vessel: thickness of a shell, or edge length at a vessel.
///
/// ```
/// use anastomesh_domain::Thickness;
///
/// let arteriole = Thickness::Law { length: 2.0, radii: 0.1 };
/// assert_ne!(arteriole, Thickness::PerNode(vec![2.0; 31]));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Thickness {
    /// `length + radii · r`, where r is the radius of the vessel.
    Law {
        /// Constant part, in the unit of the network.
        length: f64,
        /// Share of the radius.
        radii: f64,
    },
    /// Thickness at each node of the network as it was read, interpolated along vessels.
    PerNode(Vec<f64>),
}

/// Place on a vessel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Site {
    /// Radius there.
    pub radius: f64,
    /// Ends of its edge, as nodes of the network that was read.
    pub ends: [u32; 2],
    /// Fraction of the way from the first end to the second.
    pub t: f64,
}

impl Thickness {
    /// Thickness at a place.
    pub(super) fn at(&self, site: &Site) -> f64 {
        match self {
            Self::Law { length, radii } => length + radii * site.radius,
            Self::PerNode(values) => {
                let [a, b] = site.ends.map(|node| values.get(node as usize).copied().unwrap_or_default());
                a + site.t * (b - a)
            }
        }
    }

    /// Value that is not positive, if there is one.
    pub(super) fn invalid(&self) -> Option<f64> {
        let negative = |x: &f64| !(*x >= 0.0 && x.is_finite());
        match self {
            Self::Law { length, radii } => {
                let either = [*length, *radii].into_iter().find(negative);
                either.or_else(|| Some(0.0).filter(|_| length + radii == 0.0))
            }
            Self::PerNode(values) => values.iter().copied().find(|x| negative(x) || *x == 0.0),
        }
    }
}

/// Shell around the lumen or around another shell, for instance the vessel wall.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShellPlan {
    /// Name of the region.
    pub name: String,
    /// Thickness.
    pub thickness: Thickness,
    /// Number of layers of prisms.
    pub layers: u32,
    /// Ratio of the thickness of each layer to that of the previous one, outwards.
    pub growth: f64,
}

anastomesh_mesh::setters!(ShellPlan { layers: u32, growth: f64 });

impl ShellPlan {
    /// Shell of two equal layers.
    pub fn new(name: impl Into<String>, thickness: Thickness) -> Self {
        Self { name: name.into(), thickness, layers: 2, growth: 1.0 }
    }
}

/// Shape of the tissue around the vessels.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TissueShape {
    /// Box around all vessels with this margin; `None`: 5 % of the diagonal, and at least the largest outer radius.
    Box {
        /// Margin, in the unit of the network.
        margin: Option<f64>,
    },
    /// Convex hull of all vessels with their shells, at this distance; `None`: as for a box.
    Hull {
        /// Distance from the outermost shells, in the unit of the network.
        margin: Option<f64>,
    },
    /// Closed surface around all vessels.
    Organ(TriMesh),
}

/// Region of the tissue inside a closed surface.
///
/// ```
/// use anastomesh_domain::TissueRegion;
///
/// let tumour = TissueRegion::new("tumour", anastomesh_mesh::shapes::sphere_surface(2));
/// assert_eq!(tumour.name, "tumour");
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TissueRegion {
    /// Name of the region.
    pub name: String,
    /// Closed surface, inside that of the organ. It may lie inside another region.
    pub surface: TriMesh,
}

impl TissueRegion {
    /// Region inside a surface.
    pub fn new(name: impl Into<String>, surface: TriMesh) -> Self {
        Self { name: name.into(), surface }
    }
}

/// Tissue around the vessels.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TissuePlan {
    /// Shape.
    pub shape: TissueShape,
    /// Regions of the tissue with surfaces of their own.
    pub regions: Vec<TissueRegion>,
    /// True if surfaces of organ and regions are remeshed to the size of the tissue. Otherwise their triangles are kept.
    pub remesh: bool,
    /// Maximum distance between a surface and the remeshed one; `None`: 0.001 of the diagonal.
    pub tolerance: Option<f64>,
    /// Maximum edge length, in the unit of the network; `None`: growth alone determines it.
    pub size: Option<f64>,
    /// Maximum ratio of edge lengths in adjacent layers of tetrahedra, away from the vessels.
    pub growth: f64,
    /// Terminals, as nodes of the network that was read, at which vessels leave the organ; see
    /// [`CutNetwork`](super::CutNetwork). Its surface is opened there.
    pub gates: Vec<u32>,
    /// Maximum triangles around tissue that is filled as a whole. Larger regions are divided into pieces, which are filled at the
    /// same time.
    pub piece: usize,
    /// Maximum number of tetrahedra of the tissue, if it is made in memory.
    pub max_tets: usize,
}

anastomesh_mesh::setters!(TissuePlan {
    regions: Vec<TissueRegion>,
    remesh: bool,
    tolerance: impl Into<Option<f64>>,
    size: impl Into<Option<f64>>,
    growth: f64,
    gates: Vec<u32>,
    piece: usize,
    max_tets: usize,
});

impl TissuePlan {
    /// Default of `growth`.
    pub const GROWTH: f64 = 1.3;
    /// Default of `piece`.
    pub const PIECE: usize = 50_000;

    /// Tissue of this shape.
    pub fn new(shape: TissueShape) -> Self {
        let (regions, gates) = (Vec::new(), Vec::new());
        Self {
            shape,
            regions,
            remesh: false,
            tolerance: None,
            size: None,
            growth: Self::GROWTH,
            gates,
            piece: Self::PIECE,
            max_tets: Tetrahedralizer::MAX_TETS,
        }
    }
}

/// Regions around the lumen, from the inside outwards.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DomainPlan {
    /// Shells.
    pub shells: Vec<ShellPlan>,
    /// Tissue.
    pub tissue: Option<TissuePlan>,
    /// Names of regions to leave out of the result.
    pub without: Vec<String>,
}

anastomesh_mesh::setters!(DomainPlan {
    shells: Vec<ShellPlan>,
    tissue: impl Into<Option<TissuePlan>>,
    without: Vec<String>,
});

/// Invalid plan of regions.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainPlanError {
    /// Tissue with embedded vessels has regions inside, or is to be remeshed.
    #[error("tissue with embedded vessels has no regions inside and keeps its surface: remove these options")]
    Embedded,
    /// A thickness is zero, negative or not finite.
    #[error("invalid thickness of {name} {value}: give a length, a share of the radius, or a sum of both, above 0")]
    Thickness {
        /// Name of the shell.
        name: String,
        /// Value.
        value: f64,
    },
    /// The edge length at embedded vessels is zero, negative or not finite.
    #[error(
        "invalid edge length at the vessels {0}: give a length, a multiple of the radius, or a sum of both, above 0"
    )]
    Size(f64),
    /// Layers of a shell are out of range.
    #[error("layers of {name}: {source}")]
    Layers {
        /// Name of the shell.
        name: String,
        /// Reason.
        source: LayersError,
    },
    /// Two regions have one name.
    #[error("two regions are called '{0}': give each a name of its own")]
    SameName(String),
    /// A name has characters other than letters, digits, `_` and `-`, or is empty.
    #[error("invalid name of a region '{0}': use letters, digits, '_' and '-'")]
    Name(String),
    /// A region to leave out does not exist.
    #[error("no region is called '{name}'; there are {known}")]
    Unknown {
        /// Name of the region.
        name: String,
        /// Names of all regions.
        known: String,
    },
    /// All regions are left out.
    #[error("all regions are left out: keep at least one")]
    Nothing,
    /// A margin, size or growth is out of range.
    #[error("invalid {what} of the tissue {value}: {range}")]
    Tissue {
        /// Quantity.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Valid values.
        range: &'static str,
    },
    /// A surface is to be remeshed, and there is none.
    #[error("nothing to remesh: a box or hull always has the size of the tissue")]
    Remesh,
}

/// Name of the region around the vessels.
pub const TISSUE: &str = "tissue";

impl DomainPlan {
    /// True if the lumen is the only region.
    pub fn is_plain(&self) -> bool {
        self.shells.is_empty() && self.tissue.is_none()
    }

    /// Names of all regions, from the inside outwards, with the regions of the tissue last. The id of a region is its place
    /// here, from 1.
    pub fn names(&self) -> Vec<&str> {
        let shells = self.shells.iter().map(|shell| shell.name.as_str());
        let inner = self.tissue.iter().flat_map(|tissue| &tissue.regions).map(|region| region.name.as_str());
        let all = std::iter::once(NamedRegion::LUMEN).chain(shells).chain(self.tissue.iter().map(|_| TISSUE));
        all.chain(inner).collect()
    }

    /// Checks names and ranges.
    ///
    /// # Errors
    /// The first fault.
    pub fn validate(&self) -> Result<(), DomainPlanError> {
        let names = self.names();
        for (i, &name) in names.iter().enumerate() {
            if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-') {
                return Err(DomainPlanError::Name(name.into()));
            }
            if names[..i].contains(&name) {
                return Err(DomainPlanError::SameName(name.into()));
            }
        }
        self.shells.iter().try_for_each(ShellPlan::validate)?;
        self.tissue.as_ref().map_or(Ok(()), TissuePlan::validate)?;
        if let Some(name) = self.without.iter().find(|name| !names.contains(&name.as_str())) {
            return Err(DomainPlanError::Unknown { name: name.clone(), known: names.join(", ") });
        }
        if names.iter().all(|name| self.without.iter().any(|out| out == name)) {
            return Err(DomainPlanError::Nothing);
        }
        Ok(())
    }
}

impl ShellPlan {
    fn validate(&self) -> Result<(), DomainPlanError> {
        if let Some(value) = self.thickness.invalid() {
            return Err(DomainPlanError::Thickness { name: self.name.clone(), value });
        }
        let layers = Layers::default().count(self.layers).growth(self.growth);
        layers.check().map_err(|source| DomainPlanError::Layers { name: self.name.clone(), source })
    }
}

impl TissuePlan {
    pub(super) fn validate(&self) -> Result<(), DomainPlanError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let fault = |what, value, range| Err(DomainPlanError::Tissue { what, value, range });
        match (&self.shape, self.size) {
            (TissueShape::Box { margin: Some(margin) } | TissueShape::Hull { margin: Some(margin) }, _)
                if !positive(*margin) =>
            {
                fault("margin", *margin, "give a length above 0")
            }
            _ if self.tolerance.is_some_and(|tolerance| !positive(tolerance)) => {
                fault("tolerance", self.tolerance.unwrap_or_default(), "give a distance above 0")
            }
            (_, Some(size)) if !positive(size) => fault("size", size, "give an edge length above 0"),
            (TissueShape::Box { .. } | TissueShape::Hull { .. }, _) if self.remesh && self.regions.is_empty() => {
                Err(DomainPlanError::Remesh)
            }
            _ if !(self.growth >= 1.1 && self.growth.is_finite()) => fault("growth", self.growth, "give 1.1 or more"),
            _ => Ok(()),
        }
    }
}
