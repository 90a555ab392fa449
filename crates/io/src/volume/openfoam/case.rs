//! Dictionaries of a case: steady laminar flow with given inflow and zero pressure at the outlets.

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

pub(super) fn velocity(boundary: &Boundary, flow: &Flow) -> String {
    let mut text = head::text("volVectorField", "0/U");
    text += "dimensions      [0 1 -1 0 0 0 0];\ninternalField   uniform (0 0 0);\n\nboundaryField\n{\n";
    for inlet in boundary.with_role(Role::Inlet) {
        let rate = flow.at(&inlet.patch).flow;
        let _ = writeln!(
            text,
            "    {}\n    {{\n        type flowRateInletVelocity;\n        volumetricFlowRate constant {rate:e};\n        \
             value uniform (0 0 0);\n    }}",
            inlet.name
        );
    }
    text += &per_name(
        boundary,
        Role::Outlet,
        "type inletOutlet;\n        inletValue uniform (0 0 0);\n        value uniform (0 0 0);",
    );
    text + &per_name(boundary, Role::Wall, "type noSlip;") + "}\n"
}

pub(super) fn pressure(boundary: &Boundary) -> String {
    let mut text = head::text("volScalarField", "0/p");
    text += "// Pressure by density. What comes after an outlet is not in it: with resistances, each outlet has its own value.\n\
             dimensions      [0 2 -2 0 0 0 0];\ninternalField   uniform 0;\n\nboundaryField\n{\n";
    text += &per_name(boundary, Role::Outlet, "type fixedValue;\n        value uniform 0;");
    text += &per_name(boundary, Role::Inlet, "type zeroGradient;");
    text + &per_name(boundary, Role::Wall, "type zeroGradient;") + "}\n"
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

pub(super) fn transport(flow: &Flow) -> String {
    let nu = flow.viscosity / flow.density;
    head::text("dictionary", "constant/transportProperties")
        + &format!("transportModel  Newtonian;\nnu              [0 2 -1 0 0 0 0] {nu:e};\n")
}

pub(super) fn turbulence() -> String {
    head::text("dictionary", "constant/turbulenceProperties") + "simulationType  laminar;\n"
}

pub(super) fn control() -> String {
    head::text("dictionary", "system/controlDict") + CONTROL
}

pub(super) fn schemes() -> String {
    head::text("dictionary", "system/fvSchemes") + SCHEMES
}

pub(super) fn solution() -> String {
    head::text("dictionary", "system/fvSolution") + SOLUTION
}

pub(super) fn decompose() -> String {
    head::text("dictionary", "system/decomposeParDict")
        + "numberOfSubdomains 4;\n// Asks for no library; scotch is better where it is there.\nmethod          hierarchical;\n\
           coeffs          { n (2 2 1); }\n"
}

const CONTROL: &str = "\
application     simpleFoam;
startFrom       latestTime;
startTime       0;
// Iterations; it ends before when residualControl in fvSolution is met.
stopAt          endTime;
endTime         2000;
deltaT          1;
writeControl    timeStep;
writeInterval   2000;
purgeWrite      0;
writeFormat     binary;
writePrecision  10;
writeCompression off;
timeFormat      general;
timePrecision   8;
runTimeModifiable true;
";

const SCHEMES: &str = "\
ddtSchemes           { default steadyState; }
gradSchemes          { default leastSquares; }
divSchemes
{
    default          none;
    div(phi,U)       bounded Gauss linearUpwind grad(U);
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes     { default Gauss linear corrected; }
interpolationSchemes { default linear; }
snGradSchemes        { default corrected; }
";

const SOLUTION: &str = "\
solvers
{
    p
    {
        solver          GAMG;
        smoother        GaussSeidel;
        tolerance       1e-30;
        relTol          0.01;
    }
    U
    {
        solver          smoothSolver;
        smoother        symGaussSeidel;
        tolerance       1e-30;
        relTol          0.01;
    }
}

SIMPLE
{
    consistent      yes;
    nNonOrthogonalCorrectors 1;
    residualControl
    {
        p               1e-5;
        U               1e-5;
    }
}

relaxationFactors
{
    fields          { p 1; }
    equations       { U 0.9; }
}
";
