//! Dictionaries of the mesh, the fluid and the decomposition.

use super::boundary::{Boundary, FoamPatch};
use super::head;
use crate::flow::{Flow, Role};
use std::fmt::Write;

/// Patch list of the undivided mesh.
pub(super) fn boundary(boundary: &Boundary) -> String {
    let entries: Vec<String> = boundary.patches.iter().map(|p| patch(p, p.faces, p.first)).collect();
    patch_list(&entries)
}

/// Patch list with these entries.
pub(super) fn patch_list(entries: &[String]) -> String {
    let mut text = head::text("polyBoundaryMesh", "constant/polyMesh/boundary");
    let _ = writeln!(text, "{}\n(", entries.len());
    text + &entries.concat() + ")\n"
}

/// Entry of a patch with these faces. Inlets and outlets form groups, so that a case can address them together.
pub(super) fn patch(FoamPatch { name, role, .. }: &FoamPatch, faces: u64, first: u64) -> String {
    let (kind, group) = match role {
        Role::Wall => ("wall", "wall"),
        Role::Inlet => ("patch", "inlets"),
        Role::Outlet => ("patch", "outlets"),
    };
    // A group with the name of its patch is omitted.
    let groups = if name == group { String::new() } else { format!("inGroups 1({group}); ") };
    format!("    {name} {{ type {kind}; {groups}nFaces {faces}; startFace {first}; }}\n")
}

/// Entry of a patch whose faces coincide with those of a patch of another region.
pub(super) fn mapped_patch(FoamPatch { name, faces, first, .. }: &FoamPatch, region: &str, other: &str) -> String {
    format!(
        "    {name} {{ type mappedWall; inGroups 1(wall); nFaces {faces}; startFace {first}; sampleMode nearestPatchFace; \
         sampleRegion {region}; samplePatch {other}; }}\n"
    )
}

/// Entry of the faces that a processor shares with another one.
pub(super) fn processor_patch([own, other]: [u32; 2], faces: u64, first: u64) -> String {
    format!(
        "    procBoundary{own}to{other} {{ type processor; inGroups 1(processor); nFaces {faces}; startFace {first}; \
         matchTolerance 0.0001; transform unknown; myProcNo {own}; neighbProcNo {other}; }}\n"
    )
}

pub(super) fn transport(flow: &Flow) -> String {
    let nu = flow.viscosity / flow.density;
    head::text("dictionary", "constant/transportProperties")
        + &format!("transportModel  Newtonian;\nnu              [0 2 -1 0 0 0 0] {nu:e};\n")
}

pub(super) fn turbulence() -> String {
    head::text("dictionary", "constant/turbulenceProperties") + "simulationType  laminar;\n"
}

/// Decomposition: `parts` as written, or a usual number.
pub(super) fn decompose(parts: Option<usize>) -> String {
    let head = head::text("dictionary", "system/decomposeParDict");
    match parts {
        Some(parts) => format!(
            "{head}// The case is decomposed; decomposePar would do it again, by another method.\nnumberOfSubdomains \
             {parts};\nmethod          hierarchical;\ncoeffs          {{ n ({parts} 1 1); }}\n"
        ),
        None => {
            head + "numberOfSubdomains 4;\n// Asks for no library; scotch is better where it exists.\nmethod          \
               hierarchical;\ncoeffs          { n (2 2 1); }\n"
        }
    }
}
