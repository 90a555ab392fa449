//! Case of steady diffusion out of the lumen, such as that of oxygen, for `laplacianFoam`.

use super::boundary::{Boundary, FoamPatch};
use super::figures::Figures;
use super::head;
use std::fmt::Write;

pub(super) const FILES: [&str; 5] =
    ["0/T", "constant/transportProperties", "system/controlDict", "system/fvSchemes", "system/fvSolution"];

/// Diffusivity of oxygen in tissue at 37 °C, in m²/s (Bentley, Meng and Pittman 1993).
const DIFFUSIVITY: f64 = 2.41e-9;

/// Maximum number of corrections of non-orthogonality.
const CORRECTIONS: u32 = 20;

/// Angle, in degrees, up to which non-orthogonality is corrected in full. At 83.8 degrees, a third of the correction converges
/// in 20 corrections; the whole, and a half of it, do not.
const CORRECTED: f64 = 70.0;

/// Contents of the files. The lumen has concentration 1, outer surfaces 0; nothing passes ends of vessels and walls.
pub(super) fn texts(boundary: &Boundary, figures: &Figures) -> [(&'static str, String); 5] {
    let texts = [concentration(boundary), transport(), control(), schemes(figures), solution()];
    let mut texts = texts.into_iter();
    FILES.map(|name| (name, texts.next().unwrap_or_default()))
}

/// True if nothing passes through a patch: the flat end of a vessel, of its wall, or of an annulus.
fn is_end(patch: &FoamPatch) -> bool {
    ["inlet", "outlet", "ring"].iter().any(|kind| patch.name.starts_with(kind))
}

/// True for the surface of the lumen, seen from both sides, or from the other regions if the lumen is left out.
fn is_of_lumen(patch: &FoamPatch) -> bool {
    let name = &patch.name;
    ["lumen_to_", "interface_lumen_"].iter().any(|start| name.starts_with(start)) || name.ends_with("_to_lumen")
}

fn concentration(boundary: &Boundary) -> String {
    let mut text = head::text("volScalarField", "0/T");
    text += "dimensions      [0 0 0 0 0 0 0];\ninternalField   uniform 0;\n\nboundaryField\n{\n";
    for patch in &boundary.patches {
        let entry = match (is_end(patch), is_of_lumen(patch)) {
            (true, _) => "type zeroGradient;",
            (_, true) => "type fixedValue;\n        value uniform 1;",
            _ => "type fixedValue;\n        value uniform 0;",
        };
        let _ = writeln!(text, "    {}\n    {{\n        {entry}\n    }}", patch.name);
    }
    text + "}\n"
}

fn transport() -> String {
    head::text("dictionary", "constant/transportProperties")
        + &format!("// Oxygen in tissue, in m2/s.\nDT              [0 2 -1 0 0 0 0] {DIFFUSIVITY:e};\n")
}

fn control() -> String {
    head::text("dictionary", "system/controlDict")
        + "application     laplacianFoam;\nstartFrom       latestTime;\nstartTime       0;\nstopAt          endTime;\nendTime         \
           1;\ndeltaT          1;\nwriteControl    timeStep;\nwriteInterval   1;\npurgeWrite      0;\nwriteFormat     \
           binary;\nwritePrecision  10;\nwriteCompression off;\ntimeFormat      general;\ntimePrecision   8;\n"
}

fn schemes(figures: &Figures) -> String {
    let angle = figures.max_angle;
    let correction = if angle <= CORRECTED { "corrected" } else { "limited corrected 0.33" };
    head::text("dictionary", "system/fvSchemes")
        + &format!(
            "ddtSchemes           {{ default steadyState; }}\ngradSchemes          {{ default Gauss linear; \
             }}\ndivSchemes           {{ default none; }}\n// Non-orthogonality of the mesh: max {angle:.1}, mean {:.1} degrees; \
             corrected in full up to {CORRECTED} degrees.\nlaplacianSchemes     {{ default Gauss linear {correction}; \
             }}\ninterpolationSchemes {{ default linear; }}\nsnGradSchemes        {{ default {correction}; }}\n",
            figures.mean_angle()
        )
}

fn solution() -> String {
    head::text("dictionary", "system/fvSolution")
        + &format!(
            "solvers\n{{\n    T\n    {{\n        solver          PCG;\n        preconditioner  DIC;\n        tolerance       \
             1e-9;\n        relTol          0.01;\n    }}\n}}\n\nSIMPLE\n{{\n    nNonOrthogonalCorrectors {CORRECTIONS};\n}}\n"
        )
}
