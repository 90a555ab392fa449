//! Faces on their way from a file to triangles.

use super::{Place, SurfaceFault};
use crate::geometry::Point3;
use crate::mesh::TriMesh;
use crate::mesh::facets;

/// The faces that were read so far, and the corners of the one that is being read.
#[derive(Debug)]
pub(super) struct Faces {
    /// How many points there will be.
    points: usize,
    /// The number of the first point in the file.
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
    pub(super) fn count(&self) -> usize {
        self.triangles.len() + self.polygons.len()
    }

    /// A corner of the face that is being read, as numbered in the file.
    pub(super) fn corner(&mut self, named: i64, place: Place) -> Result<(), SurfaceFault> {
        let (points, first) = (self.points, self.first);
        let from_zero = named.checked_sub(first.into()).and_then(|i| usize::try_from(i).ok());
        match from_zero {
            Some(i) if i < points => self.open.push(i as u32),
            _ => return Err(SurfaceFault::BadIndex { face: self.count(), index: named, points, first, place }),
        }
        Ok(())
    }

    /// The face that is being read is complete.
    pub(super) fn end_face(&mut self, place: Place) -> Result<(), SurfaceFault> {
        let face = self.count();
        match *self.open.as_slice() {
            [a, b, c] => {
                self.triangles.push([a, b, c]);
                self.open.clear();
            }
            ref few if few.len() < 3 => {
                return Err(SurfaceFault::NotATriangle { face, corners: few.len() as i64, place });
            }
            _ => {
                let corners = std::mem::take(&mut self.open);
                self.polygons.push(Polygon { before: self.triangles.len(), face, corners, place });
            }
        }
        Ok(())
    }

    /// The triangles, those of polygons in their place.
    pub(super) fn into_surface(self, points: Vec<Point3>) -> Result<TriMesh, SurfaceFault> {
        if self.polygons.is_empty() {
            return Ok(TriMesh { points, triangles: self.triangles });
        }
        let mut triangles = Vec::with_capacity(self.triangles.len() + 2 * self.polygons.len());
        let mut taken = 0;
        for Polygon { before, face, corners, place } in self.polygons {
            triangles.extend_from_slice(&self.triangles[taken..before]);
            taken = before;
            let pieces = facets::triangulate(&points, &[corners], &[]);
            triangles.extend(pieces.map_err(|fault| SurfaceFault::Polygon { face, place, fault })?.triangles);
        }
        triangles.extend_from_slice(&self.triangles[taken..]);
        Ok(TriMesh { points, triangles })
    }
}
