//! Failing inputs as small self-contained JSON files, and a way to run them again.

use super::cluster::{ClusterMesh, mesh_cluster};
use super::connector::{ConnectorMesh, FreeEnds, mesh_connector};
use super::connector_surface::ConnectorEnd;
use super::end_surface::EndSurface;
use super::error::BlockError;
use super::params::BlockParams;
use crate::geometry::{Point3, Section, Tube, Vec3};
use crate::partition::{Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind};
use crate::skeleton::{BranchId, NodeId};
use serde::{Deserialize, Serialize};

/// The input of one block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "block", rename_all = "snake_case")]
pub enum BlockDump {
    /// A cluster.
    Cluster(ClusterDump),
    /// A connector.
    Connector(Box<ConnectorDump>),
}

/// A cluster and its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClusterDump {
    cluster: u32,
    params: BlockParams,
    nodes: Vec<u32>,
    tubes: Vec<TubeDump>,
    ends: Vec<ClusterEndDump>,
}

/// A cut, its two end surfaces and their parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConnectorDump {
    cut: u32,
    branch: u32,
    clusters: [u32; 2],
    ends: [u32; 2],
    params: BlockParams,
    path: Vec<SectionDump>,
    surfaces: [EndSurfaceDump; 2],
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct TubeDump {
    a: [f64; 3],
    b: [f64; 3],
    ra: f64,
    rb: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct SectionDump {
    origin: [f64; 3],
    axis: [f64; 3],
    radius: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ClusterEndDump {
    section: SectionDump,
    /// Cut and side, or neither.
    cut: Option<(u32, u8)>,
    node: Option<u32>,
    overrun: u32,
}

/// An end surface over its own points only.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct EndSurfaceDump {
    section: SectionDump,
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    rim: Vec<u32>,
}

/// A block that was run again.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockOutcome {
    /// A cluster's mesh.
    Cluster(ClusterMesh),
    /// A connector's mesh.
    Connector(ConnectorMesh),
}

/// The dump of a cluster.
pub fn dump_cluster(id: ClusterId, cluster: &Cluster, params: &BlockParams) -> BlockDump {
    let end = |e: &ClusterEnd| ClusterEndDump {
        section: e.section.into(),
        cut: if let EndKind::Cut { cut, side } = e.kind { Some((cut.0, side)) } else { None },
        node: if let EndKind::Terminal(node) = e.kind { Some(node.0) } else { None },
        overrun: e.overrun,
    };
    BlockDump::Cluster(ClusterDump {
        cluster: id.0,
        params: *params,
        nodes: cluster.nodes.iter().map(|n| n.0).collect(),
        tubes: cluster
            .tubes
            .iter()
            .map(|t| TubeDump { a: t.a.coords.into(), b: t.b.coords.into(), ra: t.ra, rb: t.rb })
            .collect(),
        ends: cluster.ends.iter().map(end).collect(),
    })
}

/// The dump of a connector.
pub fn dump_connector(id: CutId, cut: &Cut, ends: [ConnectorEnd; 2], params: &BlockParams) -> BlockDump {
    let surface = |end: ConnectorEnd| {
        let vertices = end.surface.vertices();
        let local = |v: u32| vertices.partition_point(|&x| x < v) as u32;
        EndSurfaceDump {
            section: end.surface.section.into(),
            points: vertices.iter().map(|&v| end.points[v as usize].coords.into()).collect(),
            triangles: end.surface.triangles.iter().map(|t| t.map(local)).collect(),
            rim: end.surface.rim.iter().map(|&v| local(v)).collect(),
        }
    };
    BlockDump::Connector(Box::new(ConnectorDump {
        cut: id.0,
        branch: cut.branch.0,
        clusters: cut.sides.map(|s| s.0.0),
        ends: cut.sides.map(|s| s.1),
        params: *params,
        path: cut.path.iter().map(|&s| s.into()).collect(),
        surfaces: ends.map(surface),
    }))
}

/// The dump of a connector that is made without its clusters; none when its discs cannot be made.
pub fn dump_free_connector(id: CutId, cut: &Cut, params: &BlockParams) -> Option<BlockDump> {
    let ends = FreeEnds::new(id, cut, params).ok()?;
    Some(dump_connector(id, cut, ends.both(), params))
}

impl BlockDump {
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
    /// Text that is no dump.
    pub fn from_json(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text)
    }

    /// Runs the block again.
    ///
    /// # Errors
    /// The block's.
    pub fn run(&self) -> Result<BlockOutcome, BlockError> {
        match self {
            Self::Cluster(d) => mesh_cluster(ClusterId(d.cluster), &d.cluster(), &d.params).map(BlockOutcome::Cluster),
            Self::Connector(d) => d.run().map(BlockOutcome::Connector),
        }
    }
}

impl ClusterDump {
    /// The cluster.
    pub fn cluster(&self) -> Cluster {
        Cluster {
            nodes: self.nodes.iter().map(|&n| NodeId(n)).collect(),
            tubes: self
                .tubes
                .iter()
                .map(|t| Tube { a: Point3::from(t.a), b: Point3::from(t.b), ra: t.ra, rb: t.rb })
                .collect(),
            ends: self.ends.iter().map(ClusterEndDump::end).collect(),
        }
    }
}

impl ClusterEndDump {
    fn end(&self) -> ClusterEnd {
        let kind = match self.cut {
            Some((cut, side)) => EndKind::Cut { cut: CutId(cut), side },
            None => EndKind::Terminal(NodeId(self.node.unwrap_or(u32::MAX))),
        };
        ClusterEnd { section: self.section.into(), kind, overrun: self.overrun }
    }
}

impl ConnectorDump {
    fn run(&self) -> Result<ConnectorMesh, BlockError> {
        let cut = Cut {
            branch: BranchId(self.branch),
            sides: [0, 1].map(|i| (ClusterId(self.clusters[i]), self.ends[i])),
            path: self.path.iter().map(|&s| s.into()).collect(),
        };
        let points: [Vec<Point3>; 2] =
            [0, 1].map(|i| self.surfaces[i].points.iter().map(|&p| Point3::from(p)).collect());
        let surfaces = [0, 1].map(|i| EndSurface {
            cut: CutId(self.cut),
            side: i as u8,
            section: self.surfaces[i].section.into(),
            triangles: self.surfaces[i].triangles.clone(),
            rim: self.surfaces[i].rim.clone(),
        });
        let ends = [0, 1].map(|i| ConnectorEnd { surface: &surfaces[i], points: &points[i] });
        mesh_connector(CutId(self.cut), &cut, ends, &self.params)
    }
}

impl From<Section> for SectionDump {
    fn from(s: Section) -> Self {
        Self { origin: s.origin.coords.into(), axis: s.axis.into(), radius: s.radius }
    }
}

impl From<SectionDump> for Section {
    fn from(s: SectionDump) -> Self {
        Self { origin: Point3::from(s.origin), axis: Vec3::from(s.axis), radius: s.radius }
    }
}
