//! Report of `info` on a network.

use crate::pipeline::Inlet;
use anastomesh_mesh::geometry::Aabb;
use anastomesh_mesh::units::{counted, digits, grouped, percent};
use anastomesh_skeleton::{CleanReport, CrowdedTerminals, Metrics, Overlaps, Share, Skeleton};
use serde::Serialize;
use std::fmt;

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

impl UnitGuess {
    /// Estimate from largest radius and extent: no vessel is thicker than 20 mm, no network larger than 2 m.
    fn of(largest_radius: f64, extent: f64) -> Self {
        if largest_radius > 20.0 || extent > 2000.0 {
            Self::Micrometres
        } else if largest_radius < 0.02 && extent < 2.0 {
            Self::Metres
        } else {
            Self::Millimetres
        }
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
    /// Unit of length estimated from the sizes.
    pub unit_guess: UnitGuess,
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
            unit_guess: UnitGuess::of(radius.max, aabb.diagonal()),
            metrics,
            overlaps: skeleton.overlaps(&adjacency),
            crowded_terminals: skeleton.crowded_terminals(&adjacency),
        }
    }

    fn write_cleaning(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for change in self.cleaned.changes() {
            writeln!(f, "cleaned: {change}")?;
        }
        Ok(())
    }

    fn write_metrics(&self, f: &mut fmt::Formatter) -> fmt::Result {
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

    fn write_overlaps(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let all = &self.overlaps.pairs;
        let beside = all.iter().filter(|o| o.shares_node()).count();
        writeln!(f, "overlaps: {}, of which {} share a node", counted(all.len(), "edge pair"), grouped(beside))?;
        for o in all.iter().take(LISTED) {
            let [[a, b], [c, d]] = o.nodes.map(|ends| ends.map(|n| n.0));
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

    fn write_crowded(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let all = &self.crowded_terminals;
        writeln!(f, "terminals closer than the sum of their radii: {}", counted(all.len(), "pair"))?;
        for CrowdedTerminals { nodes: [a, b], distance, radii } in all.iter().take(LISTED) {
            writeln!(f, "  {} and {}: distance {}, sum of radii {}", a.0, b.0, digits(*distance), digits(*radii))?;
        }
        if all.len() > LISTED {
            writeln!(f, "  and {} more (--json lists all)", grouped(all.len() - LISTED))?;
        }
        Ok(())
    }
}

impl fmt::Display for NetworkInfo {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for note in &self.notes {
            writeln!(f, "read: {note}")?;
        }
        self.write_cleaning(f)?;
        writeln!(f, "nodes: {} ({})", grouped(self.nodes), counted(self.terminals, "terminal"))?;
        writeln!(f, "edges: {} in {} branches", grouped(self.edges), grouped(self.branches))?;
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
        writeln!(f, "unit: probably {} (estimated from the largest radius and the extent)", self.unit_guess)?;
        self.write_metrics(f)?;
        self.write_overlaps(f)?;
        self.write_crowded(f)
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
        assert_eq!(info.unit_guess, UnitGuess::Millimetres);
        assert_eq!(info.overlaps.pairs.iter().filter(|o| !o.shares_node()).count(), 2);
        let text = info.to_string();
        assert!(text.contains("read: a note\ncleaned: 1 repeated edge removed\nnodes: 7 (3 terminals)\n"), "{text}");
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
