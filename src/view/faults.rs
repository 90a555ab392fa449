//! Places to fly to: what a check found, blocks that failed, vessels that overlap.

use crate::block::{BlockDump, BlockInput};
use crate::geometry::{Point3, Vec3};
use crate::mesh::check::{CheckReport, LineResult};
use crate::skeleton::{Overlap, Skeleton};
use serde::Serialize;

/// Faults of a kind that are listed, at most.
const LISTED: usize = 200;

/// A place where something is wrong.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// What is wrong, for people.
    pub what: String,
    pub place: [f64; 3],
    /// A length of what is to be seen about it; 0 where none is known.
    pub extent: f64,
}

impl Fault {
    /// The offenders of a check that have a place.
    pub fn of_check(check: &CheckReport) -> Vec<Self> {
        let of_line = |line: &LineResult| {
            let statement = line.line.statement();
            line.offenders
                .iter()
                .filter_map(|o| Some(Self { what: format!("not so: {statement}"), place: o.position?, extent: 0.0 }))
                .collect::<Vec<_>>()
        };
        check.failed().flat_map(of_line).collect()
    }

    /// Pairs of vessels that overlap, the deepest first.
    pub fn of_overlaps(network: &Skeleton) -> Vec<Self> {
        let mut pairs = network.overlaps(&network.adjacency()).pairs;
        pairs.sort_by(|a, b| (a.distance / a.radii).total_cmp(&(b.distance / b.radii)));
        let fault = |pair: &Overlap| {
            let [[a, b], [c, d]] = pair.nodes.map(|ends| ends.map(|n| network.node(n).original));
            let place = (pair.points[0].coords + pair.points[1].coords) * 0.5;
            Self {
                what: format!("vessels overlap: edges {a}-{b} and {c}-{d}"),
                place: place.into(),
                extent: 4.0 * pair.radii,
            }
        };
        pairs.iter().take(LISTED).map(fault).collect()
    }

    /// A block that could not be meshed.
    pub fn of_dump(dump: &BlockDump) -> Option<Self> {
        let points: Vec<Point3> = match &dump.input {
            BlockInput::Cluster { cluster, .. } => cluster.tubes.iter().flat_map(|t| [t.a, t.b]).collect(),
            BlockInput::Connector { cut, .. } | BlockInput::FreeConnector { cut, .. } => {
                cut.path.iter().map(|s| s.origin).collect()
            }
        };
        let first = points.first()?;
        let sum: Vec3 = points.iter().map(|p| p.coords).sum();
        let extent = points.iter().map(|p| (p - first).norm()).fold(0.0, f64::max);
        Some(Self {
            what: format!("not meshed: {} (nodes {:?})", dump.name(), dump.nodes),
            place: (sum / points.len() as f64).into(),
            extent,
        })
    }
}
