//! Time steps of a case.

use crate::flow::{Flow, Transient};
use anastomesh_mesh::Patch;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Time steps, and the reason for their length.
#[derive(Debug, PartialEq)]
pub(super) struct Steps {
    /// Length of a step in seconds.
    pub(super) step: f64,
    pub(super) count: u64,
    /// Number of steps between results.
    pub(super) increment: u64,
    /// Number of steps between restart files.
    pub(super) restart: u64,
    /// Duration of the ramp from rest, in seconds.
    pub(super) ramp: f64,
    pub(super) why: String,
}

/// Steps per diffusion time r²/ν of the widest inlet in steady flow.
const PER_DIFFUSION: f64 = 10.0;
/// Maximum Courant number on the axis of inlets. In steady flow only the final state counts.
const STEADY_COURANT: f64 = 5.0;
const COURANT: f64 = 1.0;
/// Duration of steady flow in diffusion times: the ramp, and three to settle.
const DIFFUSION_TIMES: u64 = 4;
/// Minimum number of steps per period.
const PER_PERIOD: f64 = 100.0;
/// Step for inlets of unknown radius, in seconds.
const UNKNOWN: f64 = 1e-3;

impl Steps {
    /// Steps for this flow. `edges` holds the mean edge length by patch.
    pub(super) fn of(patches: &[Patch], flow: &Flow, edges: &BTreeMap<i32, f64>) -> Self {
        let inlets: Vec<&Patch> = patches.iter().filter(|patch| patch.is_inlet()).collect();
        let transit = |patch: &&Patch| transit(patch, flow, edges);
        let transit = inlets.iter().filter_map(transit).fold(f64::INFINITY, f64::min);
        match flow.transient {
            None => {
                let radius = inlets.iter().filter_map(|p| Some(p.cap.as_ref()?.radius)).fold(0.0, f64::max);
                Self::steady(radius * radius * flow.density / flow.viscosity, transit)
            }
            Some(time) => {
                let samples = |patch: &&Patch| flow.at(patch).waveform.map_or(0, |waveform| waveform.times().len());
                Self::pulsatile(&time, transit, inlets.iter().map(samples).max().unwrap_or(0))
            }
        }
    }

    fn steady(diffusion: f64, transit: f64) -> Self {
        let diffusion = if diffusion > 0.0 { diffusion } else { PER_DIFFUSION * UNKNOWN };
        let ramp_steps = PER_DIFFUSION.max((diffusion / (STEADY_COURANT * transit)).ceil());
        let step = diffusion / ramp_steps;
        let increment = ramp_steps as u64;
        let why = format!(
            "{ramp_steps} steps per diffusion time of the widest inlet ({diffusion:.3e} s), Courant number on inlets {:.2}; \
             the inflow rises linearly over the first {increment} steps",
            step / transit
        );
        let count = DIFFUSION_TIMES * increment;
        Self { step, count, increment, restart: count, ramp: diffusion, why }
    }

    fn pulsatile(time: &Transient, transit: f64, samples: usize) -> Self {
        let least = PER_PERIOD.max(samples as f64).max((time.period / (COURANT * transit)).ceil());
        let increment = (least / f64::from(time.outputs)).ceil() as u64;
        let per_period = increment * u64::from(time.outputs);
        let step = time.period / per_period as f64;
        let why = format!(
            "{per_period} steps per period of {} s, for {samples} samples of the waveform and a Courant number of {:.2} at \
             its peak on inlets; results {} times per period",
            time.period,
            step / transit,
            time.outputs
        );
        let count = per_period * u64::from(time.periods);
        Self { step, count, increment, restart: per_period, ramp: time.ramp, why }
    }
}

/// Time in which the fastest fluid of an inlet crosses an edge; `None` without flow.
fn transit(patch: &Patch, flow: &Flow, edges: &BTreeMap<i32, f64>) -> Option<f64> {
    let at = flow.at(patch);
    let peak = at.waveform.map_or(at.flow.abs(), |waveform| waveform.peak());
    let radius = patch.cap.as_ref()?.radius;
    let fastest = 2.0 * peak / (PI * radius * radius);
    let edge = *edges.get(&patch.id)?;
    (fastest > 0.0 && edge > 0.0).then_some(edge / fastest)
}
