//! A block when it is done: what the whole needs of it, whichever kind it is, and nothing else.

use super::error::NotOnBoundary;
use anastomesh_mesh::face_key;
use rustc_hash::FxHashMap;

use super::cluster::ClusterMesh;
use super::connector::ConnectorMesh;
use super::end_surface::{EndSurface, StoredEnd, disc_rim};
use super::faithful::Astray;
use super::layered::ThinLayers;
use crate::partition::CutId;
use anastomesh_mesh::adjacency::{TetAdjacency, face_vertices, tet_adjacency};
use anastomesh_mesh::check::parts::{Certificate, PartView, certify_hollow, certify_with};
use anastomesh_mesh::geometry::Section;
use anastomesh_mesh::{Cap, TetMesh};
use anastomesh_skeleton::NodeId;

/// A finished block. Faces are handles, `4 · tet + i` for the face opposite vertex `i`, ascending; in a hollow block they are
/// numbers of triangles of its hull.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Finished {
    /// Points and tetrahedra.
    pub mesh: TetMesh,
    /// The closed surface of a hollow block, which has no tetrahedra; else empty.
    pub hull: Vec<[u32; 3]>,
    /// The first so many points are those of the joints, in their order: other blocks have them, too, and name them.
    pub shared: u32,
    /// Boundary faces that belong to no joint and no cap.
    pub wall: Vec<u32>,
    /// Where other blocks follow: a cluster's cut ends in the order of `Cluster::ends`, a connector's side 0 and side 1.
    pub joints: Vec<FinishedJoint>,
    /// Caps, in the order of `Cluster::ends`.
    pub caps: Vec<FinishedCap>,
    /// What is known of it once it has been checked alone.
    pub certificate: Certificate,
    /// What a report says of it.
    pub about: About,
}

/// The disc in which two blocks meet, as one of them has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FinishedJoint {
    /// Its vertices, ascending; the other block has them in the same order.
    pub vertices: Vec<u32>,
    pub faces: Vec<u32>,
}

/// The flat disc that closes a terminal.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedCap {
    /// The terminal.
    pub node: NodeId,
    /// The plane; its axis points out of the mesh.
    pub section: Section,
    pub faces: Vec<u32>,
}

impl FinishedCap {
    /// The disc, with the terminal's number in the network as it was read.
    pub fn disc(&self, original: u32) -> Cap {
        let Section { origin: center, axis: normal, radius } = self.section;
        Cap { node: original, center, normal, radius }
    }
}

/// What a report says of a block.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct About {
    /// Terminals without a cap: their tips lie in another vessel.
    pub uncapped: Vec<u32>,
    /// What the wall does not keep of the vessels.
    pub astray: Astray,
    /// Genus of a cluster's wall.
    pub handles: i64,
    /// Independent loops of its skeleton, less those that are filled.
    pub loops: i64,
    /// Loops of its skeleton that are filled by their own lumen.
    pub filled: i64,
    /// Where layers are thinner than asked for.
    #[serde(default)]
    pub thin: Option<ThinLayers>,
    /// What helped, where it failed before.
    pub cured: Option<Cured>,
}

/// Why a block had to be tried again, and how it came out then.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cured {
    /// The first failure.
    pub failure: String,
    /// The way in which it came out.
    pub remedy: String,
}

impl Finished {
    /// A cluster. `original`: the number of a terminal in the network as it was read.
    ///
    /// # Errors
    /// When an end or a cap is not on the boundary.
    pub fn of_cluster(cluster: ClusterMesh, original: impl Fn(NodeId) -> u32) -> Result<Self, NotOnBoundary> {
        let ClusterMesh { mesh, hull, ends, caps, uncapped, astray, handles, loops, filled, thin, .. } = cluster;
        let mut faces = Faces::new(&mesh, &hull);
        let joints = ends.iter().map(|end| faces.joint(&end.triangles)).collect::<Result<_, _>>()?;
        let cap = |cap: &super::CapFaces| {
            Ok(FinishedCap { node: cap.node, section: cap.section, faces: faces.take(&cap.triangles)? })
        };
        let caps = caps.iter().map(cap).collect::<Result<_, _>>()?;
        let uncapped = uncapped.iter().map(|n| n.0).collect();
        let about = About { uncapped, astray, handles, loops, filled, thin, ..About::default() };
        let (wall, adjacency) = faces.rest();
        Ok(Self { mesh, hull, wall, joints, caps, about, ..Self::default() }.certified(adjacency, original))
    }

    /// A connector between two end surfaces.
    ///
    /// # Errors
    /// When an end is not on the boundary.
    pub fn of_connector(connector: ConnectorMesh, ends: [&EndSurface; 2]) -> Result<Self, NotOnBoundary> {
        let ConnectorMesh { mesh, hull, shared, thin, .. } = connector;
        let about = About { thin, ..About::default() };
        let mut faces = Faces::new(&mesh, &hull);
        let mut joints = Vec::with_capacity(2);
        let mut base = 0;
        for end in ends {
            let vertices = end.vertices();
            // The connector has the ends' vertices in ascending order, and their triangles turned round.
            let local = |v: u32| base + vertices.partition_point(|&x| x < v) as u32;
            let triangles: Vec<_> = end.triangles.iter().map(|t| [local(t[0]), local(t[2]), local(t[1])]).collect();
            joints.push(faces.joint(&triangles)?);
            base += vertices.len() as u32;
        }
        let (wall, adjacency) = faces.rest();
        let connector = Self { mesh, hull, shared: shared.len() as u32, wall, joints, about, ..Self::default() };
        Ok(connector.certified(adjacency, |node| node.0))
    }

    /// Checks it alone.
    fn certified(mut self, adjacency: Option<TetAdjacency>, original: impl Fn(NodeId) -> u32) -> Self {
        let joints: Vec<_> = self.joints.iter().map(|joint| self.triangles(&joint.faces)).collect();
        let cap = |cap: &FinishedCap| (cap.disc(original(cap.node)), self.triangles(&cap.faces));
        let caps: Vec<_> = self.caps.iter().map(cap).collect();
        let view = PartView { mesh: &self.mesh, joints: &joints, caps: &caps };
        self.certificate = match adjacency {
            Some(adjacency) => certify_with(&view, || adjacency),
            None => certify_hollow(&view, &self.hull),
        };
        self
    }

    /// The vertices of faces.
    pub fn triangles(&self, faces: &[u32]) -> Vec<[u32; 3]> {
        faces.iter().map(|&face| triangle_of(&self.mesh, &self.hull, face)).collect()
    }

    /// A joint as an end surface over its own points alone; none if it is no disc.
    pub fn end_surface(&self, joint: usize, cut: CutId, side: u8, section: Section) -> Option<StoredEnd> {
        let FinishedJoint { vertices, faces } = self.joints.get(joint)?;
        let local = |v: u32| vertices.partition_point(|&x| x < v) as u32;
        let triangles: Vec<[u32; 3]> = self.triangles(faces).into_iter().map(|t| t.map(local)).collect();
        let rim = disc_rim(&triangles)?;
        let points = vertices.iter().map(|&v| self.mesh.points[v as usize]).collect();
        Some(StoredEnd { surface: EndSurface { cut, side, section, triangles, rim }, points })
    }
}

/// The vertices of a face, by its handle.
pub(super) fn triangle_of(mesh: &TetMesh, hull: &[[u32; 3]], face: u32) -> [u32; 3] {
    hull.get(face as usize).copied().unwrap_or_else(|| face_vertices(&mesh.tets, face))
}

/// The boundary faces of a block that no end has taken yet.
struct Faces {
    left: FxHashMap<[u32; 3], u32>,
    /// None in a hollow block.
    adjacency: Option<TetAdjacency>,
}

impl Faces {
    fn new(mesh: &TetMesh, hull: &[[u32; 3]]) -> Self {
        if mesh.tets.is_empty() {
            let left = (0..).zip(hull).map(|(face, triangle)| (face_key(*triangle), face)).collect();
            return Self { left, adjacency: None };
        }
        let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
        let left = adjacency.boundary().map(|face| (face_key(face_vertices(&mesh.tets, face)), face)).collect();
        Self { left, adjacency: Some(adjacency) }
    }

    fn take(&mut self, triangles: &[[u32; 3]]) -> Result<Vec<u32>, NotOnBoundary> {
        let take = |&face: &[u32; 3]| self.left.remove(&face_key(face)).ok_or(NotOnBoundary { face });
        let mut faces = triangles.iter().map(take).collect::<Result<Vec<u32>, _>>()?;
        faces.sort_unstable();
        Ok(faces)
    }

    fn joint(&mut self, triangles: &[[u32; 3]]) -> Result<FinishedJoint, NotOnBoundary> {
        let mut vertices: Vec<u32> = triangles.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        Ok(FinishedJoint { vertices, faces: self.take(triangles)? })
    }

    /// The faces that nothing took, and what all were found with.
    fn rest(self) -> (Vec<u32>, Option<TetAdjacency>) {
        let mut rest: Vec<u32> = self.left.into_values().collect();
        rest.sort_unstable();
        (rest, self.adjacency)
    }
}
