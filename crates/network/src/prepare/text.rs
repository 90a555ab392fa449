//! Text report of the cures.

use std::fmt::Write as _;

use super::{PrepareReport, RadiusDefect, Size, SpurReason, TouchedBy, TouchingTip};
use crate::names::NameOf;
use anastomesh_mesh::units::{counted, digits, grouped};

/// Row of the table of sizes.
type Row = (&'static str, fn(&Size) -> usize);

/// Maximum number of cases of one cure in the long text.
const LISTED: usize = 20;
/// Maximum number of cases of one cure in the short text.
const SPELT_OUT: usize = 3;

impl PrepareReport {
    /// Text report: up to 3 cases of each cure; with `all`, up to 20 and a table of sizes. `name` names a node, given by its
    /// index in the input.
    pub fn text(&self, all: bool, name: NameOf) -> String {
        let mut out = Lists { text: String::new(), listed: if all { LISTED } else { SPELT_OUT } };
        let filled = self.radii.iter().map(|r| {
            let was = r.given.map_or_else(|| "missing".into(), |g| format!("{g:.4}"));
            let why = if r.fault == RadiusDefect::Absurd { " (differs tenfold from its neighbours)" } else { "" };
            format!("node {}: {was}, now {:.4}{why}", name(r.node), r.filled)
        });
        out.list(["radius", "radii"], "interpolated from neighbours (--keep-radii)", filled);
        for change in self.cleaned.changes() {
            let _ = writeln!(out.text, "{change}");
        }
        merged(self, name, &mut out);
        let spurs = self.spurs.iter().map(|s| {
            let why = match s.reason {
                SpurReason::Short => "not longer than the radius of its vessel",
                SpurReason::Inside => "the tip lies inside its vessel",
            };
            let [tip, from] = [s.tip, s.from].map(name);
            format!("tip {tip} from node {from}: length {:.4}, radius {:.4}: {why}", s.length, s.radius)
        });
        out.list(["spur", "spurs"], "removed (--keep-spurs)", spurs);
        let joined = self.joined.nodes.iter().map(|j| {
            let [node, into] = [j.node, j.into].map(name);
            format!("node {node} into node {into}: distance {:.4}, radius {:.4}", j.distance, j.radius)
        });
        out.list(["bifurcation", "bifurcations"], "joined within one lumen (--keep-joints)", joined);
        let loops = self.joined.loops.iter().map(|l| {
            let [a, b] = l.nodes.map(name);
            format!("nodes {a} to {b}: length {:.4}", l.length)
        });
        out.list(["loop", "loops"], "closed within one lumen (--keep-joints)", loops);
        let short = self.short_tips.iter().map(|t| {
            let needed = digits(t.needed);
            let done = if t.put_out {
                format!("extended to length {needed} so that its cap clears other vessels")
            } else {
                format!("removed, as its cap needs length {needed}")
            };
            format!("tip {} from node {}: length {}: {done}", name(t.tip), name(t.from), digits(t.length))
        });
        out.list(["tip", "tips"], "too close to a bifurcation for a cap (--keep-short-tips)", short);
        out.touching(&self.touching, name);
        let islands = self
            .islands
            .iter()
            .map(|i| format!("at node {}: {}, length {:.4}", name(i.node), counted(i.nodes, "node"), i.length));
        out.list(["component", "components"], "removed (--drop-islands)", islands);
        let r = &self.resample;
        if r.before > 0 {
            let _ = writeln!(
                out.text,
                "resampled from {} to {} nodes; max axis error {:.4} radii, max radius error {:.2} % (--keep-points)",
                grouped(r.before),
                grouped(r.after),
                r.furthest,
                100.0 * r.radius
            );
        }
        if all {
            sizes(self, &mut out.text);
        }
        out.text
    }
}

/// Text on tips that touch another vessel. `name` names a node, given by its index in the input.
pub fn touching_text(tips: &[TouchingTip], name: NameOf) -> String {
    let mut out = Lists { text: String::new(), listed: SPELT_OUT };
    out.touching(tips, name);
    out.text
}

/// Text of cures with their first cases.
struct Lists {
    text: String,
    listed: usize,
}

impl Lists {
    /// A heading with the number of cases, and the first of them.
    fn list(&mut self, [one, many]: [&str; 2], what: &str, cases: impl ExactSizeIterator<Item = String>) {
        let count = cases.len();
        if count == 0 {
            return;
        }
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{} {} {what}", grouped(count), if count == 1 { one } else { many });
        for case in cases.take(self.listed) {
            let _ = writeln!(self.text, "  {case}");
        }
        if count > self.listed {
            let more = if self.listed < LISTED { "-v lists more, " } else { "" };
            let _ = writeln!(self.text, "  and {} more ({more}--json all)", grouped(count - self.listed));
        }
    }

    fn touching(&mut self, tips: &[TouchingTip], name: NameOf) {
        let tips = tips.iter().map(|t| {
            let done = match t.done {
                TouchedBy::Retracted { by } => format!("shortened by {by:.4}"),
                TouchedBy::Extended { by } => format!("extended by {by:.4}"),
                TouchedBy::Joined => "joined".into(),
                TouchedBy::Removed => "removed, as its vessel is too short for a cap".into(),
                TouchedBy::Left => "kept, as too much of its vessel would be lost".into(),
            };
            let [a, b] = t.with.map(name);
            format!("tip {} at edge {a}-{b}: {done}", name(t.tip))
        });
        self.list(["tip", "tips"], "touching another vessel (--touching)", tips);
    }
}

fn merged(report: &PrepareReport, name: NameOf, out: &mut Lists) {
    let met = report.merge.met.iter().map(|ends| {
        let [a, b] = ends.map(name);
        format!("nodes {a} and {b}")
    });
    out.list(["pair", "pairs"], "of coincident tips joined (--keep-doubles)", met);
    let stretches = report.merge.merged.iter().map(|m| {
        let partings: String = m
            .partings
            .iter()
            .map(|p| format!("; leaves at node {}, exits the vessel at node {}", name(p.branches), name(p.leaves)))
            .collect();
        let ([a, b], [c, d]) = (m.nodes.map(name), m.with.map(name));
        format!(
            "nodes {a} to {b} along edge {c}-{d}: length {:.4}, max distance {:.3} radii{partings}",
            m.length, m.apart
        )
    });
    out.list(["duplicate segment", "duplicate segments"], "merged (--keep-doubles)", stretches);
    if report.merge.gave_up {
        out.text.push_str("duplicate search incomplete: too many coincident lines\n");
    }
}

fn sizes(report: &PrepareReport, out: &mut String) {
    let _ = writeln!(out, "{:16}{:>10}{:>10}{:>10}", "", "given", "read", "result");
    let rows: [Row; 6] = [
        ("nodes", |s| s.nodes),
        ("edges", |s| s.edges),
        ("tips", |s| s.tips),
        ("branch points", |s| s.branch_points),
        ("components", |s| s.components),
        ("loops", |s| s.loops),
    ];
    for (name, value) in rows {
        let [a, b, c] = [&report.given, &report.read, &report.result].map(value).map(grouped);
        let _ = writeln!(out, "{name:16}{a:>10}{b:>10}{c:>10}");
    }
}
