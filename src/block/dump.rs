//! Failing inputs as small self-contained JSON files.

use super::connector::DIVISIONS;
use super::end_surface::StoredEnd;
use super::params::BlockParams;
use crate::partition::{Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind};
use anastomesh_mesh::geometry::{Point3, Section, Tube};
use anastomesh_skeleton::{FineFork, LARGEST, LEAST_SIZE, NodeId};
use serde::{Deserialize, Serialize};

/// Number of the format; another one whenever what a dump holds changes its meaning or its names.
const FORMAT: u32 = 1;

/// The input of one block, as it was first tried. Nodes are numbered as in the network that was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlockDump {
    format: u32,
    /// The program that wrote it.
    pub program: String,
    /// Nodes of the block (the first 20).
    pub nodes: Vec<u32>,
    /// Its parameters.
    pub params: BlockParams,
    /// What it is made from.
    pub input: BlockInput,
}

/// What a block is made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BlockInput {
    /// A cluster.
    Cluster {
        /// Its number.
        id: ClusterId,
        /// Its vessels and ends.
        cluster: Cluster,
    },
    /// A connector between the ends of its two clusters.
    Connector {
        /// Number of the cut.
        id: CutId,
        /// The cut.
        cut: Cut,
        /// The ends that it joins, side 0 first.
        ends: Box<[StoredEnd; 2]>,
    },
    /// A connector that is made without its clusters.
    FreeConnector {
        /// Number of the cut.
        id: CutId,
        /// The cut.
        cut: Cut,
    },
}

/// A file that is no dump, or none that this program can run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DumpError {
    /// It ends too early.
    #[error("it is cut off ({0}): copy it again, or run `mesh` again, which writes it anew")]
    CutOff(serde_json::Error),
    /// It is something else.
    #[error("it is no dump of a block ({0}): give a file of the folder MESH.failed that `mesh` leaves")]
    Other(serde_json::Error),
    /// It says nothing of its format.
    #[error("it does not say of which format it is: run `mesh` again with this version, which writes it anew")]
    NoFormat,
    /// Another version of the program wrote it.
    #[error("it is of format {format} (by {program}), this version reads {FORMAT}: run `mesh` again, or that version")]
    Format {
        /// Its format.
        format: u32,
        /// The program that wrote it.
        program: String,
    },
    /// A number that no dump has.
    #[error("{what}, which no block has: the file was changed, run `mesh` again, which writes it anew")]
    Senseless {
        /// Which number, and what is wrong with it.
        what: String,
    },
}

/// What dumps of all versions begin with.
#[derive(Deserialize)]
struct DumpHeader {
    format: Option<u32>,
    #[serde(default)]
    program: String,
}

impl BlockDump {
    /// Of a cluster. `original`: the number of a node in the network as it was read; `nodes`: those to be named.
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
        };
        Self::new(params, nodes, BlockInput::Cluster { id, cluster })
    }

    /// Of a connector between the ends of its two clusters.
    pub fn of_connector(id: CutId, cut: &Cut, ends: [StoredEnd; 2], params: BlockParams, nodes: Vec<u32>) -> Self {
        Self::new(params, nodes, BlockInput::Connector { id, cut: cut.clone(), ends: Box::new(ends) })
    }

    /// Of a connector that is made without its clusters.
    pub fn of_free_connector(id: CutId, cut: &Cut, params: BlockParams, nodes: Vec<u32>) -> Self {
        Self::new(params, nodes, BlockInput::FreeConnector { id, cut: cut.clone() })
    }

    fn new(params: BlockParams, nodes: Vec<u32>, input: BlockInput) -> Self {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into();
        Self { format: FORMAT, program, nodes, params, input }
    }

    /// `cluster 12` or `connector 7`.
    pub fn name(&self) -> String {
        match &self.input {
            BlockInput::Cluster { id, .. } => format!("cluster {}", id.0),
            BlockInput::Connector { id, .. } | BlockInput::FreeConnector { id, .. } => format!("connector {}", id.0),
        }
    }

    /// As JSON; numbers survive bit for bit.
    ///
    /// # Errors
    /// A coordinate that is not finite.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self)
    }

    /// From JSON.
    ///
    /// # Errors
    /// Text that is no dump, or one that no run can have written.
    pub fn from_json(text: &[u8]) -> Result<Self, DumpError> {
        // A number that is cut off is no number where the text ends.
        let ends = |e: &serde_json::Error| {
            let last = text.split(|&byte| byte == b'\n').enumerate().last();
            last.is_some_and(|(line, rest)| e.line() == line + 1 && e.column() >= rest.len())
        };
        let cut_off = |e: &serde_json::Error| e.is_eof() || e.is_syntax() && ends(e);
        let fault = |e: serde_json::Error| if cut_off(&e) { DumpError::CutOff(e) } else { DumpError::Other(e) };
        // The format is looked at first: what else another version writes cannot be known.
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

    /// Whether a block can have these numbers: what follows relies on it.
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
    for FineFork { at, within, factor } in &cluster.fine {
        check_point(at)?;
        check_radius(*within)?;
        if !(LEAST_SIZE..=1.0).contains(factor) {
            return Err(format!("a fork has edges {factor} times as long"));
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
    // Not the other way round: NaN is no coordinate, either.
    if point.coords.amax() <= LARGEST { Ok(()) } else { Err(format!("a point lies at {point}")) }
}

fn check_radius(radius: f64) -> Result<(), String> {
    if radius > 0.0 && radius <= LARGEST { Ok(()) } else { Err(format!("a radius is {radius}")) }
}
