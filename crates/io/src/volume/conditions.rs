//! What flows through a mesh and what it is let out against: for formats that are whole cases of a solver.

use anastomesh_mesh::{Cap, Patch};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// What a solver has to know beside the mesh, in units that fit the mesh's: SI where that is in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow {
    /// Mass per volume.
    pub density: f64,
    /// Dynamic viscosity.
    pub viscosity: f64,
    /// By patch.
    pub caps: BTreeMap<i32, CapFlow>,
}

/// What goes through a cap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CapFlow {
    /// Volume per time into the mesh at an inlet, out of it at an outlet.
    pub flow: f64,
    /// Pressure per flow beyond an outlet.
    pub resistance: f64,
}

/// Density of blood, in kg/m³.
pub const BLOOD_DENSITY: f64 = 1060.0;
/// Dynamic viscosity of blood, in Pa·s.
pub const BLOOD_VISCOSITY: f64 = 3.5e-3;

/// The Reynolds number, of mean velocity and diameter, at an inlet whose flow nobody has given: of creeping flow, whatever the
/// unit of length.
pub const USUAL_REYNOLDS: f64 = 1.0;

/// The flow that has this Reynolds number in a round vessel: ρ (Q / πr²) 2r / μ.
pub fn flow_of_reynolds(reynolds: f64, radius: f64, density: f64, viscosity: f64) -> f64 {
    reynolds * PI * radius * viscosity / (2.0 * density)
}

/// What a patch is, by its name.
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

/// A name that is a word in every dictionary, and the name of a file.
pub(super) fn plain(name: &str) -> String {
    let breaks = |c: char| c.is_whitespace() || c.is_control() || "\"'/\\;:{}()[]<>&|*?$#".contains(c);
    name.chars().map(|c| if breaks(c) { '_' } else { c }).collect()
}

impl Flow {
    /// Blood that creeps through the inlets: for a mesh without a network. An inlet of unknown radius gets no flow.
    pub(super) fn usual(patches: &[Patch]) -> Self {
        let inlets = patches.iter().filter(|patch| patch.is_inlet());
        let flow = |cap: &Cap| flow_of_reynolds(USUAL_REYNOLDS, cap.radius, BLOOD_DENSITY, BLOOD_VISCOSITY);
        let cap = |patch: &Patch| CapFlow { flow: patch.cap.as_ref().map_or(0.0, flow), resistance: 0.0 };
        let caps = inlets.map(|patch| (patch.id, cap(patch))).collect();
        Self { density: BLOOD_DENSITY, viscosity: BLOOD_VISCOSITY, caps }
    }

    /// What goes through a patch; nothing through those that are not known.
    pub(super) fn at(&self, patch: &Patch) -> CapFlow {
        self.caps.get(&patch.id).copied().unwrap_or_default()
    }
}
