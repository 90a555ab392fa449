//! Control, schemes and solution of a case: steady flow by `simpleFoam`, flow in time by `pimpleFoam`.

use super::head;
use super::rules::Settings;
use crate::flow::{Flow, Transient};
use std::fmt::Write;

/// Maximum Courant number. Three outer correctors per time step allow more than 1.
const COURANT: f64 = 2.0;
/// Minimum number of time steps per period, and number of first steps that would fill it.
const STEPS: [f64; 2] = [400.0, 10_000.0];

pub(super) fn control(flow: &Flow) -> String {
    let head = head::text("dictionary", "system/controlDict");
    let Some(transient) = &flow.transient else { return head + STEADY_CONTROL + COMMON_CONTROL };
    let Transient { period, outputs, .. } = *transient;
    let text = format!(
        "application     pimpleFoam;\nstartFrom       latestTime;\nstartTime       0;\nstopAt          endTime;\n// {} periods \
         of {period} s.\nendTime         {};\n// The time step follows the Courant number.\ndeltaT          {:e};\nadjustTimeStep  \
         yes;\nmaxCo           {COURANT};\nmaxDeltaT       {:e};\nwriteControl    adjustableRunTime;\nwriteInterval   {};\n",
        transient.periods,
        transient.end(),
        period / STEPS[1],
        period / STEPS[0],
        period / f64::from(outputs.max(1)),
    );
    head + &text + COMMON_CONTROL
}

pub(super) fn schemes(flow: &Flow, settings: &Settings) -> String {
    let Settings { gradients: [pressure, velocity], correction, reason, .. } = settings;
    let own = if pressure == velocity { String::new() } else { format!(" grad(U) {velocity};") };
    let (time, convection) = if flow.transient.is_some() {
        ("backward", "Gauss linearUpwind grad(U)")
    } else {
        ("steadyState", "bounded Gauss linearUpwind grad(U)")
    };
    head::text("dictionary", "system/fvSchemes")
        + &format!(
            "{reason}ddtSchemes           {{ default {time}; }}\n{}\ngradSchemes          {{ default {pressure};{own} \
             }}\ndivSchemes\n{{\n    default          none;\n    div(phi,U)       {convection};\n    \
             div((nuEff*dev2(T(grad(U))))) Gauss linear;\n}}\n{}\nlaplacianSchemes     {{ default Gauss linear {correction}; \
             }}\ninterpolationSchemes {{ default linear; }}\nsnGradSchemes        {{ default {correction}; }}\n",
            settings.why_gradients(),
            settings.why_correction()
        )
}

pub(super) fn solution(flow: &Flow, settings: &Settings) -> String {
    let Settings { correctors, relaxation: [momentum, pressure], reason, .. } = settings;
    let mut text = head::text("dictionary", "system/fvSolution");
    text += reason;
    let solver = |name: &str, more: &str| format!("    {name}\n    {{\n{more}    }}\n");
    let of_pressure = "        solver          GAMG;\n        smoother        GaussSeidel;\n";
    let of_velocity = "        solver          smoothSolver;\n        smoother        symGaussSeidel;\n";
    text += "solvers\n{\n";
    if flow.transient.is_some() {
        let usual = "        tolerance       1e-9;\n        relTol          0.01;\n";
        text += &solver("p", &format!("{of_pressure}{usual}"));
        text += &solver("pFinal", "        $p;\n        relTol          0;\n");
        text += &solver("U", &format!("{of_velocity}{usual}"));
        text += &solver("UFinal", "        $U;\n        relTol          0;\n");
        text += "}\n\nPIMPLE\n{\n    // Outer correctors repeat a time step, so that the Courant number can exceed 1.\n    \
                 nOuterCorrectors 3;\n    // With one corrector, flow through layers of prisms diverges.\n    nCorrectors     2;\n";
        let _ = write!(text, "    nNonOrthogonalCorrectors {correctors};\n}}\n\n");
        text += "relaxationFactors\n{\n    equations       { \".*\" 1; }\n}\n";
        return text;
    }
    let usual = "        tolerance       1e-30;\n        relTol          0.01;\n";
    text += &solver("p", &format!("{of_pressure}{usual}"));
    text += &solver("U", &format!("{of_velocity}{usual}"));
    let _ = write!(
        text,
        "}}\n\nSIMPLE\n{{\n    consistent      yes;\n    // None with outlets whose pressure follows the flow rate: they need it \
         after each solution.\n    nNonOrthogonalCorrectors {correctors};\n    residualControl\n    {{\n        p               1e-5;\n        U               \
         1e-5;\n    }}\n}}\n\n// By Reynolds number, non-orthogonality and skewness; 0.9 and 1 are the fastest.\nrelaxationFactors\n{{\n    fields          {{ p \
         {pressure}; }}\n    equations       {{ U {momentum}; }}\n}}\n"
    );
    text
}

const STEADY_CONTROL: &str = "\
application     simpleFoam;
startFrom       latestTime;
startTime       0;
// Iterations; it ends before when residualControl in fvSolution is met.
stopAt          endTime;
endTime         2000;
deltaT          1;
writeControl    timeStep;
writeInterval   2000;
";

const COMMON_CONTROL: &str = "\
purgeWrite      0;
writeFormat     binary;
writePrecision  10;
writeCompression off;
timeFormat      general;
timePrecision   8;
runTimeModifiable true;
";
