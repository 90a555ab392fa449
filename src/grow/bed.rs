//! What a bed of capillaries is.

use serde::Serialize;

use super::net::DENSITY;
use super::organ::SEMI_AXES;
use super::params::GenerateError;
use super::random::{Random, Stream};

/// Nodes of the net per end of either tree.
const PER_TERMINAL: f64 = 12.0;
/// Spread of the radii of capillaries, as a share of their mean; none is off by more than three times as much.
const RADIUS_SPREAD: f64 = 0.14;

/// The bed between two trees. Lengths are in µm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BedParams {
    /// Mean radius.
    pub radius: f64,
    /// Mean length of a vessel.
    pub length: f64,
}

impl Default for BedParams {
    /// Radii as in the cortex of mice, whose capillaries are 2 to 5 µm wide (Sargent et al., 'Endothelial structure contributes to
    /// heterogeneity in brain capillary diameter', Vasc. Biol. 5 (2023)). The length is an assumption: it is not taken from
    /// measurements.
    fn default() -> Self {
        Self { radius: 1.75, length: 60.0 }
    }
}

impl BedParams {
    /// Longest extent of an ellipsoid with a bed for so many ends of either tree.
    pub fn usual_size(&self, terminals: u32) -> f64 {
        let volume = f64::from(terminals) * 2.0 * PER_TERMINAL * self.length.powi(3) / DENSITY;
        let unit = std::f64::consts::FRAC_PI_6 * SEMI_AXES[0] * SEMI_AXES[1] * SEMI_AXES[2];
        (volume / unit).cbrt()
    }

    /// How thick capillaries are at most.
    pub(super) fn thick(&self) -> f64 {
        self.radius * (1.0 + 3.0 * RADIUS_SPREAD)
    }

    /// A radius about the mean; `which` of them.
    pub(super) fn any_radius(&self, random: Random, stream: Stream, which: u64) -> f64 {
        self.radius * (1.0 + RADIUS_SPREAD * random.bell(stream, which))
    }

    /// # Errors
    /// When vessels would be too thick for their length.
    pub(super) fn check(&self) -> Result<(), GenerateError> {
        let fits = self.radius > 0.0 && self.length.is_finite() && self.length >= 8.0 * self.thick();
        if fits { Ok(()) } else { Err(GenerateError::BadBed { radius: self.radius, length: self.length }) }
    }
}
