//! Dictionaries of the mesh, the fluid and the decomposition.

use super::boundary::{Boundary, FoamPatch};
use super::head;
use crate::flow::{Flow, Role};
use std::fmt::Write;

/// Patch list. Inlets and outlets form groups, so that a case can address them together.
pub(super) fn boundary(boundary: &Boundary) -> String {
    let mut text = head::text("polyBoundaryMesh", "constant/polyMesh/boundary");
    let _ = writeln!(text, "{}\n(", boundary.patches.len());
    for FoamPatch { name, role, faces, first, .. } in &boundary.patches {
        let (kind, group) = match role {
            Role::Wall => ("wall", "wall"),
            Role::Inlet => ("patch", "inlets"),
            Role::Outlet => ("patch", "outlets"),
        };
        // A group with the name of its patch is omitted.
        let groups = if name == group { String::new() } else { format!("inGroups 1({group}); ") };
        let _ = writeln!(text, "    {name} {{ type {kind}; {groups}nFaces {faces}; startFace {first}; }}");
    }
    text + ")\n"
}

pub(super) fn transport(flow: &Flow) -> String {
    let nu = flow.viscosity / flow.density;
    head::text("dictionary", "constant/transportProperties")
        + &format!("transportModel  Newtonian;\nnu              [0 2 -1 0 0 0 0] {nu:e};\n")
}

pub(super) fn turbulence() -> String {
    head::text("dictionary", "constant/turbulenceProperties") + "simulationType  laminar;\n"
}

pub(super) fn decompose() -> String {
    head::text("dictionary", "system/decomposeParDict")
        + "numberOfSubdomains 4;\n// Asks for no library; scotch is better where it exists.\nmethod          hierarchical;\n\
           coeffs          { n (2 2 1); }\n"
}
