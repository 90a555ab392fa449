//! Initial and boundary values: velocity and pressure.

use super::boundary::Boundary;
use super::outlets::Outlets;
use super::rules::Settings;
use super::{head, inflow};
use crate::flow::{Flow, Role};
use std::fmt::Write;

pub(super) fn velocity(boundary: &Boundary, flow: &Flow, parts: Option<usize>) -> String {
    let mut text = head::text("volVectorField", "0/U");
    text += "dimensions      [0 1 -1 0 0 0 0];\ninternalField   uniform (0 0 0);\n\nboundaryField\n{\n";
    text += &inflow::entries(boundary, flow);
    // In pulsatile flow an outlet may be an inlet for a while.
    let outlet = if flow.transient.is_some() {
        "type pressureInletOutletVelocity;\n        value uniform (0 0 0);"
    } else {
        "type inletOutlet;\n        inletValue uniform (0 0 0);\n        value uniform (0 0 0);"
    };
    text += &per_name(boundary, Role::Outlet, outlet);
    text + &per_name(boundary, Role::Wall, "type noSlip;") + &between_processors(parts, "(0 0 0)") + "}\n"
}

pub(super) fn pressure(boundary: &Boundary, flow: &Flow, settings: &Settings, parts: Option<usize>) -> String {
    let outlets = Outlets::of(boundary, flow);
    let mut text = head::text("volScalarField", "0/p");
    text += "// Pressure by density.\n";
    text += &outlets.definition(flow.viscosity / flow.density, settings.relaxation[0]);
    let _ = write!(text, "dimensions      [0 2 -2 0 0 0 0];\ninternalField   uniform {:e};\n\n", outlets.start());
    text += "boundaryField\n{\n";
    text += &outlets.entries();
    text += &per_name(boundary, Role::Inlet, "type zeroGradient;");
    let start = format!("{:e}", outlets.start());
    text + &per_name(boundary, Role::Wall, "type zeroGradient;") + &between_processors(parts, &start) + "}\n"
}

/// Entry of the faces between processors in a case with parts.
fn between_processors(parts: Option<usize>, value: &str) -> String {
    let entry =
        || format!("    \"procBoundary.*\"\n    {{\n        type processor;\n        value uniform {value};\n    }}\n");
    parts.map_or_else(String::new, |_| entry())
}

/// Entry for all patches of a role: by name pattern, or for walls by each name.
fn per_name(boundary: &Boundary, role: Role, entry: &str) -> String {
    let names: Vec<String> = match role {
        Role::Inlet => vec!["\"inlet.*\"".into()],
        Role::Outlet => vec!["\"outlet.*\"".into()],
        Role::Wall => boundary.with_role(role).map(|patch| patch.name.clone()).collect(),
    };
    names.iter().map(|name| format!("    {name}\n    {{\n        {entry}\n    }}\n")).collect()
}
