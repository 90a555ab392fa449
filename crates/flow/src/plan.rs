//! Flow through a network: fluid, rates at inlets, models at outlets, and time.

use super::error::{FlowError, MAX_REYNOLDS};
use super::outlets::{OutletCase, OutletPlan};
use anastomesh_io::flow::{
    BLOOD_DENSITY, BLOOD_VISCOSITY, FlowTable, OutletModel, Profile, Transient, USUAL_REYNOLDS, Waveform,
    flow_of_reynolds,
};
use anastomesh_io::network::NodeNames;
use anastomesh_network::flow::{NetworkFlow, solve, solve_with_resistances};
use anastomesh_skeleton::{NodeId, Skeleton};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Flow rate into the inlets.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Inflow {
    /// Reynolds number 1 at each inlet.
    #[default]
    Usual,
    /// Steady flow rate into each inlet, in volume per time.
    Rate(f64),
    /// Pulsatile flow rates. A single column is shared by all inlets; several columns are named after inlets, by their
    /// patches (`inlet`, `inlet_1`) or by their nodes.
    Table(FlowTable),
}

/// Flow through a network. Units are consistent with the network: SI for lengths in metres.
///
/// ```
/// use anastomesh_flow::{FlowPlan, Inflow, OutletKind, OutletPlan, Reference};
///
/// let outlets = OutletPlan::default()
///     .kind(OutletKind::Rcr { time_constant: 1.5, proximal_fraction: OutletKind::PROXIMAL_FRACTION })
///     .reference(Some(Reference::MeanPressure(12e3)));
/// let plan = FlowPlan::default().inflow(Inflow::Rate(1e-6)).outlets(outlets);
/// assert!(plan.check().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FlowPlan {
    /// Mass per volume.
    pub density: f64,
    /// Dynamic viscosity.
    pub viscosity: f64,
    /// Flow rate into the inlets.
    pub inflow: Inflow,
    /// Velocity profile on inlets.
    pub profile: Profile,
    /// Models at outlets.
    pub outlets: OutletPlan,
    /// Simulated periods of pulsatile flow.
    pub periods: u32,
    /// Results per period of pulsatile flow.
    pub outputs: u32,
    /// Duration of the ramp from rest to pulsatile flow, in seconds; `None` for a tenth of a period.
    pub ramp: Option<f64>,
}

impl Default for FlowPlan {
    /// Blood in SI units at Reynolds number 1, with pressure 0 at the outlets.
    fn default() -> Self {
        let Transient { periods, outputs, .. } = Transient::new(1.0);
        Self {
            density: BLOOD_DENSITY,
            viscosity: BLOOD_VISCOSITY,
            inflow: Inflow::default(),
            profile: Profile::default(),
            outlets: OutletPlan::default(),
            periods,
            outputs,
            ramp: None,
        }
    }
}

anastomesh_mesh::setters!(FlowPlan {
    density: f64,
    viscosity: f64,
    inflow: Inflow,
    profile: Profile,
    outlets: OutletPlan,
    periods: u32,
    outputs: u32,
    ramp: Option<f64>,
});

/// Inlet of a network.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct InletSite {
    /// Terminal.
    pub node: NodeId,
    /// Name of its patch.
    pub patch: String,
    /// Name of its node in the file.
    pub name: String,
    /// Radius of the vessel there.
    pub radius: f64,
}

impl InletSite {
    /// Inlet of the patch `inlet`, whose node is named by its index.
    pub fn new(node: NodeId, radius: f64) -> Self {
        Self { node, patch: "inlet".into(), name: node.0.to_string(), radius }
    }
}

anastomesh_mesh::setters!(InletSite { patch: String, name: String });

/// Maximum number of inlets in an error.
const LISTED: usize = 10;

/// Flow rates, pressures and outlet models of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowSolution {
    /// Mean pressures and flow rates; the pressure beyond outlets is included.
    pub flow: NetworkFlow,
    /// Models by outlet.
    pub outlets: BTreeMap<NodeId, OutletModel>,
    /// Pulsatile flow rates by inlet; empty for steady flow.
    pub waveforms: BTreeMap<NodeId, Waveform>,
}

/// Mean flow rate into each inlet, and the waveforms of pulsatile ones.
type InletRates = (BTreeMap<NodeId, f64>, BTreeMap<NodeId, Waveform>);

impl FlowPlan {
    /// Checks numbers that do not depend on a network.
    ///
    /// # Errors
    /// [`FlowError::OutOfRange`] or [`FlowError::NoReference`].
    pub fn check(&self) -> Result<(), FlowError> {
        let positive = |what, value: f64| {
            let is_in = value > 0.0 && value.is_finite();
            let fault = FlowError::OutOfRange { what, value, range: "a finite number above 0" };
            if is_in { Ok(()) } else { Err(fault) }
        };
        positive("the density", self.density)?;
        positive("the viscosity", self.viscosity)?;
        if let Inflow::Rate(rate) = self.inflow {
            positive("the flow rate", rate)?;
        }
        positive("the number of periods", self.periods.into())?;
        positive("the number of results per period", self.outputs.into())?;
        match self.transient() {
            Some(Transient { ramp, .. }) if !(ramp >= 0.0 && ramp.is_finite()) => {
                return Err(FlowError::OutOfRange { what: "the ramp", value: ramp, range: "a duration of at least 0" });
            }
            Some(time) if time.ramp > time.end() => {
                let range = "at most the simulated time";
                return Err(FlowError::OutOfRange { what: "the ramp", value: time.ramp, range });
            }
            _ => {}
        }
        self.outlets.check()
    }

    /// Simulated time; `None` for steady flow.
    #[must_use]
    pub fn transient(&self) -> Option<Transient> {
        let Inflow::Table(table) = &self.inflow else { return None };
        let time = Transient::new(table.period()).periods(self.periods).outputs(self.outputs);
        let ramp = self.ramp.unwrap_or(time.ramp);
        Some(time.ramp(ramp))
    }

    /// Checks the plan against the inlets of a network, and its pressures if a mean pressure is wanted.
    ///
    /// # Errors
    /// The plan does not fit the network.
    pub fn check_with(&self, network: &Skeleton, inlets: &[InletSite], names: &NodeNames) -> Result<(), FlowError> {
        self.rates(inlets)?;
        if self.outlets.depends_on_network() {
            self.solve(network, inlets, &|node| names.of(NodeId(node)))?;
        }
        Ok(())
    }

    /// Solves for flow rates and pressures, and finds the model of each outlet. `name` is the name of a node in the file.
    ///
    /// # Errors
    /// The plan is invalid, or does not fit the network.
    pub fn solve(
        &self,
        network: &Skeleton,
        inlets: &[InletSite],
        name: &dyn Fn(u32) -> String,
    ) -> Result<FlowSolution, FlowError> {
        self.check()?;
        let (rates, waveforms) = self.rates(inlets)?;
        let open = solve(network, &rates, self.viscosity)?;
        let case = OutletCase::new(network, &rates, self.density, self.viscosity);
        let outlets = self.outlets.models(&case, &open, name)?;
        let resistance =
            |(&node, model): (&NodeId, &OutletModel)| Some((node, model.resistance())).filter(|of| of.1 > 0.0);
        let resistances: BTreeMap<NodeId, f64> = outlets.iter().filter_map(resistance).collect();
        let mut flow = if resistances.is_empty() {
            open
        } else {
            solve_with_resistances(network, &rates, &resistances, self.viscosity)?
        };
        for pressure in &mut flow.pressure {
            *pressure += self.outlets.distal_pressure;
        }
        Ok(FlowSolution { flow, outlets, waveforms })
    }

    /// Mean flow rate into each inlet, and its waveform if it is pulsatile.
    fn rates(&self, inlets: &[InletSite]) -> Result<InletRates, FlowError> {
        let table = match &self.inflow {
            Inflow::Usual => {
                let usual = |radius| flow_of_reynolds(USUAL_REYNOLDS, radius, self.density, self.viscosity);
                return Ok((inlets.iter().map(|inlet| (inlet.node, usual(inlet.radius))).collect(), BTreeMap::new()));
            }
            &Inflow::Rate(rate) => {
                inlets.iter().try_for_each(|inlet| self.ensure_slow(inlet, rate))?;
                return Ok((inlets.iter().map(|inlet| (inlet.node, rate)).collect(), BTreeMap::new()));
            }
            Inflow::Table(table) => table,
        };
        let mut waveforms = BTreeMap::new();
        for (inlet, waveform) in inlets.iter().zip(matched(table, inlets)?) {
            let mean = waveform.mean();
            if mean <= 0.0 {
                return Err(FlowError::NotInwards { inlet: inlet.patch.clone(), mean });
            }
            self.ensure_slow(inlet, waveform.peak())?;
            waveforms.insert(inlet.node, waveform.clone());
        }
        Ok((waveforms.iter().map(|(&node, waveform)| (node, waveform.mean())).collect(), waveforms))
    }

    fn ensure_slow(&self, inlet: &InletSite, flow: f64) -> Result<(), FlowError> {
        let radius = inlet.radius;
        let reynolds = 2.0 * self.density * flow / (PI * radius * self.viscosity);
        if reynolds > MAX_REYNOLDS {
            return Err(FlowError::TooFast { inlet: inlet.patch.clone(), reynolds, flow, radius });
        }
        Ok(())
    }
}

/// Waveform of each inlet.
fn matched<'a>(table: &'a FlowTable, inlets: &[InletSite]) -> Result<Vec<&'a Waveform>, FlowError> {
    let is_of = |inlet: &InletSite, column: &str| inlet.patch == column || inlet.name == column;
    let columns = table.columns();
    if let [(column, waveform)] = columns
        && (inlets.len() < 2 || !inlets.iter().any(|inlet| is_of(inlet, column)))
    {
        return Ok(vec![waveform; inlets.len()]);
    }
    if let Some((column, _)) = columns.iter().find(|(column, _)| !inlets.iter().any(|inlet| is_of(inlet, column))) {
        let name = |inlet: &InletSite| format!("{} ({})", inlet.patch, inlet.name);
        let mut named: Vec<String> = inlets.iter().take(LISTED).map(name).collect();
        if inlets.len() > LISTED {
            named.push("…".into());
        }
        return Err(FlowError::UnknownInlet { column: column.clone(), inlets: named });
    }
    let only = |inlet: &InletSite| {
        let mut own = columns.iter().filter(|(column, _)| is_of(inlet, column)).map(|(_, waveform)| waveform);
        match (own.next(), own.count()) {
            (Some(waveform), 0) => Ok(waveform),
            (first, more) => {
                let columns = usize::from(first.is_some()) + more;
                Err(FlowError::Columns { inlet: inlet.patch.clone(), columns })
            }
        }
    };
    inlets.iter().map(only).collect()
}

#[cfg(test)]
mod tests;
