//! Faults as navigation targets: failed checks, missing blocks, overlapping vessels.

use super::wall::{Group, Wall};
use crate::block::{BlockDump, BlockInput};
use anastomesh_mesh::Patch;
use anastomesh_mesh::check::text::violation;
use anastomesh_mesh::check::{CheckReport, LineResult, Offender, OffenderKind};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_skeleton::{Overlap, Skeleton};
use serde::Serialize;

/// Maximum number of listed faults of a kind, as many as a check keeps. Each takes about 100 bytes of the page.
const LISTED: usize = 1000;
/// Maximum number of indices in an offender's description.
const NAMED: usize = 3;

/// Kind of an offender's indices.
fn ids_of(kind: OffenderKind) -> &'static str {
    match kind {
        OffenderKind::Point => "point",
        OffenderKind::Edge | OffenderKind::Face | OffenderKind::FacePair => "points",
        OffenderKind::Tet => "tetrahedron",
        OffenderKind::TetPair => "tetrahedra",
        OffenderKind::Patch => "patch",
        OffenderKind::Node => "node",
        OffenderKind::Region => "region",
    }
}

/// Faults of one kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultGroup {
    /// Readable kind.
    pub kind: String,
    /// Number of faults, with those that are not listed.
    pub count: u64,
    /// Faults that have a position.
    pub faults: Vec<Fault>,
}

/// Position of a defect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// Readable description.
    pub what: String,
    pub place: [f64; 3],
    /// Size of the relevant region; 0 if unknown.
    pub extent: f64,
}

impl FaultGroup {
    /// Failed conditions of a check, with the offenders that have a position.
    pub fn of_check(check: &CheckReport) -> Vec<Self> {
        let of_line = |line: &LineResult| {
            let fault = |o: &Offender| {
                let ids: Vec<String> = o.ids.iter().take(NAMED).map(ToString::to_string).collect();
                let more = if o.ids.len() > NAMED { " …" } else { "" };
                let what = format!("{} {}{more}", ids_of(o.kind), ids.join(" "));
                Some(Fault { what, place: o.position?, extent: 0.0 })
            };
            Self {
                kind: format!("failed: {}", violation(line)),
                count: line.count.max(1),
                faults: line.offenders.iter().filter_map(fault).collect(),
            }
        };
        check.failed().map(of_line).collect()
    }

    /// Overlapping pairs of vessels, deepest first.
    pub fn of_overlaps(network: &Skeleton) -> Option<Self> {
        let mut pairs = network.overlaps(&network.adjacency()).pairs;
        pairs.sort_by(|a, b| (a.distance / a.radii).total_cmp(&(b.distance / b.radii)));
        let fault = |pair: &Overlap| {
            let [[a, b], [c, d]] = pair.nodes.map(|ends| ends.map(|n| network.node(n).original));
            let place = (pair.points[0].coords + pair.points[1].coords) * 0.5;
            Fault { what: format!("edges {a}-{b} and {c}-{d}"), place: place.into(), extent: 4.0 * pair.radii }
        };
        Self::listed("overlapping vessels", &pairs.iter().map(fault).collect::<Vec<_>>())
    }

    /// Missing blocks, recognized by the patch names of their neighbours.
    pub fn of_missing(wall: &Wall, patches: &[Patch]) -> Option<Self> {
        let name_of = |group: &Group| patches.iter().find(|patch| patch.id == group.patch).map(|patch| &*patch.name);
        let fault = |group: &Group| {
            let name = name_of(group).filter(|name| name.starts_with("missing_"))?;
            let first = group.points.first()?;
            let sum: Vec3 = group.points.iter().map(|p| p.coords).sum();
            let extent = group.points.iter().map(|p| (p - first).norm()).fold(0.0, f64::max);
            let what = format!("patch {name}");
            Some(Fault { what, place: (sum / group.points.len() as f64).into(), extent })
        };
        let faults: Vec<Fault> = wall.pieces.iter().flat_map(|piece| &piece.groups).filter_map(fault).collect();
        Self::listed("boundaries of missing blocks", &faults)
    }

    /// Blocks that could not be meshed.
    pub fn of_dumps(dumps: impl Iterator<Item = BlockDump>) -> Option<Self> {
        Self::listed("blocks not meshed", &dumps.filter_map(|dump| Fault::of_dump(&dump)).collect::<Vec<_>>())
    }

    fn listed(kind: &str, faults: &[Fault]) -> Option<Self> {
        let listed = faults.iter().take(LISTED).cloned().collect();
        (!faults.is_empty()).then(|| Self { kind: kind.into(), count: faults.len() as u64, faults: listed })
    }
}

impl Fault {
    /// A block that could not be meshed.
    fn of_dump(dump: &BlockDump) -> Option<Self> {
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
            what: format!("{} (nodes {:?})", dump.name(), dump.nodes),
            place: (sum / points.len() as f64).into(),
            extent,
        })
    }
}
