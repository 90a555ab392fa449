//! Outlet models: conditions of the pressure at the outlets.
//!
//! `exprMixed` is part of OpenFOAM since v1912. It evaluates text and needs no compiler. The condition of all outlets
//! with a resistance is one entry, `outletModel`; each outlet is a line with its numbers.
//!
//! The pressure of an outlet should be P + R Q, with the flow rate Q of the previous iteration. Such a condition
//! diverges if R exceeds the resistance of the cells at the outlet. Therefore part of the pressure p of the face follows
//! the pressure of its cell: `p = f V + (1 - f) p_cell`. The value V is integrated, V += P + R Q - mean(p), until the mean
//! pressure of the outlet is P + R Q. Within the outlet the pressure varies as in the cells.
//! A stored variable keeps its value of the previous time step until a step ends. Within a step V is therefore
//! corrected from the same value several times, and a full correction would alternate.
//!
//! The fraction f = 1 / (1 + R G) contains the conductance G of half a cell, for which the pressure equation knows the
//! change of Q. An estimate of G that is too high delays convergence, and one below half of it diverges.

use super::boundary::{Boundary, FoamPatch};
use crate::flow::{Flow, OutletModel, Role};
use std::fmt::Write;

/// Factor by which the SIMPLEC algorithm with relaxation α increases the conductance G of half a tetrahedron.
///
/// G follows from the diagonal of the momentum equation, about 30 ν / h² per volume for the edge h. The distance from
/// the centre to the face is 0.2 h, hence G = A h / (6 ν) for the area A.
fn simplec(relaxation: f64) -> f64 {
    relaxation / (1.0 - relaxation)
}

/// Share of the difference by which V is corrected within a time step. After the three corrections of a step, the
/// pressure has made up 0.61 of its change: it is late by less than a step.
const WITHIN_STEP: f64 = 0.75;

/// Model of an outlet in OpenFOAM's pressure, which is divided by the density.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Kinematic {
    proximal: f64,
    distal: f64,
    /// Time constant of the capacitance and the distal resistance.
    time: f64,
    beyond: f64,
    /// Pressure at the outlet for its mean flow rate, and behind the proximal resistance.
    mean: [f64; 2],
}

impl Kinematic {
    fn of(model: &OutletModel, rate: f64, density: f64) -> Self {
        let (proximal, distal, capacitance, beyond) = match *model {
            OutletModel::Pressure(pressure) => (0.0, 0.0, 0.0, pressure),
            OutletModel::Resistance { resistance, distal_pressure } => (resistance, 0.0, 0.0, distal_pressure),
            OutletModel::Rcr { proximal, capacitance, distal, distal_pressure } => {
                (proximal, distal, capacitance, distal_pressure)
            }
        };
        let mean = [model.mean_pressure(rate), beyond + distal * rate];
        Self {
            proximal: proximal / density,
            distal: distal / density,
            time: capacitance * distal,
            beyond: beyond / density,
            mean: mean.map(|pressure| pressure / density),
        }
    }

    fn is_pressure(&self) -> bool {
        self.proximal <= 0.0 && self.distal <= 0.0
    }
}

/// Models of all outlets.
pub(super) struct Outlets<'a> {
    list: Vec<(&'a FoamPatch, Kinematic)>,
    is_transient: bool,
}

impl<'a> Outlets<'a> {
    pub(super) fn of(boundary: &'a Boundary, flow: &Flow) -> Self {
        let model = |patch: &'a FoamPatch| {
            let cap = flow.at(&patch.patch);
            (patch, Kinematic::of(&cap.outlet, cap.flow, flow.density))
        };
        let list = boundary.with_role(Role::Outlet).map(model).collect();
        Self { list, is_transient: flow.transient.is_some() }
    }

    /// True if the pressure of an outlet depends on its flow rate.
    pub(super) fn are_coupled(&self) -> bool {
        self.list.iter().any(|(_, model)| !model.is_pressure())
    }

    /// Mean of the outlets' pressures, from which the solver starts.
    pub(super) fn start(&self) -> f64 {
        let pressures = self.list.iter().map(|(_, model)| if self.is_transient { model.mean[1] } else { model.beyond });
        let sum: f64 = pressures.sum();
        if self.list.is_empty() { 0.0 } else { sum / self.list.len() as f64 }
    }

    /// Entry of the coupled outlets before `boundaryField`, empty without such outlets.
    pub(super) fn definition(&self, viscosity: f64, relaxation: f64) -> String {
        if !self.are_coupled() {
            return String::new();
        }
        let has_capacitance = self.list.iter().any(|(_, model)| model.time > 0.0);
        let (conductance, why) = if self.is_transient {
            // Twice the estimate, as a lower one than half of the true value would diverge.
            (format!("sum(area())*h/({:e}+0.1*h*h/dt)", 3.0 * viscosity), "the time step")
        } else {
            (format!("sum(area())*h*{:e}", simplec(relaxation) / (6.0 * viscosity)), "SIMPLEC and its relaxation")
        };
        let mean = "mean=sum(p*area())/sum(area())";
        // At the first evaluation V is the pressure from which the solver starts.
        let mut stored = vec!["V", "begun"];
        let mut lines: Vec<String> = ["Rp=$Rp", "Rd=$Rd", "P=$P", "Q=sum(phi)", mean].map(String::from).to_vec();
        if self.is_transient {
            stored.push("T");
            lines.extend(["dt=(time()>T)?time()-T:1e-9".into(), "T=time()".into()]);
        }
        if self.is_transient && has_capacitance {
            stored.push("Pc");
            lines.extend(["tau=$tau", "Pc=(begun>0.5)?Pc:mean"].map(String::from));
            lines.push("Pc=(Pc*tau+(P+Rd*Q)*dt)/(tau+dt)".into());
            lines.extend(["R=Rp+Rd*dt/(tau+dt)".into(), "target=Pc+Rp*Q".into()]);
        } else {
            lines.extend(["R=Rp+Rd".into(), "target=P+R*Q".into()]);
        }
        lines.extend(["h=1.5*sqrt(max(area()))".into(), format!("G={conductance}"), "f=1/(1+R*G)".into()]);
        let share = if self.is_transient { WITHIN_STEP } else { 1.0 };
        lines.extend([format!("V=(begun>0.5)?V+{share}*(target-mean):mean"), "begun=1".into()]);
        let mut text = format!(
            "// Pressure P + (Rp + Rd) Q at an outlet with the flow rate Q{}. Rp and Rd are resistances\n// by density. The \
             face follows its cell by 1 - f, so that the iteration is stable. The conductance G of\n// half a cell depends \
             on {why}.\noutletModel\n{{\n    type exprMixed;\n    value uniform 0;\n    storedVariables\n    (\n",
            if has_capacitance { ", or of a capacitance with the time constant tau" } else { "" }
        );
        for name in stored {
            let _ = writeln!(text, "        {{ name {name}; initialValue \"0\"; }}");
        }
        text += "    );\n    variables\n    (\n";
        for line in lines {
            let _ = writeln!(text, "        \"{line}\"");
        }
        text += "    );\n    valueExpr \"V\";\n    gradientExpr \"0\";\n    fractionExpr \"f\";\n}\n\n";
        text
    }

    /// Entries of the outlets: one for all of them if they have the same pressure.
    pub(super) fn entries(&self) -> String {
        let first = self.list.first().map_or(0.0, |(_, model)| model.beyond);
        if !self.are_coupled() && self.list.iter().all(|(_, model)| model.beyond == first) {
            return format!(
                "    \"outlet.*\"\n    {{\n        type fixedValue;\n        value uniform {first:e};\n    }}\n"
            );
        }
        let mut text = String::new();
        for (patch, model) in &self.list {
            let Kinematic { proximal, distal, time, beyond, mean } = model;
            let name = &patch.name;
            let start = if self.is_transient { mean[1] } else { *beyond };
            let _ = if model.is_pressure() {
                writeln!(text, "    {name} {{ type fixedValue; value uniform {beyond:e}; }}")
            } else {
                writeln!(
                    text,
                    "    {name} {{ $outletModel; Rp {proximal:e}; Rd {distal:e}; tau {time:e}; P {beyond:e}; value \
                     uniform {start:e}; }}"
                )
            };
        }
        text
    }
}
