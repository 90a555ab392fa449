//! Time of a case with pulsatile flow.

/// Velocity profile on the cap of an inlet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Profile {
    /// The solver's own distribution of a flow rate: uniform in `OpenFOAM`, parabolic in `svMultiPhysics`.
    #[default]
    Solver,
    /// Uniform velocity.
    Uniform,
    /// Parabola of Poiseuille's flow.
    Parabolic,
    /// Womersley's profile of pulsatile flow in a straight tube.
    Womersley,
}

/// Simulated time of a case with pulsatile flow.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Transient {
    /// Duration of a period, in seconds.
    pub period: f64,
    /// Number of periods.
    pub periods: u32,
    /// Number of results per period.
    pub outputs: u32,
    /// Duration of the ramp from rest to the waveform, in seconds; 0 for none.
    pub ramp: f64,
}

impl Transient {
    /// Three periods with 20 results each, after a ramp of a tenth of a period.
    #[must_use]
    pub fn new(period: f64) -> Self {
        Self { period, periods: 3, outputs: 20, ramp: 0.1 * period }
    }

    /// End of the simulated time, in seconds.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.period * f64::from(self.periods)
    }
}

anastomesh_mesh::setters!(Transient { periods: u32, outputs: u32, ramp: f64 });
