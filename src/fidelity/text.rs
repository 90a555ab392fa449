//! Text report of fidelity, one row for each measure.

use super::{Change, Changes, Fidelity, RadiusReference};
use anastomesh_mesh::units::{counted, grouped, number};
use anastomesh_network::NameOf;
use std::fmt;

/// Number of radii, to a thousandth.
fn radii(x: f64) -> String {
    match x {
        x if x >= 100.0 => grouped(x.round() as usize),
        x if x >= 10.0 => format!("{x:.1}"),
        x if x >= LEAST => format!("{x:.3}"),
        _ => "0".into(),
    }
}

/// Smallest number of radii that is not printed as 0.
const LEAST: f64 = 0.0005;

/// Percentage with two digits.
pub fn share(x: f64) -> String {
    match (100.0 * x).abs() {
        p if p >= 1e6 => format!("{p:.1e} %"),
        p if p >= 100.0 => format!("{} %", grouped(p.round() as usize)),
        p => format!("{p:.1} %"),
    }
}

impl Fidelity {
    /// Rows with label and text: axis, section radius, lumen. `name` names a node. A measure that cannot be computed gives
    /// the reason.
    pub fn rows(&self, name: NameOf) -> [(&'static str, String); 3] {
        [("axis", self.axis_text(name)), ("radius", self.radius_text()), ("lumen", self.lumen_text())]
    }

    fn axis_text(&self, name: NameOf) -> String {
        let spread = &self.axis.spread;
        if spread.count == 0 || !spread.worst.is_finite() {
            return "cannot be compared: a network without vessels".into();
        }
        let [median, p99, worst] = [spread.median, spread.p99, spread.worst].map(radii);
        let node = self.axis.place.filter(|_| spread.worst >= LEAST);
        let at = node.map_or_else(String::new, |place| format!(" at node {}", name(place.node)));
        format!("displaced by median {median} radii, 99 % {p99}, max {worst}{at}")
    }

    fn radius_text(&self) -> String {
        let spread = &self.radius.spread;
        if spread.count == 0 || !spread.worst.is_finite() {
            return "cannot be compared: no point of the wall is near a vessel".into();
        }
        let [median, p99, worst] = [spread.median, spread.p99, spread.worst].map(share);
        let of = match self.radius.of {
            RadiusReference::Given | RadiusReference::Network => "",
            RadiusReference::Moved => " (against the meshed vessels, as some were moved or dropped)",
        };
        format!("section error median {median}, 99 % {p99}, max {worst}{of}")
    }

    fn lumen_text(&self) -> String {
        if self.lumen <= 0.0 || !self.lumen.is_finite() || !self.volume.is_finite() {
            return "cannot be compared: the given network has no volume".into();
        }
        let [volume, given] = [self.volume, self.lumen].map(number);
        let sign = if self.swelling() < 0.0 { '-' } else { '+' };
        format!("volume {volume}, given network {given} ({sign}{})", share(self.swelling()))
    }
}

/// Rows in which nodes are named by their index in the file, and the lengths of both axes.
impl fmt::Display for Fidelity {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        for (label, text) in self.rows(&|node| node.to_string()) {
            writeln!(out, "{label}: {text}")?;
        }
        out.write_str(&self.lengths())
    }
}

impl Fidelity {
    /// Line with the lengths of both axes.
    pub fn lengths(&self) -> String {
        let [meshed, given] = [self.axis.meshed_length, self.axis.given_length].map(number);
        format!("length of the axis {meshed}, given network {given}\n")
    }
}

impl Changes {
    /// Text with the number of changes of each kind, and the largest.
    pub fn text(&self, name: NameOf) -> String {
        let kind = |change: Option<Change>, noun: &str, done: &str, size: &dyn Fn(f64) -> String| {
            let Change { count, worst, node } = change?;
            let size = size(worst);
            Some(format!("{} {done}, most at node {} ({size})", counted(count, noun), name(node)))
        };
        let in_radii = |x: f64| format!("{} radii", radii(x));
        let parts = [
            kind(self.moved, "node", "moved", &in_radii),
            kind(self.shrunk, "pair", "shrunk", &|x| format!("by {}", share(x))),
            kind(self.filled, "radius value", "filled", &|x| number(x)),
            kind(self.extended, "tip", "extended", &|x| format!("by {} of its vessel", share(x))),
            kind(self.merged, "line", "merged with others", &|x| format!("{} apart", in_radii(x))),
            kind(self.joined, "bifurcation", "joined within one lumen", &|x| format!("distance {}", number(x))),
            kind(self.one_lumen, "block", "with overlapping vessels in one lumen", &|x| counted(x as usize, "node")),
            kind(self.fused, "loop", "fused within one lumen", &|x| format!("length {}", number(x))),
            kind(self.dropped, "vessel", "dropped or shortened", &|x| format!("{} radii outside the lumen", radii(x))),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { "nothing moved, shrunk, fused or dropped".into() } else { parts.join("; ") }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Displaced, Displacements, SectionErrors, Spread};
    use super::*;

    fn name(node: u32) -> String {
        format!("n{node}")
    }

    #[test]
    fn each_measure_is_a_row_with_its_worst_place() {
        let place = Displaced { given: [3, 4], node: 4, place: [0.0; 3], meshed: [3, 4], radii: 0.68 };
        let spread = Spread { count: 9, median: 0.0, p99: 0.351, worst: 0.68 };
        let axis = Displacements { spread, place: Some(place), ..Displacements::default() };
        let radius = SectionErrors {
            spread: Spread { count: 9, median: 0.022, p99: 0.064, worst: 12.5 },
            of: RadiusReference::Given,
        };
        let fidelity = Fidelity { axis, radius, lumen: 200.0, volume: 150.0, ..Fidelity::default() };
        let [axis, radius, lumen] = fidelity.rows(&name).map(|(_, text)| text);
        assert_eq!(axis, "displaced by median 0 radii, 99 % 0.351, max 0.680 at node n4");
        assert_eq!(radius, "section error median 2.2 %, 99 % 6.4 %, max 1,250 %");
        assert_eq!(lumen, "volume 150, given network 200 (-25.0 %)");
    }

    #[test]
    fn a_measure_that_cannot_be_computed_gives_the_reason() {
        let rows = Fidelity::default().rows(&name);
        assert!(rows.iter().all(|(_, text)| text.starts_with("cannot be compared: ")), "{rows:?}");
    }

    #[test]
    fn changes_are_counted_with_the_largest() {
        assert_eq!(Changes::default().text(&name), "nothing moved, shrunk, fused or dropped");
        let moved = Some(Change { count: 27, worst: 1.8, node: 16 });
        let dropped = Some(Change { count: 1, worst: 16.0, node: 3 });
        let changes = Changes { moved, dropped, ..Changes::default() };
        let expected = "27 nodes moved, most at node n16 (1.800 radii); \
                        1 vessel dropped or shortened, most at node n3 (16.0 radii outside the lumen)";
        assert_eq!(changes.text(&name), expected);
    }
}
