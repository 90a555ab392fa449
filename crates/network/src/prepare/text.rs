//! Report of the cures as text for people.

use std::fmt::Write as _;

use super::{PrepareReport, RadiusDefect, Size, SpurReason, TouchedBy, TouchingTip};
use anastomesh_mesh::units::grouped;

/// A line of the table of sizes.
type Row = (&'static str, fn(&Size) -> usize);

/// Cases of one cure that the long text lists.
const LISTED: usize = 20;
/// Cases of one cure that the short text lists.
const SPELT_OUT: usize = 3;

impl PrepareReport {
    /// Text for people: up to 3 cases of each cure; with `all`, up to 20 and a table of sizes.
    pub fn text(&self, all: bool) -> String {
        let mut out = Lists { text: String::new(), listed: if all { LISTED } else { SPELT_OUT } };
        let filled = self.radii.iter().map(|r| {
            let was = r.given.map_or_else(|| "no number".into(), |g| format!("{g:.4}"));
            let why =
                if r.fault == RadiusDefect::Absurd { " (its neighbours' are ten times more or less)" } else { "" };
            format!("{}: {was}, now {:.4}{why}", r.node, r.filled)
        });
        out.list("radii filled from neighbours (--keep-radii)", filled);
        for (count, what) in self.cleaned.counts() {
            let _ = writeln!(out.text, "{} {what}", grouped(count));
        }
        merged(self, &mut out);
        let spurs = self.spurs.iter().map(|s| {
            let why = match s.reason {
                SpurReason::Short => "no longer than its vessel's radius",
                SpurReason::Inside => "its tip lies within its vessel",
            };
            format!("{} from {}: length {:.4}, radius {:.4}: {why}", s.tip, s.from, s.length, s.radius)
        });
        out.list("spurs taken off (--keep-spurs)", spurs);
        let joined = self
            .joined
            .nodes
            .iter()
            .map(|j| format!("{} into {}: {:.4} apart, radius {:.4}", j.node, j.into, j.distance, j.radius));
        out.list("branch points joined within one lumen (--keep-joints)", joined);
        let loops =
            self.joined.loops.iter().map(|l| format!("{} to {}: length {:.4}", l.nodes[0], l.nodes[1], l.length));
        out.list("loops closed within their own lumen (--keep-joints)", loops);
        let short = self.short_tips.iter().map(|t| {
            let done = if t.put_out { "put out" } else { "taken off, as it is too short by far" };
            format!("{} from {}: length {:.4}, its cap is clear at {:.4}: {done}", t.tip, t.from, t.length, t.needed)
        });
        out.list("tips too close to their branch point for a cap (--keep-short-tips)", short);
        out.touching(&self.touching);
        let islands = self.islands.iter().map(|i| format!("at {}: {} nodes, length {:.4}", i.node, i.nodes, i.length));
        out.list("islands dropped (--drop-islands)", islands);
        let r = &self.resample;
        if r.before > 0 {
            let _ = writeln!(
                out.text,
                "resampled: {} nodes to {}; the axis moved by {:.4} radii at most, radii changed by {:.2} % at most \
                 (--keep-points)",
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

/// Text for people on tips that end in or on another vessel.
pub fn touching_text(tips: &[TouchingTip]) -> String {
    let mut out = Lists { text: String::new(), listed: SPELT_OUT };
    out.touching(tips);
    out.text
}

/// Cures and their cases, of which so many are spelt out.
struct Lists {
    text: String,
    listed: usize,
}

impl Lists {
    /// A heading with the number of cases, and the first of them.
    fn list(&mut self, what: &str, cases: impl ExactSizeIterator<Item = String>) {
        let count = cases.len();
        if count == 0 {
            return;
        }
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{} {what}", grouped(count));
        for case in cases.take(self.listed) {
            let _ = writeln!(self.text, "  {case}");
        }
        if count > self.listed {
            let more = if self.listed < LISTED { "-v lists more, " } else { "" };
            let _ = writeln!(self.text, "  and {} more ({more}--json all)", grouped(count - self.listed));
        }
    }

    fn touching(&mut self, tips: &[TouchingTip]) {
        let tips = tips.iter().map(|t| {
            let done = match t.done {
                TouchedBy::Retracted { by } => format!("drawn back by {by:.4}"),
                TouchedBy::Joined => "joined".into(),
                TouchedBy::Removed => "taken off, as no room for a cap is left on its vessel".into(),
                TouchedBy::Left => "left, as its vessel runs along the other".into(),
            };
            format!("{} at {}-{}: {done}", t.tip, t.with[0], t.with[1])
        });
        self.list("tips that end in or on another vessel (--touching)", tips);
    }
}

fn merged(report: &PrepareReport, out: &mut Lists) {
    let met = report.merge.met.iter().map(|[a, b]| format!("{a} and {b}"));
    out.list("pairs of tips at one place but for rounding made one (--keep-doubles)", met);
    let stretches = report.merge.merged.iter().map(|m| {
        let partings: String =
            m.partings.iter().map(|p| format!("; parts at {}, leaves the tube at {}", p.branches, p.leaves)).collect();
        format!(
            "{} to {} ran with {}-{}: length {:.4}, {:.3} radii apart at most{partings}",
            m.nodes[0], m.nodes[1], m.with[0], m.with[1], m.length, m.apart
        )
    });
    out.list("stretches that ran together with another line merged (--keep-doubles)", stretches);
    if report.merge.gave_up {
        out.text.push_str("so many lines lie upon each other that not all were looked at\n");
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
