//! What to grow, and why it may not be possible.

/// Terminals of a rat's kidney (afferent arterioles; Nordsletten et al. 2006).
pub(super) const TERMINALS: f64 = 29_566.0;

/// Their radius, µm, and its standard deviation as a share of it.
pub(super) const TERMINAL_RADIUS: f64 = 10.08;

/// Radii of terminals, µm.
pub(super) const LEAST_RADIUS: f64 = 1e-6;

pub(super) const LARGEST_RADIUS: f64 = 1e6;

/// More terminals have more nodes than ids.
pub(super) const MOST_TERMINALS: u32 = 1_000_000_000;

/// Longest organ, µm: beyond, lengths and radii are nothing that can be meshed.
pub(super) const LARGEST_SIZE: f64 = 1e9;

/// Terminals closer than this, in their radii, leave no room for vessels between them.
pub(super) const CLOSEST: f64 = 6.0;

/// What is filled with vessels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Organ {
    /// An ellipsoid whose cortex is dense with terminals and whose medulla holds few; the vessel enters at a hilum that
    /// holds none.
    #[default]
    Kidney,
    /// An ellipsoid filled evenly.
    Ellipsoid,
}

impl Organ {
    /// Exponent of Murray's law unless another is asked for: 3 is Murray's own; with 3.2 all orders of a kidney of
    /// 29,566 terminals come closest to the published radii (from the thinnest to the thickest it is 3.36 there).
    pub fn usual_exponent(self) -> f64 {
        match self {
            Self::Kidney => 3.2,
            Self::Ellipsoid => 3.0,
        }
    }
}

/// What to grow. Lengths are in µm.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct GenerateParams {
    /// What is filled.
    pub organ: Organ,
    /// Number of terminals: outlets of the tree, which has one inlet besides.
    pub terminals: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Mean radius of the terminals.
    pub terminal_radius: f64,
    /// Exponent p of Murray's law r₀ᵖ = r₁ᵖ + r₂ᵖ.
    pub exponent: f64,
    /// Longest extent of the organ; by default that at which terminals are as dense as in a rat's kidney.
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

/// Why no network can be grown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// Too few terminals for a tree, or more than there are ids.
    #[error("{terminals} terminals: a tree has 2 to {MOST_TERMINALS}")]
    BadCount {
        /// Number asked for.
        terminals: u32,
    },
    /// The radius of the terminals is not one.
    #[error("terminal radius {radius}: from {LEAST_RADIUS:e} to {LARGEST_RADIUS:e} µm is possible")]
    BadRadius {
        /// What was asked for, µm.
        radius: f64,
    },
    /// The exponent leads to vessels that are no tree of vessels.
    #[error("exponent {exponent}: Murray's law takes 3; from 1.5 to 10 is possible")]
    BadExponent {
        /// What was asked for.
        exponent: f64,
    },
    /// The size is not one.
    #[error("size {size} µm: it must be above 0 and at most {LARGEST_SIZE:e} µm")]
    BadSize {
        /// Longest extent, µm.
        size: f64,
    },
    /// The root would fill the organ.
    #[error(
        "a root of radius {root:.0} µm does not fit into {size:.0} µm: take a larger exponent or size, or thinner terminals"
    )]
    TooThick {
        /// Radius that Murray's law gives it, µm.
        root: f64,
        /// Longest extent, µm.
        size: f64,
    },
    /// Terminals would be closer than vessels between them allow.
    #[error(
        "{terminals} terminals do not fit into {size:.0} µm: they would be closer to each other than {CLOSEST} radii; a \
         size of {least:.0} µm holds them"
    )]
    TooDense {
        /// Longest extent, µm.
        size: f64,
        /// Least size that holds them, µm.
        least: f64,
        /// Number of terminals.
        terminals: u32,
    },
    /// Capillaries that are too thick for their length.
    #[error(
        "capillaries of radius {radius} and length {length} µm: the radius must be above 0, and the length at least twelve \
         times as large"
    )]
    BadBed {
        /// Mean radius, µm.
        radius: f64,
        /// Mean length, µm.
        length: f64,
    },
    /// A bed in a kidney.
    #[error("capillaries fill a piece of tissue evenly: choose the organ ellipsoid")]
    BedOfKidney,
    /// The organ could not be filled.
    #[error("only {placed} of {terminals} terminals found a place: give a larger size, thinner terminals or fewer")]
    NoRoom {
        /// Terminals placed.
        placed: u32,
        /// Number asked for.
        terminals: u32,
    },
}

impl GenerateParams {
    /// So many terminals in an organ, all else as usual.
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
