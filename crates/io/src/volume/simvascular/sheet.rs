//! Parts of the boundary as separate surfaces: large ones, and caps.

use super::spool::Spool;
use crate::volume::second::CellNodes;
use anastomesh_mesh::bits::{Bits, Ranks};
use anastomesh_mesh::faces::OuterFace;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::quality::triangle_area_vector;
use anastomesh_mesh::source::{MeshSource, miscounted};
use std::io;

/// Selects faces.
pub(super) type Chosen<'a> = &'a (dyn Fn(&OuterFace) -> bool + Sync);

/// Callback for items in batches.
pub(super) type Take<'a, T> = &'a mut dyn FnMut(&[T]) -> io::Result<()>;

/// Part of the boundary. Its points are renumbered in the order of the mesh.
pub(super) trait Sheet: Sync {
    /// Nodes of the cells of the mesh.
    fn nodes(&self) -> CellNodes<'_>;
    /// Number of points and faces.
    fn counts(&self) -> (usize, usize);
    /// Provides the points.
    fn each_points(&self, each: Take<Point3>) -> io::Result<()>;
    /// Provides the numbers of the points in the mesh.
    fn each_ids(&self, each: Take<u32>) -> io::Result<()>;
    /// Provides the faces, with point numbers of the mesh.
    fn each_faces(&self, each: Take<OuterFace>) -> io::Result<()>;
    /// Number in this part of a mesh point.
    fn own_number(&self, id: u32) -> u32;
}

/// Possibly large part: memory holds only 1.5 bits per mesh point.
pub(super) struct WideSheet<'a> {
    pub(super) mesh: &'a dyn MeshSource,
    pub(super) nodes: CellNodes<'a>,
    pub(super) spool: &'a Spool,
    pub(super) has: Chosen<'a>,
    pub(super) used: &'a Bits,
    pub(super) ranks: Ranks<'a>,
    pub(super) faces: usize,
}

/// Points of the selected faces, and number of these faces.
pub(super) fn used(points: usize, nodes: CellNodes, spool: &Spool, has: Chosen) -> io::Result<(Bits, usize)> {
    let (mut used, mut count) = (Bits::new(points), 0);
    spool.each(|faces| {
        for face in faces.iter().filter(|face| has(face)) {
            count += 1;
            if !nodes.of_faces(&[face.vertices]).iter().all(|&v| used.insert(v)) {
                return Err(miscounted());
            }
        }
        Ok(())
    })?;
    Ok((used, count))
}

impl Sheet for WideSheet<'_> {
    fn nodes(&self) -> CellNodes<'_> {
        self.nodes
    }

    fn counts(&self) -> (usize, usize) {
        (self.used.count(), self.faces)
    }

    fn each_points(&self, each: Take<Point3>) -> io::Result<()> {
        let mut before = 0;
        self.mesh.each_points(|points| {
            let own = (before..).zip(points).filter(|(v, _)| self.used.has(*v)).map(|(_, p)| *p);
            before += points.len() as u32;
            each(&own.collect::<Vec<_>>())
        })
    }

    fn each_ids(&self, each: Take<u32>) -> io::Result<()> {
        const AT_A_TIME: u32 = 1 << 16;
        let end = self.mesh.counts().points as u32;
        (0..end).step_by(AT_A_TIME as usize).try_for_each(|first| {
            let some = first..end.min(first.saturating_add(AT_A_TIME));
            each(&some.filter(|&v| self.used.has(v)).collect::<Vec<_>>())
        })
    }

    fn each_faces(&self, each: Take<OuterFace>) -> io::Result<()> {
        self.spool.each(|faces| each(&faces.iter().copied().filter(|face| (self.has)(face)).collect::<Vec<_>>()))
    }

    fn own_number(&self, id: u32) -> u32 {
        self.ranks.rank(id)
    }
}

/// One or several inlets or outlets: small, and held in memory.
pub(super) struct CapSheet<'a> {
    faces: &'a [OuterFace],
    nodes: CellNodes<'a>,
    ids: Vec<u32>,
    points: Vec<Point3>,
}

impl<'a> CapSheet<'a> {
    pub(super) fn new(mesh: &dyn MeshSource, nodes: CellNodes<'a>, faces: &'a [OuterFace]) -> io::Result<Self> {
        let mut ids: Vec<u32> = nodes.of_faces(&corners(faces)).into_owned();
        ids.sort_unstable();
        ids.dedup();
        let points = mesh.points_of(&ids)?;
        Ok(Self { faces, nodes, ids, points })
    }

    /// Numbers of the points in the mesh.
    pub(super) fn ids(&self) -> &[u32] {
        &self.ids
    }

    pub(super) fn points(&self) -> &[Point3] {
        &self.points
    }

    /// Nodes of each face, by indices of points.
    pub(super) fn faces(&self) -> Vec<Vec<usize>> {
        let corners = corners(self.faces);
        let nodes = self.nodes.of_faces(&corners);
        let own = |face: &[u32]| face.iter().map(|&v| self.own_number(v) as usize).collect();
        nodes.chunks(self.nodes.per_face()).map(own).collect()
    }

    /// Edge length of equilateral triangles of the mean area.
    pub(super) fn edge(&self) -> f64 {
        let area = |face: &Vec<usize>| {
            let [a, b, c] = [0, 1, 2].map(|i| self.points[face[i]]);
            triangle_area_vector(&a, &b, &c).norm()
        };
        let area: f64 = self.faces().iter().map(area).sum();
        (4.0 * area / (3_f64.sqrt() * self.faces.len().max(1) as f64)).sqrt()
    }
}

/// Corners of faces.
pub(super) fn corners(faces: &[OuterFace]) -> Vec<[u32; 3]> {
    faces.iter().map(|face| face.vertices).collect()
}

impl Sheet for CapSheet<'_> {
    fn nodes(&self) -> CellNodes<'_> {
        self.nodes
    }

    fn counts(&self) -> (usize, usize) {
        (self.ids.len(), self.faces.len())
    }

    fn each_points(&self, each: Take<Point3>) -> io::Result<()> {
        each(&self.points)
    }

    fn each_ids(&self, each: Take<u32>) -> io::Result<()> {
        each(&self.ids)
    }

    fn each_faces(&self, each: Take<OuterFace>) -> io::Result<()> {
        each(self.faces)
    }

    fn own_number(&self, id: u32) -> u32 {
        self.ids.partition_point(|&own| own < id) as u32
    }
}
