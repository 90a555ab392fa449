//! Constraints inside a region: baffles, segments and single points, which layers must leave alone.

use super::local::Local;
use crate::error::{Obstacle, Stuck, TetError};
use crate::plc::LeftOut;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, point_segment};
use anastomesh_mesh::{TetMesh, TriMesh};

/// Constraints inside a region. All numbers are those of the region.
pub(super) struct Constraints {
    /// True for points of the boundary with a baffle or a segment. They get no layers.
    pub is_pinned: Vec<bool>,
    /// Points off the boundary that the mesh must have.
    points: Vec<u32>,
    segments: Vec<[u32; 2]>,
}

impl Constraints {
    pub(super) fn of(local: &Local) -> Self {
        let (boundary, baffles) = local.surface.triangles.split_at(local.boundary());
        let count = local.surface.points.len();
        let (mut is_boundary, mut is_pinned) = (vec![false; count], vec![false; count]);
        boundary.as_flattened().iter().for_each(|&v| is_boundary[v as usize] = true);
        let held = baffles.as_flattened().iter().chain(local.segments.as_flattened());
        held.for_each(|&v| is_pinned[v as usize] = is_boundary[v as usize]);
        let points = (0..count as u32).filter(|&v| !is_boundary[v as usize]).collect();
        Self { is_pinned, points, segments: local.segments.clone() }
    }

    /// Limits half widths at vertices to the distance from points and segments, which rays do not meet.
    pub(super) fn limit(&self, widths: &mut [f64], points: &[Point3]) {
        let singles = self.points.iter().map(|&v| [v, v]);
        let obstacles: Vec<[u32; 2]> = self.segments.iter().copied().chain(singles).collect();
        if obstacles.is_empty() {
            return;
        }
        let ends = |i: u32| obstacles[i as usize].map(|v| &points[v as usize]);
        let boxes: Vec<Aabb> = (0..obstacles.len() as u32).map(|i| Aabb::of_points(ends(i))).collect();
        let tree = Bvh::new(&boxes);
        for (p, width) in points.iter().zip(widths).filter(|(_, width)| **width > 0.0) {
            let mut nearest = *width;
            tree.query(&Aabb::of_points([p]).grown(*width), |i| {
                let [a, b] = ends(i);
                nearest = nearest.min(point_segment(p, a, b).1);
            });
            *width = nearest;
        }
    }

    /// Checks that the mesh inside the layers has all constraints.
    ///
    /// # Errors
    /// [`TetError::Stuck`] with the wall triangle nearest to a constraint that is not in the mesh.
    pub(super) fn check(
        &self,
        (mesh, left_out): (&TetMesh, &LeftOut),
        inner: &TriMesh,
        wall: &[[u32; 3]],
    ) -> Result<(), TetError> {
        let mut is_used = vec![false; mesh.points.len()];
        mesh.tets.as_flattened().iter().for_each(|&v| is_used[v as usize] = true);
        let point = self.points.iter().copied().find(|&v| !is_used[v as usize]);
        let segment = left_out.segments.first().map(|&i| self.segments[i as usize][0]);
        let triangle = left_out.triangles.first().map(|&i| inner.triangles[i as usize][0]);
        let Some(lost) = point.or(segment).or(triangle) else { return Ok(()) };
        let to = inner.points[lost as usize];
        let distance = |t: &[u32; 3]| t.iter().map(|&v| (inner.points[v as usize] - to).norm()).sum::<f64>();
        let nearest = wall.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let part = nearest.map_or(Obstacle::Point(lost), |&t| Obstacle::Triangle(t));
        Err(TetError::Stuck { part, reason: Stuck::Layer })
    }
}
