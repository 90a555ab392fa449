//! Text report of a refinement.

use std::fmt::{self, Write as _};

use super::{Figures, RefineReport, Treatment};
use crate::names::NameOf;
use anastomesh_mesh::units::{counted, grouped};

/// Row of the table of figures: its name and its text for one state.
type Row = (&'static str, fn(&Figures) -> String);

/// Maximum number of listed pairs.
const LISTED: usize = 50;

/// Summary and table of figures; nodes are named by their index in the input.
impl fmt::Display for RefineReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text(&|node| node.to_string()))
    }
}

fn text(report: &RefineReport, name: NameOf) -> String {
    let mut out = String::new();
    let d = &report.displacement;
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "nodes: {} to {} ({} split, {} added in bends); edges: {} to {}",
        report.size_before[0],
        report.size_after[0],
        report.nodes_split,
        report.bends,
        report.size_before[1],
        report.size_after[1]
    );
    let iterations = report.history.last().map_or(0, |s| s.iteration);
    let best = match report.chosen {
        Some(iteration) => format!("best after {}", counted(iteration, "iteration")),
        None => "no state satisfies --hold: nothing was moved".into(),
    };
    let _ = writeln!(
        out,
        "displacement after {} ({best}): mean {:.4}, median {:.4}, 95 % {:.4}, 99 % {:.4}, max {:.4} (median radius {:.4})",
        counted(iterations, "iteration"),
        d.mean,
        d.median,
        d.p95,
        d.p99,
        d.max,
        0.448 * report.unit
    );
    let _ = writeln!(out, "{:26}{:>12}{:>12}{:>12}{:>12}", "", "given", "split", "moved", "result");
    for row in report.figures_table() {
        let [name, values @ ..] = &row[..] else { continue };
        let _ = write!(out, "{name:26}");
        for value in values {
            let _ = write!(out, "{value:>12}");
        }
        out.push('\n');
    }
    if report.gave_up {
        let _ = writeln!(out, "ended early: too many vessels are close to each other");
    }
    if !report.worse.is_empty() {
        let _ = writeln!(out, "worse than the input in: {} (--hold prevents it)", report.worse_names());
    }
    report.write_crowded(LISTED, name, &mut out);
    report.write_buried(LISTED, name, &mut out);
    report.write_residual(LISTED, name, &mut out);
    out
}

impl RefineReport {
    /// Summary and table of figures. `name` names a node, given by its index in the input.
    pub fn text(&self, name: NameOf) -> String {
        text(self, name)
    }

    /// Names of the metrics that are worse than in the input, with commas between them.
    pub fn worse_names(&self) -> String {
        self.worse.iter().map(|m| m.name()).collect::<Vec<_>>().join(", ")
    }

    /// Table of figures: the name of each, and its values as given, after splitting, after moving, and at the end.
    pub fn figures_table(&self) -> Vec<Vec<String>> {
        let states = [&self.given, &self.split, &self.moved, &self.result];
        let rows: [Row; 13] = [
            ("overlapping pairs", |f| grouped(f.overlaps)),
            ("  with a common node", |f| grouped(f.beside)),
            ("unconnected pairs", |f| grouped(f.unconnected)),
            ("  distant along vessels", |f| grouped(f.far)),
            ("barrier potential", |f| format!("{:.4e}", f.metrics.barrier)),
            ("shorter than 2 r", |f| percent(f.metrics.shorter_than_2.percent())),
            ("shorter than 2.5 r", |f| percent(f.metrics.shorter_than_2_5.percent())),
            ("shorter than 3 r", |f| percent(f.metrics.shorter_than_3.percent())),
            ("angles under pi/10", |f| percent(f.metrics.narrow.percent())),
            ("folds under 30 degrees", |f| percent(f.metrics.folds.percent())),
            ("equation 11 met", |f| percent(f.metrics.long_enough.percent())),
            ("equation 12 met", |f| percent(f.metrics.open_enough.percent())),
            ("cuttable inner branches", |f| percent(f.metrics.cuttable.percent())),
        ];
        let row = |(name, value): Row| [vec![name.to_owned()], states.map(value).to_vec()].concat();
        rows.into_iter().map(row).collect()
    }

    /// Appends the pairs of terminals that are too close to each other, at most `listed` of them one by one.
    pub fn write_crowded(&self, listed: usize, name: NameOf, out: &mut String) {
        if self.crowded.is_empty() {
            return;
        }
        let _ = writeln!(out, "{} too close for two caps", counted(self.crowded.len(), "terminal pair"));
        for pair in self.crowded.iter().take(listed) {
            let [a, b] = pair.nodes.map(name);
            let done = match (pair.resolved, pair.moved) {
                (false, _) => "kept; the mesh will lack a cap (--crowded-terminals part or merge)".into(),
                (true, [a, b]) if a + b == 0.0 => "merged".into(),
                (true, [a, b]) => format!("moved by {a:.4} and {b:.4} (--crowded-terminals)"),
            };
            let _ = writeln!(
                out,
                "  nodes {a} and {b}: distance {:.4}, sum of radii {:.4}: {done}",
                pair.distance, pair.radii
            );
        }
        unlisted(self.crowded.len(), listed, out);
    }

    /// Appends the terminals inside another vessel of their bifurcation, at most `listed` of them one by one.
    pub fn write_buried(&self, listed: usize, name: NameOf, out: &mut String) {
        if self.buried.is_empty() {
            return;
        }
        let _ = writeln!(out, "{} inside another vessel of its bifurcation", counted(self.buried.len(), "terminal"));
        for tip in self.buried.iter().take(listed) {
            let ([a, b], node) = (tip.edge.map(name), name(tip.node));
            let done = if tip.resolved {
                format!("turned away, by {:.4} (--crowded-terminals)", tip.moved)
            } else {
                "kept; the mesh will lack a cap (--crowded-terminals part)".into()
            };
            let _ = writeln!(
                out,
                "  node {node} in edge {a}-{b}: distance {:.4}, sum of radii {:.4}: {done}",
                tip.distance, tip.radii
            );
        }
        unlisted(self.buried.len(), listed, out);
    }

    /// Appends the overlaps that remain, at most `listed` of them one by one.
    pub fn write_residual(&self, listed: usize, name: NameOf, out: &mut String) {
        let r = &self.residual;
        if r.pairs.is_empty() {
            out.push_str("no vessels overlap\n");
            return;
        }
        let lost = if r.volume > 0.0 { 100.0 * r.volume_lost / r.volume } else { 0.0 };
        let _ = writeln!(
            out,
            "{} after moving; {} shrunk ({lost:.4} % of the lumen); {} left",
            counted(r.pairs.len(), "overlapping pair"),
            counted(r.shrunk_edges, "edge"),
            counted(r.left, "overlapping pair")
        );
        for pair in r.pairs.iter().take(listed) {
            let [[a, b], [c, d]] = pair.edges.map(|ends| ends.map(name));
            let done = match pair.treatment {
                Treatment::Shrunk { kept } => format!("shrunk to {:.0} %", 100.0 * kept),
                Treatment::Cleared => "resolved by other changes".into(),
                Treatment::Fused => "to be meshed as one lumen".into(),
                Treatment::Left if pair.terminals_too_close => {
                    "kept: their terminals are too close (--crowded-terminals part)".into()
                }
                Treatment::Left => "kept".into(),
            };
            let _ = writeln!(
                out,
                "  edges {a}-{b} and {c}-{d}: distance {:.4}, sum of radii {:.4}: {done}",
                pair.distance, pair.radii
            );
        }
        unlisted(r.pairs.len(), listed, out);
    }
}

fn percent(value: f64) -> String {
    format!("{value:.3} %")
}

/// Appends the number of pairs that are not listed.
fn unlisted(count: usize, listed: usize, out: &mut String) {
    if count > listed {
        let _ = writeln!(out, "  and {} more (--json lists all)", grouped(count - listed));
    }
}
