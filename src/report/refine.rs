//! Reports of a refinement: text, table, plot panels.

use std::fmt::{self, Write as _};

#[cfg(feature = "cli")]
use super::plot::{Panel, Series};
#[cfg(feature = "cli")]
use super::rows::{Ended, row};
#[cfg(feature = "cli")]
use crate::refine::Sample;
use crate::refine::{Figures, RefineReport, Treatment};
use anastomesh_mesh::units::grouped;
#[cfg(feature = "cli")]
use anastomesh_mesh::units::{number, percent as share};

/// Row of the figures table: name, and value for a state.
type Row = (&'static str, fn(&Figures) -> String);

/// Maximum number of listed pairs.
const LISTED: usize = 50;
/// Maximum number of listed pairs in a summary.
#[cfg(feature = "cli")]
const SPELT_OUT: usize = 3;

/// Text report with a table of figures.
impl fmt::Display for RefineReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&text(self))
    }
}

fn text(report: &RefineReport) -> String {
    let mut out = String::new();
    let d = &report.displacement;
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "nodes: {} to {} ({} split, {} bends put in); edges: {} to {}",
        report.size_before[0],
        report.size_after[0],
        report.nodes_split,
        report.bends,
        report.size_before[1],
        report.size_after[1]
    );
    let iterations = report.history.last().map_or(0, |s| s.iteration);
    let best = match report.chosen {
        Some(iteration) => format!("best after {iteration}"),
        None => "none as good as the input in what was to be held: nothing was moved".into(),
    };
    let _ = writeln!(
        out,
        "moved in {iterations} iterations ({best}): mean {:.4}, median {:.4}, 95 % {:.4}, 99 % {:.4}, furthest {:.4} (a \
         median radius is {:.4})",
        d.mean,
        d.median,
        d.p95,
        d.p99,
        d.max,
        0.448 * report.unit
    );
    let _ = writeln!(out, "{:26}{:>12}{:>12}{:>12}{:>12}", "", "given", "split", "moved", "result");
    for row in figures_table(report) {
        let [name, values @ ..] = &row[..] else { continue };
        let _ = write!(out, "{name:26}");
        for value in values {
            let _ = write!(out, "{value:>12}");
        }
        out.push('\n');
    }
    if !report.worse.is_empty() {
        let _ = writeln!(out, "worse than the input in: {} (--hold prevents it)", worse(report));
    }
    crowded_text(report, LISTED, &mut out);
    residual_text(report, LISTED, &mut out);
    out
}

/// Short summary: input, displacement, remaining overlaps, output files.
#[cfg(feature = "cli")]
pub fn brief(report: &RefineReport, ended: &Ended) -> String {
    let RefineReport { size_before, size_after, displacement: d, given, result, .. } = report;
    let [nodes, edges] = [0, 1].map(|k| match (size_before[k], size_after[k]) {
        (before, after) if before == after => grouped(after),
        (before, after) => format!("{} to {}", grouped(before), grouped(after)),
    });
    let mut out = row("network", &format!("{nodes} nodes, {edges} edges{}", changes(report)));
    let iterations = report.history.last().map_or(0, |sample| sample.iteration);
    let radius = 0.448 * report.unit;
    let moved = match report.chosen {
        None => "nothing: no state is as good as the input in what is to be held (--hold)".into(),
        Some(_) if d.max == 0.0 => "nothing".into(),
        Some(best) => {
            let [median, most, radius] = [d.median, d.max, radius].map(number);
            format!(
                "by {median} in the median, {most} at most (a median radius is {radius}); best of {iterations} iterations: {best}"
            )
        }
    };
    out += &row("moved", &moved);
    let [before, after] = [given.overlaps, result.overlaps].map(grouped);
    out += &row("overlaps", &format!("pairs: {after} ({before} before)"));
    let [before, after] = [given, result].map(|figures| share(figures.metrics.cuttable.percent() / 100.0));
    out += &row("cuts", &format!("{after} of inner branches have room for one ({before} before)"));
    if !report.worse.is_empty() {
        out += &row("worse", &format!("{} (--hold prevents it)", worse(report)));
    }
    crowded_text(report, SPELT_OUT, &mut out);
    if !report.residual.pairs.is_empty() {
        residual_text(report, SPELT_OUT, &mut out);
    }
    out += &ended.rows(&[]);
    let left = match report.residual.left {
        0 => "no vessels overlap".into(),
        1 => "a pair overlaps still".into(),
        n => format!("{} pairs overlap still", grouped(n)),
    };
    out + &left + " (-v shows all figures)\n"
}

/// Number of split nodes and added bends, if any.
#[cfg(feature = "cli")]
fn changes(report: &RefineReport) -> String {
    let of = |count, what: &str| if count > 0 { Some(format!("{} {what}", grouped(count))) } else { None };
    let all: Vec<String> =
        [of(report.nodes_split, "split"), of(report.bends, "bends put in")].into_iter().flatten().collect();
    if all.is_empty() { String::new() } else { format!("; {}", all.join(", ")) }
}

fn worse(report: &RefineReport) -> String {
    report.worse.iter().map(|m| m.name()).collect::<Vec<_>>().join(", ")
}

/// Table of figures: name, and values of the input, after splitting, after moving, and of the result.
pub fn figures_table(report: &RefineReport) -> Vec<Vec<String>> {
    let states = [&report.given, &report.split, &report.moved, &report.result];
    let rows: [Row; 13] = [
        ("overlapping pairs", |f| grouped(f.overlaps)),
        ("  that share a node", |f| grouped(f.beside)),
        ("unconnected pairs", |f| grouped(f.unconnected)),
        ("  far from each other", |f| grouped(f.far)),
        ("barrier potential", |f| format!("{:.4e}", f.metrics.barrier)),
        ("shorter than 2 r", |f| percent(f.metrics.shorter_than_2.percent())),
        ("shorter than 2.5 r", |f| percent(f.metrics.shorter_than_2_5.percent())),
        ("shorter than 3 r", |f| percent(f.metrics.shorter_than_3.percent())),
        ("angles under pi/10", |f| percent(f.metrics.narrow.percent())),
        ("folds under 30 degrees", |f| percent(f.metrics.folds.percent())),
        ("equation 11 met", |f| percent(f.metrics.long_enough.percent())),
        ("equation 12 met", |f| percent(f.metrics.open_enough.percent())),
        ("inner branches cuttable", |f| percent(f.metrics.cuttable.percent())),
    ];
    let row = |(name, value): Row| [vec![name.to_owned()], states.map(value).to_vec()].concat();
    rows.into_iter().map(row).collect()
}

fn percent(value: f64) -> String {
    format!("{value:.3} %")
}

fn crowded_text(report: &RefineReport, listed: usize, out: &mut String) {
    if report.crowded.is_empty() {
        return;
    }
    let _ =
        writeln!(out, "{} pairs of terminals are too close to each other for two caps", grouped(report.crowded.len()));
    for pair in report.crowded.iter().take(listed) {
        let [a, b] = pair.nodes;
        let done = match (pair.resolved, pair.moved) {
            (false, _) => "left; the mesh will lack a cap (--crowded-terminals part or merge)".into(),
            (true, [a, b]) if a + b == 0.0 => "made one".into(),
            (true, [a, b]) => format!("moved by {a:.4} and {b:.4} (--crowded-terminals keep leaves them)"),
        };
        let _ = writeln!(out, "  {a} and {b}: {:.4} apart, radii {:.4}: {done}", pair.distance, pair.radii);
    }
    unlisted(report.crowded.len(), listed, out);
}

/// Appends the number of unlisted pairs.
fn unlisted(count: usize, listed: usize, out: &mut String) {
    if count > listed {
        let _ = writeln!(out, "  and {} more (--json lists all)", grouped(count - listed));
    }
}

fn residual_text(report: &RefineReport, listed: usize, out: &mut String) {
    let r = &report.residual;
    if r.pairs.is_empty() {
        out.push_str("no vessels overlap\n");
        return;
    }
    let lost = if r.volume > 0.0 { 100.0 * r.volume_lost / r.volume } else { 0.0 };
    let _ = writeln!(
        out,
        "{} pairs overlapped when the nodes had come to rest; {} edges were shrunk ({lost:.4} % of the lumen); {} pairs \
         overlap still",
        grouped(r.pairs.len()),
        grouped(r.shrunk_edges),
        grouped(r.left)
    );
    for pair in r.pairs.iter().take(listed) {
        let [[a, b], [c, d]] = pair.edges;
        let done = match pair.treatment {
            Treatment::Shrunk { kept } => format!("shrunk to {:.0} %", 100.0 * kept),
            Treatment::Cleared => "parted by what was done about others".into(),
            Treatment::Fused => "to be meshed together".into(),
            Treatment::Left if pair.terminals_too_close => {
                "left: their terminals are too close to each other (--crowded-terminals part)".into()
            }
            Treatment::Left => "left".into(),
        };
        let _ = writeln!(out, "  {a}-{b} and {c}-{d}: {:.4} apart, radii {:.4}: {done}", pair.distance, pair.radii);
    }
    unlisted(r.pairs.len(), listed, out);
}

/// CSV table of the metrics over the iterations.
#[cfg(feature = "cli")]
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
#[cfg(feature = "cli")]
pub fn panels(report: &RefineReport) -> Vec<Panel> {
    let line = |label: &str, value: fn(&Sample) -> f64| Series {
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
