//! Parameters of a grown network and their errors.

/// Number of terminals of a rat kidney (afferent arterioles; Nordsletten et al. 2006).
pub(super) const TERMINALS: f64 = 29_566.0;

/// Radius of these terminals, in µm.
pub(super) const TERMINAL_RADIUS: f64 = 10.08;

/// Range of terminal radii, in µm.
pub(super) const LEAST_RADIUS: f64 = 1e-6;

pub(super) const LARGEST_RADIUS: f64 = 1e6;

/// Maximum number of terminals: more would exceed the node ids.
pub(super) const MOST_TERMINALS: u32 = 1_000_000_000;

/// Maximum organ size, in µm. Larger lengths and radii cannot be meshed.
pub(super) const LARGEST_SIZE: f64 = 1e9;

/// Minimum distance of terminals, in their radii, that leaves space for vessels.
pub(super) const CLOSEST: f64 = 6.0;

/// Shape to fill with vessels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Organ {
    /// Ellipsoid with a dense cortex and a sparse medulla; the vessel enters at a hilum without terminals.
    #[default]
    Kidney,
    /// Ellipsoid with uniform density.
    Ellipsoid,
}

impl Organ {
    /// Default exponent of Murray's law: 3 is Murray's own. With 3.2 all orders of a kidney of 29,566 terminals come
    /// closest to the published radii (thinnest to thickest alone: 3.36).
    pub fn usual_exponent(self) -> f64 {
        match self {
            Self::Kidney => 3.2,
            Self::Ellipsoid => 3.0,
        }
    }
}

/// Parameters of a grown network. Lengths are in µm.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct GenerateParams {
    /// Organ to fill.
    pub organ: Organ,
    /// Number of terminals: the outlets of the tree, in addition to one inlet.
    pub terminals: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Mean radius of the terminals.
    pub terminal_radius: f64,
    /// Exponent p of Murray's law r₀ᵖ = r₁ᵖ + r₂ᵖ.
    pub exponent: f64,
    /// Longest extent of the organ; the default gives the terminal density of a rat kidney.
    pub size: Option<f64>,
}

anastomesh_mesh::setters!(GenerateParams {
    organ: Organ,
    terminals: u32,
    seed: u64,
    terminal_radius: f64,
    exponent: f64,
    size: impl Into<Option<f64>>,
});

/// Reasons why no network can be grown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// The number of terminals is too small for a tree, or exceeds the node ids.
    #[error("{terminals} terminals: give 2 to {MOST_TERMINALS}")]
    BadCount {
        /// Requested number.
        terminals: u32,
    },
    /// The terminal radius is out of range.
    #[error("terminal radius {radius}: give {LEAST_RADIUS:e} to {LARGEST_RADIUS:e} µm")]
    BadRadius {
        /// Requested radius, µm.
        radius: f64,
    },
    /// The exponent is out of range.
    #[error("exponent {exponent}: give 1.5 to 10 (Murray's law: 3)")]
    BadExponent {
        /// Requested exponent.
        exponent: f64,
    },
    /// The size is out of range.
    #[error("size {size} µm: give a size above 0 and at most {LARGEST_SIZE:e} µm")]
    BadSize {
        /// Longest extent, µm.
        size: f64,
    },
    /// The root would fill the organ.
    #[error(
        "a root of radius {root:.0} µm does not fit into {size:.0} µm: give a larger exponent or size, or thinner terminals"
    )]
    TooThick {
        /// Root radius by Murray's law, µm.
        root: f64,
        /// Longest extent, µm.
        size: f64,
    },
    /// The terminals would be too close for vessels between them.
    #[error(
        "{terminals} terminals do not fit into {size:.0} µm: they would be closer than {CLOSEST} radii; give a size of at least {least:.0} µm"
    )]
    TooDense {
        /// Longest extent, µm.
        size: f64,
        /// Minimum size that holds them, µm.
        least: f64,
        /// Number of terminals.
        terminals: u32,
    },
    /// The capillaries are too thick for their length.
    #[error(
        "capillaries of radius {radius} and length {length} µm: give a positive radius, and a length of at least 12 radii"
    )]
    BadBed {
        /// Mean radius, µm.
        radius: f64,
        /// Mean length, µm.
        length: f64,
    },
    /// A capillary bed was requested in a kidney.
    #[error("capillaries need the organ ellipsoid")]
    BedOfKidney,
    /// The organ could not be filled.
    #[error("only {placed} of {terminals} terminals were placed: give a larger size, or thinner or fewer terminals")]
    NoRoom {
        /// Terminals placed.
        placed: u32,
        /// Requested number.
        terminals: u32,
    },
}

impl GenerateParams {
    /// Default parameters for this number of terminals in an organ.
    pub fn new(organ: Organ, terminals: u32) -> Self {
        Self {
            organ,
            terminals,
            seed: 0,
            terminal_radius: TERMINAL_RADIUS,
            exponent: organ.usual_exponent(),
            size: None,
        }
    }
}
