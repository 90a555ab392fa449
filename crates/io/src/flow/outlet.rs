//! Models of the circulation beyond an outlet.

/// Model of the circulation beyond an outlet. Units are consistent with the mesh: SI for a mesh in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum OutletModel {
    /// Given pressure.
    Pressure(f64),
    /// Pressure proportional to the flow rate.
    Resistance {
        /// Pressure per flow rate.
        resistance: f64,
        /// Pressure beyond the resistance.
        distal_pressure: f64,
    },
    /// Three-element windkessel: a resistance, then a capacitance and a second resistance in parallel.
    Rcr {
        /// Resistance next to the outlet.
        proximal: f64,
        /// Volume per pressure.
        capacitance: f64,
        /// Resistance beyond the capacitance.
        distal: f64,
        /// Pressure beyond the distal resistance, and outside the capacitance.
        distal_pressure: f64,
    },
}

impl Default for OutletModel {
    fn default() -> Self {
        Self::Pressure(0.0)
    }
}

impl OutletModel {
    /// Total resistance to steady flow; 0 for a given pressure.
    #[must_use]
    pub fn resistance(&self) -> f64 {
        match *self {
            Self::Pressure(_) => 0.0,
            Self::Resistance { resistance, .. } => resistance,
            Self::Rcr { proximal, distal, .. } => proximal + distal,
        }
    }

    /// Pressure at the outlet for a steady flow rate.
    #[must_use]
    pub fn mean_pressure(&self, rate: f64) -> f64 {
        let beyond = match *self {
            Self::Pressure(pressure) => pressure,
            Self::Resistance { distal_pressure, .. } | Self::Rcr { distal_pressure, .. } => distal_pressure,
        };
        beyond + self.resistance() * rate
    }

    /// Model of two outlets in parallel, if both are of the same kind with the same pressure beyond.
    ///
    /// Conductances and capacitances add.
    #[must_use]
    pub fn parallel(&self, other: &Self) -> Option<Self> {
        let both = |a: f64, b: f64| if a > 0.0 && b > 0.0 { 1.0 / (1.0 / a + 1.0 / b) } else { 0.0 };
        match (*self, *other) {
            (Self::Pressure(a), Self::Pressure(b)) => (a == b).then_some(Self::Pressure(a)),
            (
                Self::Resistance { resistance: a, distal_pressure },
                Self::Resistance { resistance: b, distal_pressure: beyond },
            ) => (distal_pressure == beyond).then_some(Self::Resistance { resistance: both(a, b), distal_pressure }),
            (
                Self::Rcr { proximal, capacitance, distal, distal_pressure },
                Self::Rcr { proximal: p, capacitance: c, distal: d, distal_pressure: beyond },
            ) => (distal_pressure == beyond).then_some(Self::Rcr {
                proximal: both(proximal, p),
                capacitance: capacitance + c,
                distal: both(distal, d),
                distal_pressure,
            }),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlets_in_parallel_add_their_conductances() {
        let model = |scale: f64| OutletModel::Rcr {
            proximal: scale,
            capacitance: 2.0 / scale,
            distal: 9.0 * scale,
            distal_pressure: 3.0,
        };
        let both = model(2.0).parallel(&model(2.0)).unwrap();
        assert_eq!(both, model(1.0));
        assert_eq!((both.resistance(), both.mean_pressure(2.0)), (10.0, 23.0));
        assert_eq!(model(1.0).parallel(&OutletModel::default()), None);
        assert_eq!(OutletModel::Pressure(1.0).parallel(&OutletModel::Pressure(2.0)), None);
    }
}
