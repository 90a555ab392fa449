//! Report of `info` on a network.

use anastomesh_flow::Inlet;
use anastomesh_mesh::geometry::Aabb;
use anastomesh_mesh::units::{counted, digits, grouped, number, percent};
use anastomesh_network::NameOf;
use anastomesh_skeleton::{CleanReport, CrowdedTerminals, Metrics, Overlaps, Share, Skeleton};
use serde::Serialize;
use std::fmt::{self, Write as _};

/// Maximum number of overlaps in the text; the JSON form lists all.
const LISTED: usize = 10;

/// Minimum, quartiles and maximum of numbers; all 0 without numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quartiles {
    /// Minimum.
    pub min: f64,
    /// First quartile.
    pub quarter: f64,
    /// Median.
    pub median: f64,
    /// Third quartile.
    pub three_quarters: f64,
    /// Maximum.
    pub max: f64,
}

impl Quartiles {
    /// Computes the quartiles of these numbers.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        let Some(last) = values.len().checked_sub(1) else {
            return Self::default();
        };
        let at = |share: f64| values[(share * last as f64).round() as usize];
        Self { min: at(0.0), quarter: at(0.25), median: at(0.5), three_quarters: at(0.75), max: at(1.0) }
    }
}

impl fmt::Display for Quartiles {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [a, b, c, d, e] = [self.min, self.quarter, self.median, self.three_quarters, self.max].map(digits);
        write!(f, "{a} .. {e} (quartiles {b}, {c}, {d})")
    }
}

/// Estimated unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum UnitGuess {
    /// m.
    Metres,
    /// mm.
    Millimetres,
    /// µm.
    Micrometres,
}

/// Plausible median radius of vessels, from capillaries to the aorta, in metres.
const MEDIAN_RADIUS: [f64; 2] = [1.5e-6, 0.015];
/// Maximum radius of a vessel, in metres.
const MAX_RADIUS: f64 = 0.02;
/// Maximum extent of a network, in metres.
const MAX_EXTENT: f64 = 2.0;

impl UnitGuess {
    const ALL: [Self; 3] = [Self::Micrometres, Self::Millimetres, Self::Metres];

    /// Number of metres, name and option value.
    fn unit(self) -> (f64, &'static str, &'static str) {
        match self {
            Self::Metres => (1.0, "m", "m"),
            Self::Millimetres => (1e-3, "mm", "mm"),
            Self::Micrometres => (1e-6, "µm", "um"),
        }
    }

    /// Units in which the sizes of a network are those of vessels.
    fn plausible(radius: &Quartiles, extent: f64) -> Vec<Self> {
        let fits = |unit: &Self| {
            let (metres, ..) = unit.unit();
            let median = radius.median * metres;
            (MEDIAN_RADIUS[0]..=MEDIAN_RADIUS[1]).contains(&median)
                && radius.max * metres <= MAX_RADIUS
                && extent * metres <= MAX_EXTENT
        };
        Self::ALL.into_iter().filter(fits).collect()
    }
}

impl fmt::Display for UnitGuess {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Metres => "metres",
            Self::Millimetres => "millimetres",
            Self::Micrometres => "micrometres",
        })
    }
}

/// Properties of a network. Lengths are in the network's unit.
///
/// ```
/// use anastomesh::io::{NetworkOptions, read_network};
/// use anastomesh::network::clean;
/// use anastomesh::testing::NetworkInfo;
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let (network, cleaned) = clean(&file.skeleton)?;
/// let info = NetworkInfo::new(&network, cleaned, Vec::new());
/// assert_eq!((info.loops, info.overlaps.pairs.len()), (0, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NetworkInfo {
    /// Decisions of the reader.
    pub notes: Vec<String>,
    /// Report of the cleaning; all other fields describe the cleaned network.
    pub cleaned: CleanReport,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of branches: chains through nodes of valence 2.
    pub branches: usize,
    /// Number of connected components.
    pub components: usize,
    /// Number of nodes in the largest component.
    pub largest_component: usize,
    /// Number of independent loops.
    pub loops: usize,
    /// Number of nodes of valence 1.
    pub terminals: usize,
    /// Number of nodes with 0, 1, 2, … edges.
    pub valences: Vec<usize>,
    /// Radii at the ends of the edges.
    pub radius: Quartiles,
    /// Lengths of the edges.
    pub edge_length: Quartiles,
    /// Edges shorter than their mean radius.
    pub edges_shorter_than_radius: usize,
    /// Lengths of the branches.
    pub branch_length: Quartiles,
    /// Length of each branch relative to its mean radius.
    pub branch_length_in_radii: Quartiles,
    /// Total length of all edges.
    pub total_length: f64,
    /// Terminals that become inlets, as far as known to the caller.
    pub inlets: Vec<Inlet>,
    /// Lowest and highest coordinates of the nodes.
    pub bounding_box: [[f64; 3]; 2],
    /// Units of length in which the sizes are those of vessels.
    pub plausible_units: Vec<UnitGuess>,
    /// Unit of length stated by the caller.
    pub unit: Option<String>,
    /// Nodes without a usable radius in the file; the other fields describe the network with these filled.
    pub nodes_without_radius: usize,
    /// True if vessels are polylines, so that `mesh` prepares the network first.
    pub measured: bool,
    /// Suitability for meshing.
    pub metrics: Metrics,
    /// Overlapping vessels.
    pub overlaps: Overlaps,
    /// Terminals that are too close for two caps.
    pub crowded_terminals: Vec<CrowdedTerminals>,
}

impl NetworkInfo {
    /// Analyses a cleaned network; `notes` are included unchanged.
    pub fn new(skeleton: &Skeleton, cleaned: CleanReport, notes: Vec<String>) -> Self {
        let adjacency = skeleton.adjacency();
        let components = skeleton.components(&adjacency).list;
        let branches = skeleton.branches(&adjacency);
        let metrics = skeleton.metrics(&adjacency);
        let branches = branches.list;
        let mut valences = Vec::new();
        for node in skeleton.node_ids() {
            let valence = adjacency.valence(node);
            valences.resize(valences.len().max(valence + 1), 0);
            valences[valence] += 1;
        }
        let lengths: Vec<f64> = skeleton.edge_ids().map(|e| skeleton.length(e)).collect();
        let short = skeleton.edges.iter().zip(&lengths).filter(|(e, length)| **length < e.mean_radius()).count();
        let aabb = Aabb::of_points(skeleton.nodes.iter().map(|n| &n.position));
        let radius = Quartiles::of(skeleton.edges.iter().flat_map(|e| e.radii).collect());
        Self {
            notes,
            cleaned,
            nodes: skeleton.nodes.len(),
            edges: skeleton.edges.len(),
            branches: branches.len(),
            components: components.len(),
            largest_component: components.iter().map(|c| c.nodes.len()).max().unwrap_or(0),
            loops: components.iter().map(anastomesh_skeleton::Component::loops).sum(),
            terminals: valences.get(1).copied().unwrap_or(0),
            valences,
            radius,
            edges_shorter_than_radius: short,
            branch_length: Quartiles::of(branches.iter().map(anastomesh_skeleton::Branch::length).collect()),
            branch_length_in_radii: Quartiles::of(
                branches.iter().map(|b| b.length() / b.mean_radius(skeleton)).collect(),
            ),
            inlets: Vec::new(),
            total_length: lengths.iter().sum(),
            edge_length: Quartiles::of(lengths),
            bounding_box: [aabb.min.into(), aabb.max.into()],
            plausible_units: UnitGuess::plausible(&radius, aabb.diagonal()),
            unit: None,
            nodes_without_radius: 0,
            measured: skeleton.is_measured(),
            metrics,
            overlaps: skeleton.overlaps(&adjacency),
            crowded_terminals: skeleton.crowded_terminals(&adjacency),
        }
    }

    fn write_cleaning(&self, f: &mut String) -> fmt::Result {
        for change in self.cleaned.changes() {
            writeln!(f, "cleaned: {change}")?;
        }
        Ok(())
    }

    fn write_metrics(&self, f: &mut String) -> fmt::Result {
        let m = &self.metrics;
        let percent = |share: Share| percent(share.percent() / 100.0);
        writeln!(f, "barrier potential: {}", digits(m.barrier))?;
        let short = [m.shorter_than_2, m.shorter_than_2_5, m.shorter_than_3].map(percent);
        writeln!(f, "edges shorter than 2, 2.5, 3 radii: {}", short.join(", "))?;
        writeln!(f, "pairs of edges at a node under pi/10: {} ({})", grouped(m.narrow.count), percent(m.narrow))?;
        writeln!(f, "folds at nodes (angle under 30 degrees): {} of {}", grouped(m.folds.count), grouped(m.folds.of))?;
        writeln!(
            f,
            "edges that satisfy equation 11: {}, equation 12: {}",
            percent(m.long_enough),
            percent(m.open_enough)
        )?;
        writeln!(f, "inner branches long enough for a cut: {} of {}", grouped(m.cuttable.count), grouped(m.cuttable.of))
    }

    fn write_overlaps(&self, name: NameOf, f: &mut String) -> fmt::Result {
        let all = &self.overlaps.pairs;
        let beside = all.iter().filter(|o| o.shares_node()).count();
        writeln!(f, "overlaps: {}, of which {} share a node", counted(all.len(), "edge pair"), grouped(beside))?;
        for o in all.iter().take(LISTED) {
            let [[a, b], [c, d]] = o.nodes.map(|ends| ends.map(|n| name(n.0)));
            let at = <[f64; 3]>::from(nalgebra::center(&o.points[0], &o.points[1])).map(digits).join(" ");
            let (distance, radii) = (digits(o.distance), digits(o.radii));
            writeln!(f, "  {a}-{b} and {c}-{d}: distance {distance}, sum of radii {radii}, at {at}")?;
        }
        if all.len() > LISTED {
            writeln!(f, "  and {} more (--json lists all)", grouped(all.len() - LISTED))?;
        }
        let [met, far] = [self.overlaps.unconnected.len(), self.overlaps.far].map(grouped);
        writeln!(
            f,
            "          edge pairs without a common node that touch: {met}, of which {far} are distant along the vessels"
        )?;
        if !self.overlaps.complete {
            writeln!(f, "          (incomplete: too many pairs to test all)")?;
        }
        Ok(())
    }

    fn write_crowded(&self, name: NameOf, f: &mut String) -> fmt::Result {
        let all = &self.crowded_terminals;
        writeln!(f, "terminals closer than the sum of their radii: {}", counted(all.len(), "pair"))?;
        for CrowdedTerminals { nodes: [a, b], distance, radii } in all.iter().take(LISTED) {
            writeln!(
                f,
                "  {} and {}: distance {}, sum of radii {}",
                name(a.0),
                name(b.0),
                digits(*distance),
                digits(*radii)
            )?;
        }
        if all.len() > LISTED {
            writeln!(f, "  and {} more (--json lists all)", grouped(all.len() - LISTED))?;
        }
        Ok(())
    }
}

/// Text report; nodes are named by their index in the cleaned network.
impl fmt::Display for NetworkInfo {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text(&|node| node.to_string()))
    }
}

impl NetworkInfo {
    /// Text report. `name` names a node, given by its index in the cleaned network.
    pub fn text(&self, name: NameOf) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(name, &mut out);
        out
    }

    fn write_unit(&self, f: &mut String) -> fmt::Result {
        if let Some(unit) = &self.unit {
            return writeln!(f, "unit: {unit} (--units)");
        }
        let as_unit = |guess: &UnitGuess| {
            let (_, symbol, option) = guess.unit();
            format!("{guess} (median radius {} {symbol}, --units {option})", number(self.radius.median))
        };
        let units: Vec<String> = self.plausible_units.iter().map(as_unit).collect();
        match &units[..] {
            [] => writeln!(f, "unit: not in the file; no usual unit gives sizes of vessels; check the radii"),
            [unit] => writeln!(f, "unit: not in the file; the sizes are those of vessels in {unit}"),
            units => writeln!(f, "unit: not in the file; the sizes are those of vessels in {}", units.join(" or ")),
        }
    }

    fn write_repairs(&self, f: &mut String) -> fmt::Result {
        if self.nodes_without_radius > 0 {
            let nodes = counted(self.nodes_without_radius, "node");
            let them = if self.nodes_without_radius == 1 { "it from its" } else { "them from their" };
            writeln!(f, "repairs: {nodes} with a missing or implausible radius; `mesh` fills {them} neighbours")?;
        }
        if self.measured {
            writeln!(
                f,
                "repairs: vessels are polylines; `mesh` repairs the network first, `prepare` shows the repairs"
            )?;
        }
        Ok(())
    }

    fn write(&self, name: NameOf, f: &mut String) -> fmt::Result {
        for note in &self.notes {
            writeln!(f, "read: {note}")?;
        }
        self.write_cleaning(f)?;
        writeln!(f, "nodes: {} ({})", grouped(self.nodes), counted(self.terminals, "terminal"))?;
        let noun = if self.branches == 1 { "branch" } else { "branches" };
        writeln!(f, "edges: {} in {} {noun}", grouped(self.edges), grouped(self.branches))?;
        let [components, largest] = [self.components, self.largest_component].map(grouped);
        writeln!(f, "components: {components} (the largest has {largest} nodes)")?;
        writeln!(f, "loops: {}", grouped(self.loops))?;
        let present = self.valences.iter().enumerate().filter(|(_, count)| **count > 0);
        let valences: Vec<String> = present.map(|(valence, count)| format!("{valence}: {}", grouped(*count))).collect();
        writeln!(f, "nodes by number of edges: {}", valences.join(", "))?;
        writeln!(f, "radius: {}", self.radius)?;
        writeln!(
            f,
            "edge length: {}; shorter than the radius: {}",
            self.edge_length,
            grouped(self.edges_shorter_than_radius)
        )?;
        writeln!(f, "branch length: {}", self.branch_length)?;
        writeln!(f, "branch length in radii: {}", self.branch_length_in_radii)?;
        writeln!(f, "total length: {}", digits(self.total_length))?;
        let [low, high] = self.bounding_box.map(|p| p.map(digits).join(" "));
        writeln!(f, "bounding box: {low} to {high}")?;
        self.write_unit(f)?;
        self.write_repairs(f)?;
        self.write_metrics(f)?;
        self.write_overlaps(name, f)?;
        self.write_crowded(name, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Point3;
    use anastomesh_skeleton::{Edge, Node, NodeId, clean};

    /// A trunk of two edges with a ring of three at its end, and a separate vessel that crosses the trunk.
    fn network() -> Skeleton {
        let points = [[0, 0, 0], [1, 0, 0], [9, 0, 0], [20, 9, 0], [20, -9, 0], [4, -9, 1], [4, 9, 1]];
        let node = |(i, p): (usize, &[i8; 3])| Node {
            position: Point3::from(p.map(f64::from)),
            radius: 2.0,
            original: i as u32,
        };
        let edge = |&(a, b): &(u32, u32)| Edge { nodes: [NodeId(a), NodeId(b)], radii: [2.0; 2] };
        let ends = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 2), (5, 6), (6, 5)];
        Skeleton { nodes: points.iter().enumerate().map(node).collect(), edges: ends.iter().map(edge).collect() }
    }

    #[test]
    fn counts_and_spreads() {
        let (skeleton, report) = clean(&network()).unwrap();
        let info = NetworkInfo::new(&skeleton, report, vec!["a note".into()]);
        assert_eq!((info.nodes, info.edges, info.branches, info.components), (7, 6, 3, 2));
        assert_eq!((info.loops, info.terminals, info.largest_component), (1, 3, 5));
        assert_eq!(info.valences, [0, 3, 3, 1]);
        assert_eq!(info.edges_shorter_than_radius, 1);
        assert_eq!(info.bounding_box, [[0.0, -9.0, 0.0], [20.0, 9.0, 1.0]]);
        // A radius of 2 is that of a capillary in micrometres, and of an artery in millimetres.
        assert_eq!(info.plausible_units, [UnitGuess::Micrometres, UnitGuess::Millimetres]);
        assert_eq!(info.overlaps.pairs.iter().filter(|o| !o.shares_node()).count(), 2);
        let text = info.to_string();
        assert!(text.contains("read: a note\ncleaned: 1 repeated edge removed\nnodes: 7 (3 terminals)\n"), "{text}");
        let unit = "unit: not in the file; the sizes are those of vessels in micrometres (median radius 2 µm, --units um) or \
                    millimetres (median radius 2 mm, --units mm)\n";
        assert!(text.contains(unit), "{text}");
        let named = NetworkInfo { nodes_without_radius: 3, ..info.clone() }.text(&|node| format!("n{node}"));
        assert!(named.contains("repairs: 3 nodes with a missing or implausible radius"), "{named}");
        assert!(named.contains("  n0-n1 and n5-n6: ") || named.contains("  n1-n2 and n5-n6: "), "{named}");
        let json = serde_json::to_value(&info).unwrap();
        assert_eq!(json["loops"], 1);
        assert_eq!(json["overlaps"]["pairs"][0]["points"][0].as_array().map(Vec::len), Some(3));
    }

    #[test]
    fn spread_of_few_and_many() {
        assert_eq!(Quartiles::of(Vec::new()), Quartiles::default());
        let spread = Quartiles::of((0..=100).rev().map(f64::from).collect());
        assert_eq!(spread, Quartiles { min: 0.0, quarter: 25.0, median: 50.0, three_quarters: 75.0, max: 100.0 });
    }
}
