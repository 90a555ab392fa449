//! Radius error of the sections of a mesh or a network.

use super::spread::Spread;
use serde::Serialize;

/// Network that radii are compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RadiusReference {
    /// Wall of the mesh and the given vessels.
    #[default]
    Given,
    /// Wall of the mesh and the moved vessels, because the wall of a moved vessel is far from the given one.
    Moved,
    /// Radii of a network and those of the given one, without a mesh.
    Network,
}

/// Relative radius error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SectionErrors {
    /// Distribution of |d − r| / r.
    #[serde(flatten)]
    pub spread: Spread,
    /// Compared networks.
    pub of: RadiusReference,
}
