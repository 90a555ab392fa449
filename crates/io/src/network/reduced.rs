//! Reduced-order model of a network: vessels with resistance, inertance and capacitance, and conditions at terminals.

use crate::flow::{OutletModel, Waveform};
use anastomesh_mesh::geometry::Point3;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Zero- or one-dimensional model of a network, for `svZeroDSolver` and `svOneDSolver`.
///
/// Units are consistent with the network: SI for lengths in metres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReducedModel {
    /// Position and radius of each node.
    pub nodes: Vec<(Point3, f64)>,
    /// Vessels, directed along the mean flow.
    pub vessels: Vec<ReducedVessel>,
    /// Conditions by terminal.
    pub ends: BTreeMap<u32, ModelEnd>,
    /// Mass per volume.
    pub density: f64,
    /// Dynamic viscosity.
    pub viscosity: f64,
    /// Stiffness of vessel walls.
    pub stiffness: Stiffness,
    /// Largest mean pressure.
    pub largest_pressure: f64,
    /// Number of simulated periods; 0 for steady flow.
    pub periods: u32,
}

/// Vessel of a reduced-order model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReducedVessel {
    /// Nodes along the vessel, at least two.
    pub path: Vec<u32>,
    /// Radii at both ends of each edge, in the direction of the path.
    pub radii: Vec<f64>,
    /// Arc length.
    pub length: f64,
    /// Pressure drop per flow rate.
    pub resistance: f64,
    /// Pressure drop per rate of change of the flow rate; 0 for steady flow.
    pub inertance: f64,
    /// Volume per pressure; 0 for rigid walls.
    pub capacitance: f64,
}

/// Condition at a terminal.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ModelEnd {
    /// Flow rate into the network.
    Inlet {
        /// Mean flow rate.
        rate: f64,
        /// Pulsatile flow rate; `None` if it is steady.
        waveform: Option<Waveform>,
    },
    /// Model beyond an outlet.
    Outlet(OutletModel),
}

/// Stiffness of vessel walls: E h / r = k₁ exp(k₂ r) + k₃ for Young's modulus E, wall thickness h and radius r.
///
/// The default is that of systemic arteries in SI units (Olufsen et al., Ann. Biomed. Eng. 28, 2000).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// Pressures k₁, k₂ (per length) and k₃.
    pub k: [f64; 3],
}

impl Default for Stiffness {
    fn default() -> Self {
        Self { k: [2e6, -2253.0, 8.65e4] }
    }
}

impl Stiffness {
    /// E h / r, in units of pressure.
    #[must_use]
    pub fn at(&self, radius: f64) -> f64 {
        let [k1, k2, k3] = self.k;
        k1 * libm::exp(k2 * radius) + k3
    }
}

impl ReducedVessel {
    /// Radii at both ends of the vessel.
    ///
    /// ```
    /// use anastomesh_io::network::ReducedVessel;
    ///
    /// let vessel = ReducedVessel { path: vec![0, 1, 2], radii: vec![3.0, 2.5, 2.5, 2.0], ..ReducedVessel::default() };
    /// assert_eq!(vessel.ends(), [3.0, 2.0]);
    /// ```
    #[must_use]
    pub fn ends(&self) -> [f64; 2] {
        [self.radii.first(), self.radii.last()].map(|radius| radius.copied().unwrap_or(0.0))
    }

    /// Reverses the direction.
    pub fn reverse(&mut self) {
        self.path.reverse();
        self.radii.reverse();
    }

    /// First and last node.
    #[must_use]
    pub fn tips(&self) -> [u32; 2] {
        [self.path.first(), self.path.last()].map(|node| node.copied().unwrap_or(0))
    }

    /// Inertance of a straight cone with flat velocity profiles: ρ L / (π a b).
    #[must_use]
    pub fn cone_inertance(density: f64, length: f64, [a, b]: [f64; 2]) -> f64 {
        density * length / (PI * a * b)
    }

    /// Capacitance of a straight cone with a thin, incompressible wall: 3/2 π r² L / (E h / r).
    #[must_use]
    pub fn cone_capacitance(stiffness: &Stiffness, length: f64, [a, b]: [f64; 2]) -> f64 {
        let area = PI * (a * a + a * b + b * b) / 3.0;
        1.5 * area * length / stiffness.at(f64::midpoint(a, b))
    }
}

/// Reason why a model cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReducedFault {
    /// The one-dimensional solver has a single inlet.
    #[error(
        "svOneDSolver takes one inlet, and the network has {inlets}; write a .json model, or one network per inlet"
    )]
    Inlets {
        /// Number of inlets.
        inlets: usize,
    },
    /// Pulsatile flow rates have different periods.
    #[error("flow rates have the periods {first} and {other}; give all inlets the same period")]
    Periods {
        /// Period of the first inlet.
        first: f64,
        /// Another period.
        other: f64,
    },
}

impl ReducedModel {
    /// Model without vessels.
    #[must_use]
    pub fn new(density: f64, viscosity: f64, stiffness: Stiffness) -> Self {
        let (nodes, vessels, ends) = (Vec::new(), Vec::new(), BTreeMap::new());
        Self { nodes, vessels, ends, density, viscosity, stiffness, largest_pressure: 0.0, periods: 0 }
    }

    /// Number of inlets.
    #[must_use]
    pub fn inlets(&self) -> usize {
        self.ends.values().filter(|end| matches!(end, ModelEnd::Inlet { .. })).count()
    }

    /// Vessels that end and begin at each node.
    pub(super) fn joints(&self) -> Vec<[Vec<u32>; 2]> {
        let mut joints = vec![[const { Vec::new() }; 2]; self.nodes.len()];
        for (number, vessel) in (0..).zip(&self.vessels) {
            let [start, end] = vessel.tips();
            joints[end as usize][0].push(number);
            joints[start as usize][1].push(number);
        }
        joints
    }

    /// Period of the flow rates; 1 for steady flow.
    pub(super) fn period(&self) -> Result<f64, ReducedFault> {
        let waveforms = self.ends.values().filter_map(|end| match end {
            ModelEnd::Inlet { waveform: Some(waveform), .. } => Some(waveform.period()),
            _ => None,
        });
        let periods: Vec<f64> = waveforms.collect();
        let first = periods.first().copied().unwrap_or(1.0);
        match periods.iter().find(|&&period| period != first) {
            Some(&other) => Err(ReducedFault::Periods { first, other }),
            None => Ok(first),
        }
    }

    /// True if an inlet is pulsatile.
    pub(super) fn is_pulsatile(&self) -> bool {
        self.ends.values().any(|end| matches!(end, ModelEnd::Inlet { waveform: Some(_), .. }))
    }

    /// Smallest absolute mean flow rate of inlets.
    pub(super) fn smallest_inflow(&self) -> f64 {
        let rates = self.ends.values().filter_map(|end| match end {
            ModelEnd::Inlet { rate, .. } => Some(rate.abs()),
            ModelEnd::Outlet(_) => None,
        });
        rates.filter(|&rate| rate > 0.0).fold(f64::INFINITY, f64::min)
    }
}

anastomesh_mesh::setters!(ReducedModel {
    nodes: Vec<(Point3, f64)>,
    vessels: Vec<ReducedVessel>,
    ends: BTreeMap<u32, ModelEnd>,
    largest_pressure: f64,
    periods: u32,
});
