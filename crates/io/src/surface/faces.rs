//! Conversion of polygonal faces to triangles.

use super::content::SurfaceContent;
use super::error::SurfaceFault;
use crate::text::Place;
use crate::text::from_first;
use anastomesh_mesh::facets;
use anastomesh_mesh::geometry::Point3;

/// Completed faces, and the corners of the current face.
#[derive(Debug)]
pub(super) struct Faces {
    /// Number of points.
    points: usize,
    /// Number of the first point, and of the first face, in the file.
    first: u32,
    triangles: Vec<[u32; 3]>,
    polygons: Vec<Polygon>,
    open: Vec<u32>,
}

/// Face with more than three corners.
#[derive(Debug)]
struct Polygon {
    /// Number of triangles before it.
    before: usize,
    /// Face index.
    face: usize,
    corners: Vec<u32>,
    place: Place,
}

impl Faces {
    /// Creates an empty list with capacity for `room` faces; `points` are numbered from `first`.
    pub(super) fn new(points: usize, first: u32, room: usize) -> Self {
        Self { points, first, triangles: Vec::with_capacity(room), polygons: Vec::new(), open: Vec::new() }
    }

    /// Number of complete faces.
    fn count(&self) -> usize {
        self.triangles.len() + self.polygons.len()
    }

    /// Number of the current face in the file.
    pub(super) fn number(&self) -> usize {
        self.count() + self.first as usize
    }

    /// Adds a corner to the current face, as numbered in the file.
    pub(super) fn corner(&mut self, named: i64, place: Place) -> Result<(), SurfaceFault> {
        let (points, first) = (self.points, self.first);
        let bad = || SurfaceFault::BadIndex { face: self.number(), index: named, points, first, place };
        let corner = from_first(named, first, points).ok_or_else(bad)?;
        self.open.push(corner);
        Ok(())
    }

    /// Completes the current face.
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

    /// Converts all faces to triangles; those of polygons are in place.
    pub(super) fn into_surface(self, points: Vec<Point3>) -> Result<SurfaceContent, SurfaceFault> {
        let first = self.first;
        let mut content = SurfaceContent { first, ..SurfaceContent::default() };
        content.mesh.points = points;
        if self.polygons.is_empty() {
            content.mesh.triangles = self.triangles;
            return Ok(content);
        }
        let mut pieces = Pieces { content, face: 0 };
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

/// Triangles with their original faces.
struct Pieces {
    content: SurfaceContent,
    face: u32,
}

impl Pieces {
    fn add_face(&mut self, triangles: &[[u32; 3]]) {
        self.content.mesh.triangles.extend_from_slice(triangles);
        self.content.face_of.resize(self.content.mesh.triangles.len(), self.face);
        self.face += 1;
    }
}
