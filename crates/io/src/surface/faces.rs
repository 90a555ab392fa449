//! Faces on their way from a file to triangles.

use super::content::SurfaceContent;
use super::error::SurfaceFault;
use crate::text::Place;
use crate::text::from_first;
use anastomesh_mesh::facets;
use anastomesh_mesh::geometry::Point3;

/// The faces that were read so far, and the corners of the one that is being read.
#[derive(Debug)]
pub(super) struct Faces {
    /// How many points there will be.
    points: usize,
    /// The number of the first point, and of the first face, in the file.
    first: u32,
    triangles: Vec<[u32; 3]>,
    polygons: Vec<Polygon>,
    open: Vec<u32>,
}

/// A face with more than three corners.
#[derive(Debug)]
struct Polygon {
    /// Triangles before it.
    before: usize,
    /// Its number among the faces.
    face: usize,
    corners: Vec<u32>,
    place: Place,
}

impl Faces {
    /// No faces yet, with room for some; `points` will be there, numbered from `first`.
    pub(super) fn new(points: usize, first: u32, room: usize) -> Self {
        Self { points, first, triangles: Vec::with_capacity(room), polygons: Vec::new(), open: Vec::new() }
    }

    /// How many faces are complete.
    fn count(&self) -> usize {
        self.triangles.len() + self.polygons.len()
    }

    /// The number in the file of the face that is being read.
    pub(super) fn number(&self) -> usize {
        self.count() + self.first as usize
    }

    /// A corner of the face that is being read, as numbered in the file.
    pub(super) fn corner(&mut self, named: i64, place: Place) -> Result<(), SurfaceFault> {
        let (points, first) = (self.points, self.first);
        let bad = || SurfaceFault::BadIndex { face: self.number(), index: named, points, first, place };
        let corner = from_first(named, first, points).ok_or_else(bad)?;
        self.open.push(corner);
        Ok(())
    }

    /// The face that is being read is complete.
    pub(super) fn end_face(&mut self, place: Place) -> Result<(), SurfaceFault> {
        let (face, number) = (self.count(), self.number());
        match *self.open.as_slice() {
            [a, b, c] => {
                self.triangles.push([a, b, c]);
                self.open.clear();
            }
            ref few if few.len() < 3 => {
                return Err(SurfaceFault::NotATriangle { face: number, corners: few.len() as i64, place });
            }
            _ => {
                let corners = std::mem::take(&mut self.open);
                self.polygons.push(Polygon { before: self.triangles.len(), face, corners, place });
            }
        }
        Ok(())
    }

    /// The triangles, those of polygons in their place.
    pub(super) fn into_surface(self, points: Vec<Point3>) -> Result<SurfaceContent, SurfaceFault> {
        let first = self.first;
        let mut content = SurfaceContent { first, ..SurfaceContent::default() };
        content.mesh.points = points;
        if self.polygons.is_empty() {
            content.mesh.triangles = self.triangles;
            return Ok(content);
        }
        let mut pieces = FacePieces { content, face: 0 };
        pieces.content.mesh.triangles.reserve(self.triangles.len() + 2 * self.polygons.len());
        let mut taken = 0;
        for Polygon { before, face, corners, place } in self.polygons {
            self.triangles[taken..before].iter().for_each(|&t| pieces.add_face(&[t]));
            taken = before;
            let cut = facets::triangulate(&pieces.content.mesh.points, &[corners], &[]);
            let cut = cut.map_err(|fault| {
                let fault = fault.renamed(|point| point + first);
                SurfaceFault::Polygon { face: face + first as usize, place, fault }
            })?;
            pieces.add_face(&cut.triangles);
        }
        self.triangles[taken..].iter().for_each(|&t| pieces.add_face(&[t]));
        Ok(pieces.content)
    }
}

/// Triangles with the faces that they are pieces of.
struct FacePieces {
    content: SurfaceContent,
    face: u32,
}

impl FacePieces {
    fn add_face(&mut self, triangles: &[[u32; 3]]) {
        self.content.mesh.triangles.extend_from_slice(triangles);
        self.content.face_of.resize(self.content.mesh.triangles.len(), self.face);
        self.face += 1;
    }
}
