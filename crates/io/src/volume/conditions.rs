//! Flow conditions for formats that are complete solver cases.

use anastomesh_mesh::{Cap, Patch};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Flow data of a solver, in units consistent with the mesh: SI for a mesh in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow {
    /// Mass per volume.
    pub density: f64,
    /// Dynamic viscosity.
    pub viscosity: f64,
    /// Conditions by patch.
    pub caps: BTreeMap<i32, CapFlow>,
}

/// Conditions at a cap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CapFlow {
    /// Volume flow rate into the mesh at an inlet, out of it at an outlet.
    pub flow: f64,
    /// Pressure per flow rate beyond an outlet.
    pub resistance: f64,
}

impl CapFlow {
    /// Adds a cap of the same patch: flows add, and so do conductances in parallel.
    pub fn add_parallel(&mut self, other: Self) {
        self.flow += other.flow;
        self.resistance = match (self.resistance > 0.0, other.resistance > 0.0) {
            (true, true) => 1.0 / (1.0 / self.resistance + 1.0 / other.resistance),
            _ => self.resistance.max(other.resistance),
        };
    }
}

/// Density of blood, in kg/m³.
pub const BLOOD_DENSITY: f64 = 1060.0;
/// Dynamic viscosity of blood, Pa·s.
pub const BLOOD_VISCOSITY: f64 = 3.5e-3;

/// Default Reynolds number (mean velocity, diameter) of inlets without a given flow: creeping flow for any unit of
/// length.
pub const USUAL_REYNOLDS: f64 = 1.0;

/// Flow rate for this Reynolds number in a round vessel: ρ (Q / πr²) 2r / μ.
pub fn flow_of_reynolds(reynolds: f64, radius: f64, density: f64, viscosity: f64) -> f64 {
    reynolds * PI * radius * viscosity / (2.0 * density)
}

/// Role of a patch, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Wall,
    Inlet,
    Outlet,
}

impl Role {
    pub(super) fn of(patch: &Patch) -> Self {
        match (patch.is_inlet(), patch.is_outlet()) {
            (true, _) => Self::Inlet,
            (_, true) => Self::Outlet,
            _ => Self::Wall,
        }
    }
}

/// Sanitizes a name for use as a dictionary word and file name.
pub(super) fn plain(name: &str) -> String {
    let breaks = |c: char| c.is_whitespace() || c.is_control() || "\"'/\\;:{}()[]<>&|*?$#".contains(c);
    name.chars().map(|c| if breaks(c) { '_' } else { c }).collect()
}

impl Flow {
    /// Default creeping blood flow, for a mesh without a network. Inlets of unknown radius have no flow.
    pub(super) fn usual(patches: &[Patch]) -> Self {
        let inlets = patches.iter().filter(|patch| patch.is_inlet());
        let flow = |cap: &Cap| flow_of_reynolds(USUAL_REYNOLDS, cap.radius, BLOOD_DENSITY, BLOOD_VISCOSITY);
        let cap = |patch: &Patch| CapFlow { flow: patch.cap.as_ref().map_or(0.0, flow), resistance: 0.0 };
        let caps = inlets.map(|patch| (patch.id, cap(patch))).collect();
        Self { density: BLOOD_DENSITY, viscosity: BLOOD_VISCOSITY, caps }
    }

    /// Conditions at a patch; no flow if unknown.
    pub(super) fn at(&self, patch: &Patch) -> CapFlow {
        self.caps.get(&patch.id).copied().unwrap_or_default()
    }
}
