//! Dumps: failing block inputs as small self-contained JSON files.

use super::connector::DIVISIONS;
use super::end_surface::StoredEnd;
use super::params::BlockParams;
use crate::partition::{Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind};
use anastomesh_mesh::geometry::{Point3, Section, Tube};
use anastomesh_skeleton::{FinePlace, LARGEST, LEAST_SIZE, NodeId};
use serde::{Deserialize, Serialize};

/// Format version; changes whenever the meaning or the names of the contents change.
const FORMAT: u32 = 1;

/// Input of one block at its first attempt. Nodes are numbered as in the input network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlockDump {
    format: u32,
    /// Program and version that wrote the dump.
    pub program: String,
    /// Nodes of the block (the first 20).
    pub nodes: Vec<u32>,
    /// Parameters of the block.
    pub params: BlockParams,
    /// Input of the block.
    pub input: BlockInput,
}

/// Input of a block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BlockInput {
    /// A cluster.
    Cluster {
        /// Cluster index.
        id: ClusterId,
        /// Vessels and ends.
        cluster: Cluster,
    },
    /// A connector between the end surfaces of its two clusters.
    Connector {
        /// Cut index.
        id: CutId,
        /// The cut.
        cut: Cut,
        /// End surfaces, side 0 first.
        ends: Box<[StoredEnd; 2]>,
    },
    /// A connector between shared discs, without its clusters.
    FreeConnector {
        /// Cut index.
        id: CutId,
        /// The cut.
        cut: Cut,
    },
}

/// Errors of reading a dump.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DumpError {
    /// The file is truncated.
    #[error("the file is truncated ({0}): copy it again, or run `mesh` again to rewrite it")]
    CutOff(serde_json::Error),
    /// The file is not a dump.
    #[error("not a block dump ({0}): give a file of the folder MESH.failed, which `mesh` writes")]
    Other(serde_json::Error),
    /// The format version is missing.
    #[error("the format version is missing: run `mesh` again with this version to rewrite the file")]
    NoFormat,
    /// Another version of the program wrote the dump.
    #[error(
        "format version {format} (written by {program}) is not supported, only {FORMAT}: run `mesh` again, or use that program"
    )]
    Format {
        /// Format version of the dump.
        format: u32,
        /// Program that wrote the dump.
        program: String,
    },
    /// A number is out of range.
    #[error("{what}, which is out of range: the file was modified; run `mesh` again to rewrite it")]
    Senseless {
        /// Name of the number and its fault.
        what: String,
    },
}

/// Common header of dumps of all versions.
#[derive(Deserialize)]
struct DumpHeader {
    format: Option<u32>,
    #[serde(default)]
    program: String,
}

impl BlockDump {
    /// Creates the dump of a cluster. `original` maps nodes to the input network; `nodes` are listed in the dump.
    pub fn of_cluster(
        id: ClusterId,
        cluster: &Cluster,
        params: BlockParams,
        nodes: Vec<u32>,
        original: impl Fn(NodeId) -> u32,
    ) -> Self {
        let original = |node: NodeId| NodeId(original(node));
        let end = |end: &ClusterEnd| match end.kind {
            EndKind::Terminal(node) => ClusterEnd { kind: EndKind::Terminal(original(node)), ..end.clone() },
            EndKind::Cut { .. } => end.clone(),
        };
        let cluster = Cluster {
            nodes: cluster.nodes.iter().map(|&node| original(node)).collect(),
            tubes: cluster.tubes.clone(),
            ends: cluster.ends.iter().map(end).collect(),
            fine: cluster.fine.clone(),
            size: None,
            cells: cluster.cells.clone(),
        };
        Self::new(params, nodes, BlockInput::Cluster { id, cluster })
    }

    /// Creates the dump of a connector between the end surfaces of its two clusters.
    pub fn of_connector(id: CutId, cut: &Cut, ends: [StoredEnd; 2], params: BlockParams, nodes: Vec<u32>) -> Self {
        Self::new(params, nodes, BlockInput::Connector { id, cut: cut.clone(), ends: Box::new(ends) })
    }

    /// Creates the dump of a connector without its clusters.
    pub fn of_free_connector(id: CutId, cut: &Cut, params: BlockParams, nodes: Vec<u32>) -> Self {
        Self::new(params, nodes, BlockInput::FreeConnector { id, cut: cut.clone() })
    }

    fn new(params: BlockParams, nodes: Vec<u32>, input: BlockInput) -> Self {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into();
        Self { format: FORMAT, program, nodes, params, input }
    }

    /// Returns `cluster 12` or `connector 7`.
    pub fn name(&self) -> String {
        match &self.input {
            BlockInput::Cluster { id, .. } => format!("cluster {}", id.0),
            BlockInput::Connector { id, .. } | BlockInput::FreeConnector { id, .. } => format!("connector {}", id.0),
        }
    }

    /// Converts to JSON; numbers are preserved bit for bit.
    ///
    /// # Errors
    /// A coordinate is not finite.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self)
    }

    /// Parses JSON.
    ///
    /// # Errors
    /// The text is not a dump, or contains values that no run writes.
    pub fn from_json(text: &[u8]) -> Result<Self, DumpError> {
        // A truncated number is a syntax error at the end of the text.
        let ends = |e: &serde_json::Error| {
            let last = text.split(|&byte| byte == b'\n').enumerate().last();
            last.is_some_and(|(line, rest)| e.line() == line + 1 && e.column() >= rest.len())
        };
        let cut_off = |e: &serde_json::Error| e.is_eof() || e.is_syntax() && ends(e);
        let fault = |e: serde_json::Error| if cut_off(&e) { DumpError::CutOff(e) } else { DumpError::Other(e) };
        // The format version is checked first, as the contents of other versions are unknown.
        match serde_json::from_slice(text).map_err(fault)? {
            DumpHeader { format: None, .. } => Err(DumpError::NoFormat),
            DumpHeader { format: Some(FORMAT), .. } => {
                let dump: Self = serde_json::from_slice(text).map_err(fault)?;
                dump.check().map_err(|what| DumpError::Senseless { what })?;
                Ok(dump)
            }
            DumpHeader { format: Some(format), program } => Err(DumpError::Format { format, program }),
        }
    }

    /// Checks the ranges of numbers on which later code relies.
    fn check(&self) -> Result<(), String> {
        self.params.check().map_err(|e| e.to_string())?;
        if self.params.first_division >= DIVISIONS {
            return Err(format!("first_division is {}", self.params.first_division));
        }
        match &self.input {
            BlockInput::Cluster { cluster, .. } => check_cluster(cluster),
            BlockInput::FreeConnector { cut, .. } => cut.path.iter().try_for_each(check_section),
            BlockInput::Connector { cut, ends, .. } => {
                cut.path.iter().try_for_each(check_section)?;
                ends.iter().try_for_each(check_end)
            }
        }
    }
}

fn check_cluster(cluster: &Cluster) -> Result<(), String> {
    for Tube { a, b, ra, rb } in &cluster.tubes {
        check_point(a)?;
        check_point(b)?;
        check_radius(*ra)?;
        check_radius(*rb)?;
    }
    for FinePlace { at, within, factor } in &cluster.fine {
        check_point(at)?;
        check_radius(*within)?;
        if !(LEAST_SIZE..=1.0).contains(factor) {
            return Err(format!("a place has edges {factor} times as long"));
        }
    }
    for end in &cluster.ends {
        check_section(&end.section)?;
        match end.kind {
            EndKind::Cut { side: 2.., .. } => return Err("an end has a side other than 0 and 1".into()),
            _ if end.overrun as usize >= cluster.tubes.len() => {
                return Err(format!("an end names tube {} of {}", end.overrun, cluster.tubes.len()));
            }
            _ => {}
        }
    }
    Ok(())
}

fn check_end(end: &StoredEnd) -> Result<(), String> {
    let StoredEnd { surface, points } = end;
    check_section(&surface.section)?;
    points.iter().try_for_each(check_point)?;
    match surface.triangles.as_flattened().iter().chain(&surface.rim).find(|&&v| v as usize >= points.len()) {
        Some(v) => Err(format!("an end names point {v} of {}", points.len())),
        None => Ok(()),
    }
}

fn check_section(section: &Section) -> Result<(), String> {
    check_point(&section.origin)?;
    check_radius(section.radius)?;
    let length = section.axis.norm();
    if (length - 1.0).abs() < 1e-6 { Ok(()) } else { Err(format!("an axis has the length {length}")) }
}

fn check_point(point: &Point3) -> Result<(), String> {
    // Not inverted, so that NaN is rejected, too.
    if point.coords.amax() <= LARGEST { Ok(()) } else { Err(format!("a point lies at {point}")) }
}

fn check_radius(radius: f64) -> Result<(), String> {
    if radius > 0.0 && radius <= LARGEST { Ok(()) } else { Err(format!("a radius is {radius}")) }
}
