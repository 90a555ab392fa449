//! Advice after a failed run: command line options to try.

use crate::pipeline::RunReport;

/// Factor on the resolution for the next attempt.
const FINER: f64 = 1.5;

/// Returns one line per option that may help. `invalid`: the mesh is not valid; `refined`: the network was refined
/// first; `rho`: requested resolution.
pub fn advice(run: &RunReport, invalid: bool, refined: bool, rho: f64) -> Vec<String> {
    let mut lines = Vec::new();
    if run.failed.is_empty() && !invalid {
        return lines;
    }
    if !run.overlaps.is_empty() || !run.fused.is_empty() {
        lines.push(if refined {
            "some overlapping vessels could not be moved apart: --residual fuse accepts them as one lumen and counts the loops"
                .into()
        } else {
            "vessels overlap or come too close: --refine moves them apart".into()
        });
    }
    if run.fused.iter().any(|block| !block.uncapped.is_empty()) {
        lines.push("tips end in other vessels: --touching retract shortens them, --touching join connects them".into());
    }
    if run.failed.iter().any(|block| block.too_fine) {
        lines.push(
            "the radii in a block differ too much for one grid: remove the thinnest vessels, or try a smaller --rho"
                .into(),
        );
    } else if run.overlaps.is_empty() || refined {
        lines.push(format!("a finer resolution may help: --rho {}", (FINER * rho).ceil()));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{FailedBlock, Meeting};

    #[test]
    fn what_would_help_is_named_and_nothing_where_all_is_well() {
        let meeting = Meeting { edges: [[0, 1], [2, 3]], vessels: [0, 1], distance: 0.5, radii: 1.0 };
        let failed = FailedBlock {
            block: "cluster 0".into(),
            nodes: vec![0],
            reason: String::new(),
            uncapped: Vec::new(),
            too_fine: false,
            dump: None,
        };
        let overlapping = RunReport { overlaps: vec![meeting], ..RunReport::default() };
        let fine = FailedBlock { too_fine: true, ..failed.clone() };
        let fine = RunReport { failed: vec![fine], ..RunReport::default() };
        let broken = RunReport { failed: vec![failed], ..RunReport::default() };
        assert_eq!(advice(&overlapping, false, false, 3.0), Vec::<String>::new());
        let options = |run: &RunReport, refined| -> Vec<String> {
            let option = |line: &String| line.split("--").nth(1).map(|w| w.split(' ').next().unwrap_or("").to_owned());
            advice(run, true, refined, 3.0).iter().filter_map(option).collect()
        };
        assert_eq!(options(&overlapping, false), ["refine"]);
        assert_eq!(options(&overlapping, true), ["residual", "rho"]);
        assert_eq!(options(&broken, false), ["rho"]);
        assert!(options(&fine, false) == ["rho"] && advice(&fine, false, false, 3.0)[0].ends_with("a smaller --rho"));
        assert!(advice(&broken, false, false, 3.0)[0].ends_with("--rho 5"));
    }
}
