//! Reports of a refinement: text, table, plot panels.

use std::fmt::Write as _;

use super::plot::{Panel, Series};
use super::rows::{Ended, row};
use anastomesh_mesh::units::{counted, grouped, number, percent as share};
use anastomesh_network::{HistorySample, NameOf, RefineReport};

/// Pairs that a summary lists.
const SPELT_OUT: usize = 3;

/// Short summary: input, displacement, remaining overlaps, output files. `fidelity` are the rows that compare the result with
/// the given network.
pub fn brief(report: &RefineReport, fidelity: &str, name: NameOf, ended: &Ended) -> String {
    let RefineReport { size_before, size_after, displacement: d, given, result, .. } = report;
    let [nodes, edges] = [0, 1].map(|k| match (size_before[k], size_after[k]) {
        (before, after) if before == after => grouped(after),
        (before, after) => format!("{} to {}", grouped(before), grouped(after)),
    });
    let mut out = row("network", &format!("{nodes} nodes, {edges} edges{}", changes(report)));
    let iterations = report.history.last().map_or(0, |sample| sample.iteration);
    let radius = 0.448 * report.unit;
    let moved = match report.chosen {
        None => "nothing: no state satisfies --hold".into(),
        Some(_) if d.max == 0.0 => "nothing".into(),
        Some(best) => {
            let [median, most, radius] = [d.median, d.max, radius].map(number);
            format!("median {median}, max {most} (median radius {radius}); iteration {best} of {iterations}")
        }
    };
    out += &row("moved", &moved);
    let (before, after) = (grouped(given.overlaps), counted(result.overlaps, "pair"));
    out += &row("overlaps", &format!("{after} ({before} before; -v shows all figures)"));
    let [before, after] = [given, result].map(|figures| share(figures.metrics.cuttable.percent() / 100.0));
    out += &row("cuts", &format!("{after} of inner branches are long enough ({before} before)"));
    if !report.worse.is_empty() {
        out += &row("worse", &format!("{} (--hold prevents it)", report.worse_names()));
    }
    report.write_crowded(SPELT_OUT, name, &mut out);
    report.write_buried(SPELT_OUT, name, &mut out);
    if !report.residual.pairs.is_empty() {
        report.write_residual(SPELT_OUT, name, &mut out);
    }
    out += fidelity;
    out + &ended.rows(&[])
}

/// Number of split nodes and added bends, if any.
fn changes(report: &RefineReport) -> String {
    let of = |count, what: &str| if count > 0 { Some(format!("{} {what}", grouped(count))) } else { None };
    let all: Vec<String> =
        [of(report.nodes_split, "split"), of(report.bends, "added in bends")].into_iter().flatten().collect();
    if all.is_empty() { String::new() } else { format!("; {}", all.join(", ")) }
}

/// The metrics over the iterations as a table.
pub fn csv(report: &RefineReport) -> String {
    let mut out = String::from(
        "iteration,displacement_mean,displacement_median,displacement_p95,displacement_p99,displacement_max,\
         barrier_potential,percent_shorter_than_2r,percent_shorter_than_2.5r,percent_shorter_than_3r,\
         percent_angles_under_pi/10,percent_folds,percent_equation_11,percent_equation_12,percent_cuttable\n",
    );
    for s in &report.history {
        let (d, m) = (&s.displacement, &s.metrics);
        let shares = [
            m.shorter_than_2,
            m.shorter_than_2_5,
            m.shorter_than_3,
            m.narrow,
            m.folds,
            m.long_enough,
            m.open_enough,
            m.cuttable,
        ];
        let _ = write!(out, "{},{},{},{},{},{},{}", s.iteration, d.mean, d.median, d.p95, d.p99, d.max, m.barrier);
        for share in shares {
            let _ = write!(out, ",{}", share.percent());
        }
        out.push('\n');
    }
    out
}

/// Four panels as in Fig. 11 of the paper.
pub fn panels(report: &RefineReport) -> Vec<Panel> {
    let line = |label: &str, value: fn(&HistorySample) -> f64| Series {
        label: label.into(),
        points: report.history.iter().map(|s| [s.iteration as f64, value(s)]).collect(),
    };
    let panel = |title: &str, vertical: &str, logarithmic: bool, series: Vec<Series>| Panel {
        title: title.into(),
        axes: ["iteration".into(), vertical.into()],
        logarithmic,
        bars: None,
        series,
    };
    vec![
        panel(
            "A  Displacement of the nodes",
            "displacement (unit of the network)",
            false,
            vec![
                line("mean", |s| s.displacement.mean),
                line("median", |s| s.displacement.median),
                line("95 %", |s| s.displacement.p95),
                line("99 %", |s| s.displacement.p99),
                line("largest", |s| s.displacement.max),
            ],
        ),
        panel("B  Barrier potential", "potential (no unit)", true, vec![line("all pairs", |s| s.metrics.barrier)]),
        panel(
            "C  Short edges",
            "edges (%)",
            false,
            vec![
                line("shorter than 2.5 radii", |s| s.metrics.shorter_than_2_5.percent()),
                line("shorter than 3 radii", |s| s.metrics.shorter_than_3.percent()),
            ],
        ),
        panel(
            "D  Narrow angles",
            "pairs of edges at a node (%)",
            false,
            vec![line("under \u{3c0}/10", |s| s.metrics.narrow.percent())],
        ),
    ]
}
