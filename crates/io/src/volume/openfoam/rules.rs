//! Numerical settings of a case, chosen from the figures of its mesh and flow.
//!
//! The thresholds were found with `simpleFoam` of v1912 on the meshes of `benches/README.md` (section on solver cases).

use super::figures::Figures;
use std::fmt::Write;

/// Angle, in degrees, up to which non-orthogonality is corrected in full. At 79.7 degrees the full correction converged in
/// 91 iterations, half of it with two correctors did not in 1,400.
const CORRECTED: f64 = 85.0;
/// Angle, in degrees, above which no setting is expected to converge.
const HOPELESS: f64 = 88.0;
/// Skewness above which gradients are limited.
const SKEWED: f64 = 4.0;
/// Skewness above which no setting is expected to converge.
const TOO_SKEWED: f64 = 20.0;
/// Mean angle, in degrees, up to which tetrahedra without layers are compact. Plain meshes have at most 17, stretched ones at
/// least 20.
const COMPACT: f64 = 18.0;
/// Reynolds number (mean velocity, diameter) above which both equations are relaxed more.
const FAST: f64 = 300.0;
/// Reynolds number above which flow in a tube is turbulent.
const TURBULENT: f64 = 2300.0;

/// Settings of schemes and solution.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Settings {
    /// Gradient scheme of the pressure, and of the velocity.
    pub(super) gradients: [&'static str; 2],
    /// Share of the correction of non-orthogonality.
    pub(super) correction: &'static str,
    /// Correctors of the pressure equation.
    pub(super) correctors: u32,
    /// Relaxation of the momentum equation, and of the pressure.
    pub(super) relaxation: [f64; 2],
    /// Figures and the reason of each choice, as comments.
    pub(super) reason: String,
    /// Reasons why the case is not expected to converge.
    pub(super) doubts: Vec<String>,
}

impl Settings {
    /// Settings for a mesh with these figures and the highest Reynolds number of its inlets. With `coupled` outlets the
    /// pressure equation has one corrector: their pressure follows each flow rate. `layered` meshes have prisms at the wall.
    /// In `transient` flow, pressure and velocity oscillate unless the gradient of the pressure matches the divergence of its
    /// equation.
    pub(super) fn of(figures: &Figures, layered: bool, reynolds: f64, coupled: bool, transient: bool) -> Self {
        let angle = figures.max_angle;
        let correction = if angle <= CORRECTED { "corrected" } else { "limited corrected 0.5" };
        let is_skewed = figures.skewness > SKEWED || angle > CORRECTED;
        let is_compact = layered || figures.mean_angle() <= COMPACT;
        let gradients = match is_skewed {
            true => ["cellLimited Gauss linear 1"; 2],
            false if transient && is_compact => ["Gauss linear", "pointCellsLeastSquares"],
            false if is_compact => ["pointCellsLeastSquares"; 2],
            false if transient || reynolds > FAST => ["Gauss linear"; 2],
            false => ["Gauss pointLinear", "Gauss linear"],
        };
        // A relaxed momentum equation needs a relaxed pressure: with 0.7 and 1 residuals remain at 0.1.
        let relaxation = if is_skewed || reynolds > FAST { [0.8, 0.8] } else { [0.9, 1.0] };
        let mut reason = String::new();
        let _ = writeln!(
            reason,
            "// The mesh: non-orthogonality max {angle:.1}, mean {:.1} degrees; skewness max {:.2}; growth of volume\n// between \
             neighbours max {:.1}. Reynolds number at the inlets at most {reynolds:.3}.",
            figures.mean_angle(),
            figures.skewness,
            figures.growth
        );
        let mut doubts = Vec::new();
        if angle > HOPELESS || figures.skewness > TOO_SKEWED {
            doubts.push(format!(
                "non-orthogonality up to {angle:.1} degrees and skewness up to {:.1} let solvers diverge; choose fewer \
                 layers or a larger rho",
                figures.skewness
            ));
        }
        if reynolds > TURBULENT {
            doubts.push(format!(
                "Reynolds number {reynolds:.0} at an inlet is beyond laminar flow; check the flow rate and its unit"
            ));
        }
        Self { gradients, correction, correctors: u32::from(!coupled), relaxation, reason, doubts }
    }

    /// Comment on the gradient schemes.
    pub(super) fn why_gradients(&self) -> &'static str {
        match self.gradients {
            ["Gauss linear", "pointCellsLeastSquares"] => {
                "// The gradient of the pressure matches its equation, or pressure and velocity oscillate in time. That of the \
                 velocity is\n// by least squares over all cells at a cell's points: wall cells of tetrahedra have too few face \
                 neighbours."
            }
            ["pointCellsLeastSquares", _] => {
                "// Least squares over all cells at a cell's points: wall cells of tetrahedra have too few face neighbours."
            }
            ["Gauss pointLinear", _] => {
                "// Least squares are less exact on long tetrahedra. Values at points correct the skewness of their faces in \
                 the\n// pressure; in the velocity they make outlet fractions less exact."
            }
            ["Gauss linear", _] => {
                "// For flow in time or fast flow through long tetrahedra: pressure and velocity oscillate or diverge with \
                 others."
            }
            _ => "// Limited because of the skewness or non-orthogonality.",
        }
    }

    /// Comment on the correction of non-orthogonality.
    pub(super) fn why_correction(&self) -> String {
        let reason = match self.correction {
            "corrected" => format!("full up to {CORRECTED} degrees"),
            _ => format!("half above {CORRECTED} degrees"),
        };
        format!("// Correction of non-orthogonality: {reason}.")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_follow_the_figures() {
        let figures = |max_angle, skewness| Figures { max_angle, skewness, growth: 3.0, ..Figures::default() };
        let good = Settings::of(&figures(60.0, 1.0), false, 1.0, false, false);
        assert_eq!((good.gradients[0], good.correction, good.correctors), ("pointCellsLeastSquares", "corrected", 1));
        let pulsatile = Settings::of(&figures(60.0, 1.0), true, 1.0, false, true);
        assert_eq!(pulsatile.gradients, ["Gauss linear", "pointCellsLeastSquares"]);
        let long = Figures { angles: 40.0, faces: 1, ..figures(79.0, 1.0) };
        assert_eq!(Settings::of(&long, false, 1.0, false, false).gradients, ["Gauss pointLinear", "Gauss linear"]);
        assert_eq!(Settings::of(&long, false, 1.0, false, true).gradients, ["Gauss linear"; 2]);
        assert_eq!(Settings::of(&long, false, 400.0, false, false).gradients, ["Gauss linear"; 2]);
        assert_eq!(Settings::of(&long, true, 1.0, false, false).gradients, ["pointCellsLeastSquares"; 2]);
        assert_eq!((good.relaxation, good.doubts.len()), ([0.9, 1.0], 0));
        let fast = Settings::of(&figures(60.0, 1.0), false, 400.0, true, false);
        assert_eq!((fast.relaxation, fast.correctors), ([0.8, 0.8], 0));
        let skewed = Settings::of(&figures(60.0, 6.0), false, 1.0, false, false);
        assert_eq!((skewed.gradients[0], skewed.relaxation), ("cellLimited Gauss linear 1", [0.8, 0.8]));
        let flat = Settings::of(&figures(89.0, 1.0), false, 3000.0, false, false);
        assert_eq!((flat.correction, flat.relaxation), ("limited corrected 0.5", [0.8, 0.8]));
        assert_eq!(flat.doubts.len(), 2);
        assert!(flat.doubts[0].contains("89.0 degrees") && flat.doubts[1].contains("3000"), "{:?}", flat.doubts);
    }
}
