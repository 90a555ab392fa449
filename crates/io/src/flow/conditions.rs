//! Flow conditions for formats that are complete solver cases.

use super::{OutletModel, Profile, Transient, Waveform};
use anastomesh_mesh::{Cap, Patch};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Flow data of a solver, in units consistent with the mesh: SI for a mesh in metres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Flow {
    /// Mass per volume.
    pub density: f64,
    /// Dynamic viscosity.
    pub viscosity: f64,
    /// Conditions by patch.
    pub caps: BTreeMap<i32, CapFlow>,
    /// Velocity profile on inlets.
    pub profile: Profile,
    /// Simulated time; `None` for steady flow.
    pub transient: Option<Transient>,
}

/// Conditions at a cap.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CapFlow {
    /// Mean volume flow rate into the mesh at an inlet, out of it at an outlet.
    pub flow: f64,
    /// Pulsatile flow rate into an inlet; `None` if it is steady.
    pub waveform: Option<Waveform>,
    /// Model beyond an outlet.
    pub outlet: OutletModel,
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
pub(crate) enum Role {
    Wall,
    Inlet,
    Outlet,
}

impl Role {
    pub(crate) fn of(patch: &Patch) -> Self {
        match (patch.is_inlet(), patch.is_outlet()) {
            (true, _) => Self::Inlet,
            (_, true) => Self::Outlet,
            _ => Self::Wall,
        }
    }
}

/// Sanitizes a name for use as a dictionary word and file name.
pub(crate) fn plain(name: &str) -> String {
    let breaks = |c: char| c.is_whitespace() || c.is_control() || "\"'/\\;:{}()[]<>&|*?$#".contains(c);
    name.chars().map(|c| if breaks(c) { '_' } else { c }).collect()
}

impl Flow {
    /// Steady flow of a fluid, without conditions.
    #[must_use]
    pub fn new(density: f64, viscosity: f64) -> Self {
        Self { density, viscosity, caps: BTreeMap::new(), profile: Profile::default(), transient: None }
    }

    /// Default creeping blood flow, for a mesh without a network. Inlets of unknown radius have no flow.
    pub(crate) fn usual(patches: &[Patch]) -> Self {
        let inlets = patches.iter().filter(|patch| patch.is_inlet());
        let flow = |cap: &Cap| flow_of_reynolds(USUAL_REYNOLDS, cap.radius, BLOOD_DENSITY, BLOOD_VISCOSITY);
        let cap = |patch: &Patch| CapFlow::default().flow(patch.cap.as_ref().map_or(0.0, flow));
        Self::new(BLOOD_DENSITY, BLOOD_VISCOSITY).caps(inlets.map(|patch| (patch.id, cap(patch))).collect())
    }

    /// Conditions at a patch; no flow if unknown.
    pub(crate) fn at(&self, patch: &Patch) -> CapFlow {
        self.caps.get(&patch.id).cloned().unwrap_or_default()
    }
}

anastomesh_mesh::setters!(Flow { caps: BTreeMap<i32, CapFlow>, profile: Profile, transient: Option<Transient> });
anastomesh_mesh::setters!(CapFlow { flow: f64, waveform: Option<Waveform>, outlet: OutletModel });
