//! Parts of the input outside the filled volume: triangles and segments surrounded only by the outside or by holes.

use super::carve::Sides;
use super::complex::Complex;
use super::error::{NAMED, TetError};
use super::plc::InputPart;
use super::plc::LeftOut;
use super::star::{EdgeRing, Star};
use anastomesh_mesh::TriMesh;
use std::borrow::Cow;

impl LeftOut {
    /// Finds the outside parts in a complex with all of the input.
    ///
    /// # Errors
    /// [`TetError::NotRecovered`] if the complex lacks something.
    pub(super) fn find(c: &Complex, sides: &Sides, surface: &TriMesh, segments: &[[u32; 2]]) -> Result<Self, TetError> {
        let mut found = Self::default();
        let (mut lost_edges, mut lost_triangles) = (Vec::new(), Vec::new());
        let mut star = Star::default();
        if sides.has_faces_outside(c) {
            for (&triangle, i) in surface.triangles.iter().zip(0..) {
                match star.find_face(c, triangle) {
                    None => lost_triangles.push(i),
                    Some(half) if sides.outside_of_both(c, half) => found.triangles.push(i),
                    Some(_) => {}
                }
            }
        }
        let mut ring = EdgeRing::default();
        for (&[a, b], i) in segments.iter().zip(0..) {
            match star.find_edge(c, a, b) {
                Some(t) if ring.collect(c, t, a, b, usize::MAX) => {
                    if !ring.tets.iter().any(|&t| sides.is_inside(t)) {
                        found.segments.push(i);
                    }
                }
                _ => lost_edges.push([a, b]),
            }
        }
        if lost_edges.is_empty() && lost_triangles.is_empty() {
            return Ok(found);
        }
        Err(TetError::NotRecovered { edges: lost_edges, triangles: lost_triangles })
    }

    /// Error for left-out parts where none are allowed.
    pub(super) fn as_error(&self) -> Option<TetError> {
        let (part, ids) = match (self.triangles.as_slice(), self.segments.as_slice()) {
            ([], []) => return None,
            ([], segments) => (InputPart::Segments, segments),
            (triangles, _) => (InputPart::Triangles, triangles),
        };
        Some(TetError::Outside { part, ids: ids.iter().take(NAMED).copied().collect(), count: ids.len() })
    }

    /// Surface without the left-out parts; all points stay.
    pub(super) fn kept_surface<'a>(&self, surface: &'a TriMesh) -> Cow<'a, TriMesh> {
        if self.triangles.is_empty() {
            return Cow::Borrowed(surface);
        }
        let triangles = without(&surface.triangles, &self.triangles);
        Cow::Owned(TriMesh { points: surface.points.clone(), triangles })
    }
}

/// Items except those with the ascending ids in `dropped`.
pub(super) fn without<T: Copy>(items: &[T], dropped: &[u32]) -> Vec<T> {
    let mut dropped = dropped.iter().copied().peekable();
    items.iter().zip(0_u32..).filter(|(_, i)| dropped.next_if_eq(i).is_none()).map(|(item, _)| *item).collect()
}
