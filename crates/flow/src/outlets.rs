//! Outlet models of a network from a total resistance, a mean pressure, or structured trees.

use super::error::FlowError;
use anastomesh_io::flow::{OutletModel, StructuredTree};
use anastomesh_network::flow::{NetworkFlow, solve_with_resistances};
use anastomesh_skeleton::{NodeId, Skeleton};
use std::collections::BTreeMap;

/// Kind of the model at every outlet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum OutletKind {
    /// The distal pressure.
    #[default]
    Pressure,
    /// Resistance, then the distal pressure.
    Resistance,
    /// Three-element windkessel.
    Rcr {
        /// Product of distal resistance and capacitance, in seconds.
        time_constant: f64,
        /// Proximal part of the resistance.
        proximal_fraction: f64,
    },
    /// Structured tree of Olufsen; an RCR model if it is elastic.
    StructuredTree(StructuredTree),
}

impl OutletKind {
    /// Default proximal part of the resistance of an RCR model. Source: `SimVascular`'s guide to coronary models, section
    /// 'Aortic outflow boundary condition': a distal resistance of about ten times the proximal one, hence 0.91 and 0.09.
    pub const PROXIMAL_FRACTION: f64 = 0.09;

    fn name(&self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::Resistance => "resistance",
            Self::Rcr { .. } => "rcr",
            Self::StructuredTree(_) => "structured-tree",
        }
    }
}

/// Reference for resistances.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reference {
    /// Resistance of all outlets in parallel.
    TotalResistance(f64),
    /// Pressure at the inlets of each component at mean flow: the mean over its inlets, weighted by flow rate.
    MeanPressure(f64),
}

/// Distribution of the resistance over the outlets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum OutletSplit {
    /// Inverse to the flow rates of the one-dimensional solution with equal pressures at all outlets, which remain as they
    /// are.
    #[default]
    Network,
    /// Inverse to a power of the radius (Murray's law: 3).
    Murray {
        /// Exponent of the radius.
        exponent: f64,
    },
}

/// Plan of the outlet models. Units are consistent with the network.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct OutletPlan {
    /// Kind of the models.
    pub kind: OutletKind,
    /// Pressure beyond the outlets.
    pub distal_pressure: f64,
    /// Reference for the resistances of `Resistance` and `Rcr`, which require one.
    pub reference: Option<Reference>,
    /// Distribution of the resistances of `Resistance` and `Rcr`.
    pub split: OutletSplit,
}

anastomesh_mesh::setters!(OutletPlan {
    kind: OutletKind,
    distal_pressure: f64,
    reference: Option<Reference>,
    split: OutletSplit,
});

/// Minimum flow rate of an outlet relative to its component: no flow would give an infinite resistance.
const SMALLEST_SHARE: f64 = 1e-12;
/// Maximum Newton steps to a mean pressure, and their tolerance. Steps converge quadratically from below.
const STEPS: usize = 50;
const TOLERANCE: f64 = 1e-12;

/// Network whose outlet models are wanted.
pub(super) struct OutletCase<'a> {
    network: &'a Skeleton,
    /// Mean flow rate by inlet.
    rates: &'a BTreeMap<NodeId, f64>,
    density: f64,
    viscosity: f64,
    /// Component of each node.
    component: Vec<u32>,
    components: usize,
}

impl OutletPlan {
    /// True if the network may not fit the plan.
    pub(super) fn depends_on_network(&self) -> bool {
        matches!(self.reference, Some(Reference::MeanPressure(_))) || matches!(self.kind, OutletKind::StructuredTree(_))
    }

    /// Checks numbers that do not depend on a network.
    pub(super) fn check(&self) -> Result<(), FlowError> {
        let within = |what, value: f64, is_in: bool, range| {
            let fault = FlowError::OutOfRange { what, value, range };
            if is_in && value.is_finite() { Ok(()) } else { Err(fault) }
        };
        let positive = |what, value: f64| within(what, value, value > 0.0, "a finite number above 0");
        within("the distal pressure", self.distal_pressure, true, "a finite number")?;
        match self.reference {
            Some(Reference::TotalResistance(resistance)) => positive("the total resistance", resistance)?,
            Some(Reference::MeanPressure(pressure)) => {
                within(
                    "the mean pressure",
                    pressure,
                    pressure > self.distal_pressure,
                    "more than the distal pressure",
                )?;
            }
            None if matches!(self.kind, OutletKind::Resistance | OutletKind::Rcr { .. }) => {
                return Err(FlowError::NoReference { model: self.kind.name() });
            }
            None => {}
        }
        if let OutletSplit::Murray { exponent } = self.split {
            positive("the exponent of the radius", exponent)?;
        }
        match self.kind {
            OutletKind::Rcr { time_constant, proximal_fraction: part } => {
                positive("the time constant", time_constant)?;
                within("the proximal fraction", part, (0.0..1.0).contains(&part), "a number from 0 to below 1")
            }
            OutletKind::StructuredTree(tree) if !tree.is_sound() => {
                let (what, range) =
                    ("the minimum radius of the structured tree", "numbers above 0, and ratios below 1");
                Err(FlowError::OutOfRange { what, value: tree.minimum_radius, range })
            }
            _ => Ok(()),
        }
    }

    /// Model of each outlet. `open` is the flow with pressure 0 at the outlets.
    pub(super) fn models(
        &self,
        case: &OutletCase,
        open: &NetworkFlow,
        name: &dyn Fn(u32) -> String,
    ) -> Result<BTreeMap<NodeId, OutletModel>, FlowError> {
        let (network, rates) = (case.network, case.rates);
        let outlets = || open.of_terminal.keys().copied().filter(|node| !rates.contains_key(node));
        match self.kind {
            OutletKind::Pressure => {
                return Ok(outlets().map(|node| (node, OutletModel::Pressure(self.distal_pressure))).collect());
            }
            OutletKind::StructuredTree(tree) => {
                let radii = radii(network, outlets());
                let thin = radii.iter().find(|(_, radius)| **radius < tree.minimum_radius);
                if let Some((node, &radius)) = thin {
                    let node = name(network.node(*node).original);
                    return Err(FlowError::OutletTooThin { node, radius, minimum: tree.minimum_radius });
                }
                let model = |radius| tree.outlet(radius, case.density, case.viscosity, self.distal_pressure);
                return Ok(radii.into_iter().map(|(node, radius)| (node, model(radius))).collect());
            }
            OutletKind::Resistance | OutletKind::Rcr { .. } => {}
        }
        let weights = case.weights(self.split, outlets(), open);
        let scale = match self.reference {
            Some(Reference::TotalResistance(resistance)) => {
                let conductance: f64 = weights.values().map(|weight| 1.0 / weight).sum();
                vec![resistance * conductance; case.components]
            }
            Some(Reference::MeanPressure(pressure)) => case.scale(pressure, self.distal_pressure, &weights, open)?,
            None => return Err(FlowError::NoReference { model: self.kind.name() }),
        };
        let model = |(node, weight)| (node, self.with_resistance(scale[case.component_of(node)] * weight));
        Ok(weights.into_iter().map(model).collect())
    }

    fn with_resistance(&self, resistance: f64) -> OutletModel {
        let distal_pressure = self.distal_pressure;
        let OutletKind::Rcr { time_constant, proximal_fraction } = self.kind else {
            return OutletModel::Resistance { resistance, distal_pressure };
        };
        let distal = (1.0 - proximal_fraction) * resistance;
        let [proximal, capacitance] = [proximal_fraction * resistance, time_constant / distal];
        OutletModel::Rcr { proximal, capacitance, distal, distal_pressure }
    }
}

/// Radii of the ends of vessels at terminals.
fn radii(network: &Skeleton, terminals: impl Iterator<Item = NodeId>) -> BTreeMap<NodeId, f64> {
    let adjacency = network.adjacency();
    let radius = |node: NodeId| {
        let edge = network.edge(adjacency.edges(node)[0]);
        (node, edge.radii[edge.end(node)])
    };
    terminals.map(radius).collect()
}

impl<'a> OutletCase<'a> {
    pub(super) fn new(network: &'a Skeleton, rates: &'a BTreeMap<NodeId, f64>, density: f64, viscosity: f64) -> Self {
        let components = network.components(&network.adjacency());
        let (component, components) = (components.of_node, components.list.len());
        Self { network, rates, density, viscosity, component, components }
    }

    fn component_of(&self, node: NodeId) -> usize {
        self.component[node.index()] as usize
    }

    /// Resistance of each outlet up to a factor.
    fn weights(
        &self,
        split: OutletSplit,
        outlets: impl Iterator<Item = NodeId>,
        open: &NetworkFlow,
    ) -> BTreeMap<NodeId, f64> {
        if let OutletSplit::Murray { exponent } = split {
            let weight = |(node, radius): (NodeId, f64)| (node, libm::pow(radius, -exponent));
            return radii(self.network, outlets).into_iter().map(weight).collect();
        }
        let inflow = self.inflow();
        let flow = |node| open.of_terminal[&node].max(SMALLEST_SHARE * inflow[self.component_of(node)]);
        outlets.map(|node| (node, 1.0 / flow(node))).collect()
    }

    /// Total inflow of each component.
    fn inflow(&self) -> Vec<f64> {
        let mut inflow = vec![0.0; self.components];
        for (&node, rate) in self.rates {
            inflow[self.component_of(node)] += rate;
        }
        inflow
    }

    /// Mean pressure at the inlets of each component, weighted by flow rate.
    fn inlet_pressure(&self, flow: &NetworkFlow) -> Vec<f64> {
        let mut power = vec![0.0; self.components];
        for (&node, rate) in self.rates {
            power[self.component_of(node)] += rate * flow.pressure[node.index()];
        }
        power.iter().zip(self.inflow()).map(|(power, inflow)| if inflow > 0.0 { power / inflow } else { 0.0 }).collect()
    }

    /// Factor of the weights by component that gives the wanted pressure at the inlets.
    ///
    /// The pressure is a concave function of the factor, as the flow minimises dissipation. Its derivative is Σ w q² / Q,
    /// so Newton's method from 0 rises to the solution.
    fn scale(
        &self,
        wanted: f64,
        distal: f64,
        weights: &BTreeMap<NodeId, f64>,
        open: &NetworkFlow,
    ) -> Result<Vec<f64>, FlowError> {
        let inflow = self.inflow();
        let drops = self.inlet_pressure(open);
        let drop = drops.iter().copied().fold(0.0, f64::max);
        if drop >= wanted - distal {
            return Err(FlowError::PressureTooLow { wanted, drop, distal });
        }
        let mut scale = vec![0.0; self.components];
        let mut flow = open.clone();
        for _ in 0..STEPS {
            let mut slope = vec![0.0; self.components];
            for (node, weight) in weights {
                slope[self.component_of(*node)] += weight * flow.of_terminal[node].powi(2);
            }
            let mut left: f64 = 0.0;
            for (c, pressure) in self.inlet_pressure(&flow).into_iter().enumerate().filter(|&(c, _)| inflow[c] > 0.0) {
                let missing = wanted - distal - pressure;
                left = left.max(missing.abs() / (wanted - distal));
                scale[c] += missing * inflow[c] / slope[c];
            }
            if left <= TOLERANCE {
                break;
            }
            let resistance = |(&node, weight): (&NodeId, &f64)| (node, weight * scale[self.component_of(node)]);
            let resistances = weights.iter().map(resistance).collect();
            flow = solve_with_resistances(self.network, self.rates, &resistances, self.viscosity)?;
        }
        Ok(scale)
    }
}

#[cfg(test)]
mod tests;
