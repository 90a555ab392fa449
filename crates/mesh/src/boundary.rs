//! Boundary of a mesh as a separate surface, read in passes: its points are renumbered, all others left out.

use super::bits::Bits;
use super::source::{FacePiece, MeshSource, SourceCounts};
use super::{TriMesh, WALL};
use crate::geometry::Point3;
use std::io;

/// Part of a boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundaryPart {
    /// All faces: the surface is closed.
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

/// Boundary of a mesh. Stores only one bit per point.
pub struct BoundarySurface<'a> {
    mesh: &'a dyn MeshSource,
    part: BoundaryPart,
    used: Bits,
    points: usize,
    triangles: usize,
}

impl<'a> BoundarySurface<'a> {
    /// Counts its points and faces in one pass over the boundary.
    ///
    /// # Errors
    /// Errors of reading the mesh; `InvalidData` if a face refers to a missing point.
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

    /// Mesh with this boundary.
    pub fn mesh(&self) -> &'a dyn MeshSource {
        self.mesh
    }

    /// Number of points and faces; no tetrahedra.
    pub fn counts(&self) -> SourceCounts {
        SourceCounts { points: self.points, tets: 0, boundary: self.triangles }
    }

    /// Passes on its points.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_points(&self, mut each: impl FnMut(&[Point3]) -> io::Result<()>) -> io::Result<()> {
        let mut before = 0;
        self.mesh.each_points(|points| {
            let own = (before..).zip(points).filter(|(v, _)| self.used.has(*v)).map(|(_, p)| *p);
            before += points.len() as u32;
            each(&own.collect::<Vec<_>>())
        })
    }

    /// Passes on its faces, with its own point numbers.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_faces(&self, mut each: impl FnMut(&FacePiece) -> io::Result<()>) -> io::Result<()> {
        let ranks = self.used.ranks();
        self.mesh.each_faces(|piece| {
            let (mut faces, [patches, blocks]) = chosen(piece, self.part);
            faces.as_flattened_mut().iter_mut().for_each(|v| *v = ranks.rank(*v));
            each(&FacePiece { faces: faces.into(), patches: patches.into(), blocks: blocks.into() })
        })
    }

    /// Passes on the corners of its faces.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_corners(&self, mut each: impl FnMut(&[[Point3; 3]]) -> io::Result<()>) -> io::Result<()> {
        let read = |part| {
            let piece = self.mesh.boundary(part)?;
            Ok((piece.faces.len(), self.mesh.corners_of(&chosen(&piece, self.part).0)?))
        };
        let expected = self.mesh.counts().boundary;
        self.mesh.in_order(expected, read, |(count, _)| *count, |(_, corners)| each(corners))
    }

    /// Loads the surface into memory.
    ///
    /// # Errors
    /// Errors of reading the mesh.
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

/// Chosen faces of a piece, with their patches and blocks.
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
