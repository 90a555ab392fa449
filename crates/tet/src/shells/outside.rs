//! Self-intersections of the closed surface around shells.

use super::shell::{Given, of_caps};
use crate::error::TetError;
use crate::layers::Numbers;
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::predicates::collinear;
use anastomesh_mesh::geometry::{Aabb, Bvh, Contact, Improper, Point3, classify, self_contacts_until};
use rayon::prelude::*;

/// Triangles that are tested between two checks for cancellation.
const BATCH: usize = 1 << 18;

/// Closed surface around the shells with its obstacles, in the numbers of the stack.
///
/// Only triangles that have moved are tested again.
pub(super) struct Outside<'a> {
    /// Outer sides of the wall's triangles, then rings and caps, then obstacles.
    triangles: Vec<[u32; 3]>,
    wall: &'a [[u32; 3]],
    /// Triangles of the surface that caps and rings come from; those of obstacles have none.
    of_caps: Vec<[u32; 3]>,
    around: Option<&'a TriMesh>,
    tested: Option<Tested>,
}

/// State of the last test.
struct Tested {
    points: Vec<Point3>,
    /// Pairs that intersect.
    meeting: Vec<[u32; 2]>,
}

impl<'a> Outside<'a> {
    pub fn new(numbers: &Numbers, given: &Given<'a>) -> Self {
        let Given { surface, wall, caps, around, .. } = *given;
        let layers = numbers.layers();
        let mut triangles: Vec<[u32; 3]> = wall.iter().map(|t| t.map(|v| numbers.copy(v, layers))).collect();
        let mut origins = Vec::new();
        for (_, cap) in of_caps(surface, caps) {
            let ring = numbers.ring(&cap);
            let base = |t: &[u32; 3]| t.map(|v| numbers.origin(v));
            origins.extend(cap.iter().copied().chain(ring.iter().map(|(_, t)| base(t))));
            triangles.extend(cap.into_iter().chain(ring.into_iter().map(|(_, t)| t)));
        }
        if let Some(around) = around {
            triangles.extend(around.triangles.iter().map(|t| t.map(|v| v + numbers.len())));
        }
        Self { triangles, wall, of_caps: origins, around, tested: None }
    }

    /// Triangles of the surface whose images intersect something, for these positions of all copies.
    ///
    /// # Errors
    /// [`TetError::Cancelled`].
    pub fn meeting(&mut self, mut points: Vec<Point3>, watch: &Watch) -> Result<Vec<[u32; 3]>, TetError> {
        points.extend(self.around.iter().flat_map(|around| &around.points));
        let meeting = match self.tested.take() {
            None => self.first(&points, watch)?,
            Some(before) => self.again(before, &points, watch)?,
        };
        let origin = |&t: &u32| {
            let t = t as usize;
            self.wall.get(t).or_else(|| self.of_caps.get(t - self.wall.len())).copied()
        };
        let met = meeting.as_flattened().iter().filter_map(origin).collect();
        self.tested = Some(Tested { points, meeting });
        Ok(met)
    }

    /// Positions of all copies at the last test.
    pub fn into_points(self, count: usize) -> Vec<Point3> {
        let mut points = self.tested.map_or_else(Vec::new, |tested| tested.points);
        points.truncate(count);
        points
    }

    /// Tests all pairs. Triangles without area meet nothing.
    fn first(&self, points: &[Point3], watch: &Watch) -> Result<Vec<[u32; 2]>, TetError> {
        let contacts = self_contacts_until(points, &self.triangles, &|| watch.ask().is_err());
        watch.ask()?;
        let meets = |(i, j, kind)| (kind != Improper::Degenerate).then_some([i, j]);
        Ok(contacts.into_iter().filter_map(meets).collect())
    }

    /// Tests the triangles that have moved since the last test, and keeps the other results.
    fn again(&self, before: Tested, points: &[Point3], watch: &Watch) -> Result<Vec<[u32; 2]>, TetError> {
        let Tested { points: last, mut meeting } = before;
        let has_moved = |t: &[u32; 3]| t.iter().any(|&v| points[v as usize] != last[v as usize]);
        let is_moved: Vec<bool> = self.triangles.par_iter().map(has_moved).collect();
        drop(last);
        meeting.retain(|pair| !pair.iter().any(|&t| is_moved[t as usize]));
        let triangle = |i: u32| self.triangles[i as usize];
        let moved: Vec<u32> = (0..).zip(&is_moved).filter(|(_, is)| **is).map(|(i, _)| i).collect();
        let tree = Bvh::of(moved.iter().map(|&i| of_triangle(points, triangle(i))).collect());
        let tests = |found: &mut Vec<u32>, i: u32| {
            found.clear();
            let corners = triangle(i).map(|v| &points[v as usize]);
            tree.query(&Aabb::of_points(corners), |k| found.push(moved[k as usize]));
            // Of two that have moved, the first tests the pair.
            found.retain(|&j| j != i && (j > i || !is_moved[i as usize]));
            if !found.is_empty() && is_flat(corners) {
                found.clear();
            }
            let meets = |j: &&u32| matches!(classify(points, triangle(i), triangle(**j)), Contact::Improper(_));
            found.iter().filter(meets).map(|&j| [i.min(j), i.max(j)]).collect::<Vec<_>>()
        };
        let count = self.triangles.len() as u32;
        for start in (0..count).step_by(BATCH) {
            watch.ask()?;
            let batch = (start..count.min(start + BATCH as u32)).into_par_iter();
            meeting.par_extend(batch.map_init(Vec::new, tests).flatten_iter());
        }
        meeting.sort_unstable();
        Ok(meeting)
    }
}

/// True for triangles without area, which meet nothing.
fn is_flat([a, b, c]: [&Point3; 3]) -> bool {
    collinear(a, b, c)
}

/// Box of a triangle, if it has area.
fn of_triangle(points: &[Point3], triangle: [u32; 3]) -> Aabb {
    let corners = triangle.map(|v| &points[v as usize]);
    if is_flat(corners) { Aabb::EMPTY } else { Aabb::of_points(corners) }
}
