//! Quality of the tetrahedra, and radius error of the wall.

use super::figures::{figure, relative};
use super::html::Section;
use crate::fidelity::{Along, Changes, Fidelity};
use crate::report::plot::{Panel, Series};
use anastomesh_mesh::dihedral::DihedralHistogram;
use anastomesh_mesh::quality::TetQuality;
use anastomesh_network::NameOf;

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
            ("mean radius ratio", figure(quality.mean)),
            ("1st percentile of radius ratio", figure(quality.percentile_1)),
            ("min radius ratio", figure(quality.min)),
            ("min dihedral angle", format!("{:.1}°", quality.dihedral_min)),
            ("max dihedral angle", format!("{:.1}°", quality.dihedral_max)),
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
pub fn fidelity(fidelity: &Fidelity, along: &Along, changes: &Changes, name: NameOf) -> Section {
    let line = |label: &str, k: usize| Series {
        label: label.into(),
        points: along.bins.iter().filter_map(|bin| Some([bin.share, 100.0 * bin.quantiles?[k]])).collect(),
    };
    let plot = Panel {
        title: "Radius error along vessels".into(),
        axes: ["position along the vessel (0 and 1: its ends)".into(), "radius error (%)".into()],
        logarithmic: false,
        bars: None,
        series: vec![line("95 %", 2), line("median", 1), line("5 %", 0)],
    };
    let (axis, wall) = (&fidelity.axis.spread, &fidelity.wall);
    let mut tiles = vec![
        ("median axis error", format!("{} radii", relative(axis.median))),
        ("axis error, 99th percentile and max", format!("{} and {} radii", relative(axis.p99), relative(axis.worst))),
    ];
    // Only for unmoved vessels: otherwise it would look like a wall error, as the plot uses the meshed vessels.
    if !fidelity.is_moved() {
        tiles.push(("median radius error", format!("{} %", figure(100.0 * wall.median))));
        tiles.push(("radius error, 99th percentile", format!("{} %", figure(100.0 * wall.p99))));
    }
    tiles.push(("volume relative to the network", format!("{:+.2} %", 100.0 * fidelity.swelling())));
    Section::new("Accuracy against the network").tiles(&tiles).text(&changes.text(name)).plots(&[plot])
}
