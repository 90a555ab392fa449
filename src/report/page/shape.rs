//! Quality of the tetrahedra, and radius error of the wall.

use super::html::Section;
use crate::fidelity::{Along, Fidelity};
use crate::report::plot::{Panel, Series};
use anastomesh_mesh::dihedral::DihedralHistogram;
use anastomesh_mesh::quality::TetQuality;

/// Histograms of radius ratios (Fig. 8 of the paper) and dihedral angles.
pub fn quality(quality: &TetQuality, dihedral: &DihedralHistogram) -> Section {
    let width = 1.0 / quality.histogram.len() as f64;
    let ratios = bars(
        "Radius ratio 3 r/R",
        ["radius ratio (1: regular)", "tetrahedra (%)"],
        width,
        quality.histogram.iter().copied(),
    );
    let angles = bars(
        "Dihedral angles",
        ["angle (degrees)", "angles (%)"],
        DihedralHistogram::WIDTH,
        dihedral.counts().iter().copied(),
    );
    Section::new("Shape of the tetrahedra")
        .tiles(&[
            ("mean radius ratio", format!("{:.4}", quality.mean)),
            ("1st percentile", format!("{:.4}", quality.percentile_1)),
            ("smallest", format!("{:.4}", quality.min)),
            ("smallest dihedral angle", format!("{:.2}°", quality.dihedral_min)),
            ("largest dihedral angle", format!("{:.2}°", quality.dihedral_max)),
        ])
        .plots(&[ratios, angles])
}

/// Histogram in percent.
pub(super) fn bars(title: &str, axes: [&str; 2], width: f64, counts: impl Iterator<Item = u64> + Clone) -> Panel {
    let sum = counts.clone().sum::<u64>().max(1) as f64;
    let points = counts.enumerate().map(|(i, n)| [(i as f64 + 0.5) * width, 100.0 * n as f64 / sum]).collect();
    Panel {
        title: title.into(),
        axes: axes.map(Into::into),
        logarithmic: false,
        bars: Some(width),
        series: vec![Series { label: String::new(), points }],
    }
}

/// Fidelity of the mesh to the network: axis, wall along the vessels, lumen.
pub fn fidelity(fidelity: &Fidelity, along: &Along) -> Section {
    let line = |label: &str, k: usize| Series {
        label: label.into(),
        points: along.bins.iter().filter_map(|bin| Some([bin.share, 100.0 * bin.quantiles?[k]])).collect(),
    };
    let plot = Panel {
        title: "Radius error along vessels, as they were meshed".into(),
        axes: ["place along the vessel (0 and 1: its ends)".into(), "wall from the given radius (%)".into()],
        logarithmic: false,
        bars: None,
        series: vec![line("95 %", 2), line("median", 1), line("5 %", 0)],
    };
    let (axis, wall) = (&fidelity.axis.spread, &fidelity.wall);
    let mut tiles = vec![
        ("axis off the given one, median", format!("{:.4} radii", axis.median)),
        ("99 %, at most", format!("{:.3}, {:.3} radii", axis.p99, axis.worst)),
    ];
    // Only for unmoved vessels: otherwise it would look like a wall error, as the plot uses the meshed vessels.
    if !fidelity.is_moved() {
        tiles.push(("wall off the radius, median", format!("{:.2} %", 100.0 * wall.median)));
        tiles.push(("99 %", format!("{:.1} %", 100.0 * wall.p99)));
    }
    tiles.push(("volume against the given lumen", format!("{:+.2} %", 100.0 * fidelity.swelling())));
    Section::new("The network in the mesh").tiles(&tiles).plots(&[plot])
}
