//! Finished block: common result of clusters and connectors for the final mesh.

use super::error::NotOnBoundary;
use rustc_hash::FxHashMap;

use super::connector::ConnectorMesh;
use super::contoured::{CapFaces, ClusterMesh};
use super::end_surface::{EndSurface, StoredEnd, disc_rim};
use super::faithful::Astray;
use super::layered::ThinLayers;
use super::topology::{FinishedJoint, Topology};
use crate::partition::CutId;
use anastomesh_mesh::adjacency::{face_vertices, tet_adjacency};
use anastomesh_mesh::check::parts::{Certificate, PartView, certify_hollow, certify_with};
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_mesh::{Cap, TetMesh};
use anastomesh_skeleton::NodeId;
use anastomesh_tet::parts::is_open;
use std::sync::Arc;

/// Least cosine between a direction away from a wall vertex and the normals of its triangles. Smaller ones are left to the
/// shells' own smoothing.
const OPEN: f64 = 0.02;

/// Finished block. Faces are handles in ascending order: `4 · tet + i` for the face opposite vertex `i`. In a hollow
/// block they are indices of hull triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Finished {
    /// Points and tetrahedra.
    pub mesh: TetMesh,
    /// Closed surface of a hollow block, which has no tetrahedra; else empty.
    pub hull: Vec<[u32; 3]>,
    /// Number of leading points that belong to joints. Other blocks contain them, too, and refer to them.
    pub shared: u32,
    /// Boundary faces that belong to no joint and no cap.
    pub wall: Vec<u32>,
    /// Interfaces with other blocks: a cluster's cut ends in the order of `Cluster::ends`, or a connector's two sides.
    pub joints: Vec<FinishedJoint>,
    /// Caps, in the order of `Cluster::ends`.
    pub caps: Vec<FinishedCap>,
    /// Certificate of the block's own checks.
    pub certificate: Certificate,
    /// Report data.
    pub about: About,
}

/// Flat cap of a terminal.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedCap {
    /// Node of the terminal.
    pub node: NodeId,
    /// Cap plane; its axis points out of the mesh.
    pub section: Section,
    /// Boundary faces of the disc.
    pub faces: Vec<u32>,
}

impl FinishedCap {
    /// Cap with the terminal's number in the input network.
    pub fn disc(&self, original: u32) -> Cap {
        let Section { origin: center, axis: normal, radius, .. } = self.section;
        Cap { node: original, center, normal, radius }
    }
}

/// Report data of a block.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct About {
    /// Terminals without a cap, because their tips lie in another vessel.
    pub uncapped: Vec<u32>,
    /// Deviations of the wall from the vessels.
    pub astray: Astray,
    /// Genus of a cluster's wall.
    pub handles: i64,
    /// Independent loops of its skeleton, minus filled ones.
    pub loops: i64,
    /// Skeleton loops that are filled by their own lumen.
    pub filled: i64,
    /// Report of layers that are thinner than requested.
    #[serde(default)]
    pub thin: Option<ThinLayers>,
    /// Places of narrow gaps between vessels that were closed.
    #[serde(default)]
    pub closed_gaps: Vec<[f64; 3]>,
    /// Successful retry after a failure.
    pub cured: Option<Cured>,
}

/// First failure of a block and the remedy that solved it.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cured {
    /// The first failure.
    pub failure: String,
    /// Retry variant that succeeded.
    pub remedy: String,
}

impl Finished {
    /// Converts a cluster. `original` maps terminals to the input network.
    ///
    /// # Errors
    /// An end or a cap is not on the boundary.
    pub fn of_cluster(cluster: ClusterMesh, original: impl Fn(NodeId) -> u32) -> Result<Self, NotOnBoundary> {
        let ClusterMesh { mesh, hull, ends, caps, topology, .. } = cluster;
        let ClusterMesh { uncapped, astray, handles, loops, filled, thin, closed_gaps, .. } = cluster;
        let topology = if let Some(topology) = topology {
            topology
        } else {
            let discs = ends.iter().map(|end| &end.triangles).chain(caps.iter().map(|cap| &cap.triangles));
            Arc::new(topology_of(&mesh, &hull, discs)?)
        };
        let (joints, of_caps) = topology.discs.split_at(ends.len());
        let cap = |(cap, disc): (&CapFaces, &FinishedJoint)| FinishedCap {
            node: cap.node,
            section: cap.section,
            faces: disc.faces.clone(),
        };
        let caps = caps.iter().zip(of_caps).map(cap).collect();
        let uncapped = uncapped.iter().map(|n| n.0).collect();
        let closed_gaps = closed_gaps.into_iter().map(Into::into).collect();
        let about = About { uncapped, astray, handles, loops, filled, thin, closed_gaps, ..About::default() };
        let (wall, joints) = (topology.wall.clone(), joints.to_vec());
        Ok(Self { mesh, hull, wall, joints, caps, about, ..Self::default() }.certified(&topology, original))
    }

    /// Converts a connector between two end surfaces.
    ///
    /// # Errors
    /// An end is not on the boundary.
    pub fn of_connector(connector: ConnectorMesh, ends: [&EndSurface; 2]) -> Result<Self, NotOnBoundary> {
        let ConnectorMesh { mesh, hull, shared, thin, topology, .. } = connector;
        let about = About { thin, ..About::default() };
        let topology = if let Some(topology) = topology {
            topology
        } else {
            let mut base = 0;
            let discs = ends.map(|end| {
                let vertices = end.vertices();
                // The connector has the ends' vertices in ascending order, and their triangles reversed.
                let local = |v: u32| base + vertices.partition_point(|&x| x < v) as u32;
                let reversed = |t: &[u32; 3]| [local(t[0]), local(t[2]), local(t[1])];
                let triangles: Vec<[u32; 3]> = end.triangles.iter().map(reversed).collect();
                base += vertices.len() as u32;
                triangles
            });
            Arc::new(topology_of(&mesh, &hull, &discs)?)
        };
        let (wall, joints) = (topology.wall.clone(), topology.discs.clone());
        let connector = Self { mesh, hull, shared: shared.len() as u32, wall, joints, about, ..Self::default() };
        Ok(connector.certified(&topology, |node| node.0))
    }

    /// Adds the certificate of the block's own checks.
    fn certified(mut self, topology: &Topology, original: impl Fn(NodeId) -> u32) -> Self {
        let joints: Vec<_> = self.joints.iter().map(|joint| self.triangles(&joint.faces)).collect();
        let cap = |cap: &FinishedCap| (cap.disc(original(cap.node)), self.triangles(&cap.faces));
        let caps: Vec<_> = self.caps.iter().map(cap).collect();
        let view = PartView { mesh: &self.mesh, joints: &joints, caps: &caps };
        let adjacency = || tet_adjacency(&self.mesh.tets, self.mesh.points.len());
        debug_assert!(
            !self.hull.is_empty() || topology.adjacency.as_ref().is_none_or(|held| **held == adjacency()),
            "the topology is that of a template with other tetrahedra"
        );
        self.certificate =
            if self.hull.is_empty() { topology.certify(&view) } else { certify_hollow(&view, &self.hull) };
        debug_assert!(
            !self.hull.is_empty() || self.certificate == certify_with(&view, adjacency),
            "the certificate of an image is that of any block"
        );
        self
    }

    /// Vertices of faces.
    pub fn triangles(&self, faces: &[u32]) -> Vec<[u32; 3]> {
        faces.iter().map(|&face| triangle_of(&self.mesh, &self.hull, face)).collect()
    }

    /// First folded vertex of the wall: no direction leads away from all wall triangles at it, so that no shell can grow.
    pub fn fold(&self) -> Option<Point3> {
        let mut normals: FxHashMap<u32, Vec<Vec3>> = FxHashMap::default();
        for triangle in self.triangles(&self.wall) {
            let [a, b, c] = triangle.map(|v| self.mesh.points[v as usize]);
            let inward = (c - a).cross(&(b - a)).try_normalize(0.0).unwrap_or_default();
            for v in triangle {
                normals.entry(v).or_default().push(inward);
            }
        }
        let folded = normals.iter().filter(|(_, normals)| !is_open(normals, OPEN)).map(|(&v, _)| v).min();
        folded.map(|v| self.mesh.points[v as usize])
    }

    /// Joint as an end surface with its own points; `None` if it is not a disc.
    pub fn end_surface(&self, joint: usize, cut: CutId, side: u8, section: Section) -> Option<StoredEnd> {
        let FinishedJoint { vertices, faces } = self.joints.get(joint)?;
        let local = |v: u32| vertices.partition_point(|&x| x < v) as u32;
        let triangles: Vec<[u32; 3]> = self.triangles(faces).into_iter().map(|t| t.map(local)).collect();
        let rim = disc_rim(&triangles)?;
        let points = vertices.iter().map(|&v| self.mesh.points[v as usize]).collect();
        Some(StoredEnd { surface: EndSurface { cut, side, section, triangles, rim }, points })
    }
}

/// Vertices of a face handle.
pub(super) fn triangle_of(mesh: &TetMesh, hull: &[[u32; 3]], face: u32) -> [u32; 3] {
    hull.get(face as usize).copied().unwrap_or_else(|| face_vertices(&mesh.tets, face))
}

/// Topology of tetrahedra, or of the closed surface of a hollow block.
fn topology_of<'a>(
    mesh: &TetMesh,
    hull: &[[u32; 3]],
    discs: impl IntoIterator<Item = &'a Vec<[u32; 3]>>,
) -> Result<Topology, NotOnBoundary> {
    let discs = discs.into_iter().map(Vec::as_slice);
    if hull.is_empty() { Topology::of(mesh, discs) } else { Topology::of_hull(hull, discs) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::sphere_surface;

    #[test]
    fn a_fold_of_the_wall_is_found() {
        let surface = sphere_surface(3);
        let wall = (0..surface.triangles.len() as u32).collect();
        let mesh = TetMesh { points: surface.points, tets: Vec::new() };
        let mut block = Finished { mesh, hull: surface.triangles, wall, ..Finished::default() };
        assert_eq!(block.fold(), None);
        // A spike bent down beside the wall: its triangles face away from each other.
        block.mesh.points[40] *= 1.2;
        let up = block.mesh.points[40].coords;
        let aside = up.cross(&Vec3::x()).normalize();
        block.mesh.points[40] += aside * 2.0;
        assert!(block.fold().is_some());
        // Caps are no part of the wall.
        block.wall.clear();
        assert_eq!(block.fold(), None);
    }
}
