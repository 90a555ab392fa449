//! The boundary of a mesh as a surface of its own, in passes: its points are numbered anew, all others left out.

use super::bits::Bits;
use super::source::{FacePiece, MeshSource, SourceCounts};
use super::{TriMesh, WALL};
use crate::geometry::Point3;
use std::io;

/// Which faces of a boundary are meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundaryPart {
    /// All: the surface is closed.
    #[default]
    Whole,
    /// The wall alone: the surface is open at inlets and outlets.
    Wall,
}

impl BoundaryPart {
    fn has(self, patch: i32) -> bool {
        self == Self::Whole || patch == WALL
    }
}

/// The boundary of a mesh. Nothing but a bit for each point is held.
pub struct BoundarySurface<'a> {
    mesh: &'a dyn MeshSource,
    part: BoundaryPart,
    used: Bits,
    points: usize,
    triangles: usize,
}

impl<'a> BoundarySurface<'a> {
    /// Counts it, in one pass over the boundary.
    ///
    /// # Errors
    /// What reading the mesh fails with; `InvalidData` when a face names a point that does not exist.
    pub fn new(mesh: &'a dyn MeshSource, part: BoundaryPart) -> io::Result<Self> {
        let (mut used, mut triangles) = (Bits::new(mesh.counts().points), 0);
        mesh.each_faces(|piece| {
            for face in chosen(piece, part).0 {
                triangles += 1;
                for v in face {
                    if !used.insert(v) {
                        let text = format!("a boundary face names the point {v}, which does not exist");
                        return Err(io::Error::new(io::ErrorKind::InvalidData, text));
                    }
                }
            }
            Ok(())
        })?;
        Ok(Self { mesh, part, points: used.count(), used, triangles })
    }

    /// The mesh that this is the boundary of.
    pub fn mesh(&self) -> &'a dyn MeshSource {
        self.mesh
    }

    /// How many points and faces there are; no tetrahedra.
    pub fn counts(&self) -> SourceCounts {
        SourceCounts { points: self.points, tets: 0, boundary: self.triangles }
    }

    /// Gives its points.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    pub fn each_points(&self, mut each: impl FnMut(&[Point3]) -> io::Result<()>) -> io::Result<()> {
        let mut before = 0;
        self.mesh.each_points(|points| {
            let own = (before..).zip(points).filter(|(v, _)| self.used.has(*v)).map(|(_, p)| *p);
            before += points.len() as u32;
            each(&own.collect::<Vec<_>>())
        })
    }

    /// Gives its faces, in the numbers of its own points.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    pub fn each_faces(&self, mut each: impl FnMut(&FacePiece) -> io::Result<()>) -> io::Result<()> {
        let ranks = self.used.ranks();
        self.mesh.each_faces(|piece| {
            let (mut faces, [patches, blocks]) = chosen(piece, self.part);
            faces.as_flattened_mut().iter_mut().for_each(|v| *v = ranks.rank(*v));
            each(&FacePiece { faces: faces.into(), patches: patches.into(), blocks: blocks.into() })
        })
    }

    /// Gives the corners of its faces.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    pub fn each_corners(&self, mut each: impl FnMut(&[[Point3; 3]]) -> io::Result<()>) -> io::Result<()> {
        let read = |part| {
            let piece = self.mesh.boundary(part)?;
            Ok((piece.faces.len(), self.mesh.corners_of(&chosen(&piece, self.part).0)?))
        };
        let expected = self.mesh.counts().boundary;
        self.mesh.in_order(expected, read, |(count, _)| *count, |(_, corners)| each(corners))
    }

    /// Puts it together in memory.
    ///
    /// # Errors
    /// What reading the mesh fails with.
    pub fn gather(&self) -> io::Result<TriMesh> {
        let mut mesh = TriMesh::default();
        self.each_points(|points| {
            mesh.points.extend_from_slice(points);
            Ok(())
        })?;
        self.each_faces(|piece| {
            mesh.triangles.extend_from_slice(&piece.faces);
            Ok(())
        })?;
        Ok(mesh)
    }
}

/// The faces of a piece that are meant, their patches and blocks.
fn chosen(piece: &FacePiece, part: BoundaryPart) -> (Vec<[u32; 3]>, [Vec<i32>; 2]) {
    let at = |values: &[i32], i: usize| values.get(i).copied().unwrap_or(0);
    let mut out = (Vec::with_capacity(piece.faces.len()), [const { Vec::new() }; 2]);
    for (i, &face) in piece.faces.iter().enumerate() {
        let patch = at(&piece.patches, i);
        if part.has(patch) {
            out.0.push(face);
            out.1[0].push(patch);
            out.1[1].push(at(&piece.blocks, i));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::tube_lattice;
    use crate::{VolumeMesh, adjacency::boundary_faces};

    fn tube() -> VolumeMesh {
        let mesh = tube_lattice(3, 4, 0.3);
        let boundary = boundary_faces(&mesh);
        let foot = |f: &[u32; 3]| f.iter().all(|&v| mesh.points[v as usize].z < 0.1);
        let boundary_patch = boundary.iter().map(|f| if foot(f) { 2 } else { WALL }).collect();
        VolumeMesh { mesh, boundary, boundary_patch, ..VolumeMesh::default() }
    }

    #[test]
    fn points_that_no_face_has_are_left_out() {
        let volume = tube();
        for (which, faces) in [
            (BoundaryPart::Whole, volume.boundary.len()),
            (BoundaryPart::Wall, volume.boundary_patch.iter().filter(|&&p| p == WALL).count()),
        ] {
            let surface = BoundarySurface::new(&volume, which).unwrap();
            let gathered = surface.gather().unwrap();
            assert_eq!(surface.counts().boundary, faces);
            assert_eq!((gathered.triangles.len(), gathered.points.len()), (faces, surface.counts().points));
            assert!(gathered.points.len() < volume.mesh.points.len());
            let mut used = gathered.triangles.as_flattened().to_vec();
            used.sort_unstable();
            used.dedup();
            assert_eq!(used.len(), gathered.points.len());
            let mut corners = Vec::new();
            surface
                .each_corners(|some| {
                    corners.extend_from_slice(some);
                    Ok(())
                })
                .unwrap();
            let expected: Vec<_> = gathered.triangles.iter().map(|t| t.map(|v| gathered.points[v as usize])).collect();
            assert_eq!(corners, expected);
        }
    }

    #[test]
    fn a_face_of_no_point_is_an_error() {
        let mut volume = tube();
        volume.boundary[3][1] = 100_000;
        let error = BoundarySurface::new(&volume, BoundaryPart::Whole).err().unwrap();
        assert_eq!(error.kind(), io::ErrorKind::InvalidData);
    }
}
