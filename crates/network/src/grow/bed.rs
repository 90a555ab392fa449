//! Parameters of a capillary bed.

use serde::Serialize;

use super::net::DENSITY;
use super::organ::SEMI_AXES;
use super::params::GenerateError;
use super::random::{Random, Stream};

/// Nodes of the net per end of either tree.
const PER_TERMINAL: f64 = 12.0;
/// Standard deviation of capillary radii, relative to their mean; deviations are limited to three times this value.
const RADIUS_SPREAD: f64 = 0.14;

/// Capillary bed between two trees. Lengths are in µm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BedParams {
    /// Mean radius.
    pub radius: f64,
    /// Mean length of a vessel.
    pub length: f64,
}

impl Default for BedParams {
    /// Radii are those of mouse cortex, with capillaries 2 to 5 µm wide. (Sargent et al., 'Endothelial structure
    /// contributes to heterogeneity in brain capillary diameter', Vasc. Biol. 5 (2023)). The length is an assumption
    /// without measurements.
    fn default() -> Self {
        Self { radius: 1.75, length: 60.0 }
    }
}

impl BedParams {
    /// Longest extent of an ellipsoid whose bed serves this number of ends of either tree.
    pub fn usual_size(&self, terminals: u32) -> f64 {
        let volume = f64::from(terminals) * 2.0 * PER_TERMINAL * self.length.powi(3) / DENSITY;
        let unit = std::f64::consts::FRAC_PI_6 * SEMI_AXES[0] * SEMI_AXES[1] * SEMI_AXES[2];
        libm::cbrt(volume / unit)
    }

    /// Maximum capillary radius.
    pub(super) fn thick(&self) -> f64 {
        self.radius * (1.0 + 3.0 * RADIUS_SPREAD)
    }

    /// Random radius around the mean; `which` is its index.
    pub(super) fn any_radius(&self, random: Random, stream: Stream, which: u64) -> f64 {
        self.radius * (1.0 + RADIUS_SPREAD * random.bell(stream, which))
    }

    /// # Errors
    /// The vessels would be too thick for their length.
    pub(super) fn check(&self) -> Result<(), GenerateError> {
        let fits = self.radius > 0.0 && self.length.is_finite() && self.length >= 8.0 * self.thick();
        if fits { Ok(()) } else { Err(GenerateError::BadBed { radius: self.radius, length: self.length }) }
    }
}
