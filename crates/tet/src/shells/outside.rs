//! Self-intersections of the closed surface around shells.

use super::shell::{Given, of_caps};
use crate::error::TetError;
use crate::layers::Numbers;
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::predicates::collinear;
use anastomesh_mesh::geometry::{Aabb, Bvh, Contact, Point3, classify};
use rayon::prelude::*;

/// Triangles that are tested between two checks for cancellation.
const BATCH: usize = 1 << 16;

/// Closed surface around the shells with its obstacles, in the numbers of the stack.
///
/// Only triangles that have moved are tested again.
pub(super) struct Outside<'a> {
    triangles: Vec<[u32; 3]>,
    /// Triangle of the surface that each of these comes from; those of obstacles have none.
    origins: Vec<[u32; 3]>,
    around: Option<&'a TriMesh>,
    tested: Option<Tested>,
}

/// State of the last test.
struct Tested {
    /// Boxes of all triangles at the first test.
    tree: Bvh,
    /// Positions at the last test.
    points: Vec<Point3>,
    /// True for triangles that have moved since the first test.
    moved: Vec<bool>,
    /// Pairs that intersect.
    meeting: Vec<[u32; 2]>,
}

impl<'a> Outside<'a> {
    pub fn new(numbers: &Numbers, given: &Given<'a>) -> Self {
        let Given { surface, wall, caps, around, .. } = *given;
        let layers = numbers.layers();
        let mut triangles: Vec<[u32; 3]> = wall.iter().map(|t| t.map(|v| numbers.copy(v, layers))).collect();
        let mut origins = wall.to_vec();
        for (_, cap) in of_caps(surface, caps) {
            let ring = numbers.ring(&cap);
            let base = |t: &[u32; 3]| t.map(|v| numbers.origin(v));
            origins.extend(cap.iter().copied().chain(ring.iter().map(|(_, t)| base(t))));
            triangles.extend(cap.into_iter().chain(ring.into_iter().map(|(_, t)| t)));
        }
        if let Some(around) = around {
            triangles.extend(around.triangles.iter().map(|t| t.map(|v| v + numbers.len())));
        }
        Self { triangles, origins, around, tested: None }
    }

    /// Triangles of the surface whose images intersect something, for these positions of all copies.
    ///
    /// # Errors
    /// [`TetError::Cancelled`].
    pub fn meeting(&mut self, points: &[Point3], watch: &Watch) -> Result<Vec<[u32; 3]>, TetError> {
        let mut points = points.to_vec();
        points.extend(self.around.iter().flat_map(|around| &around.points));
        let tested = match self.tested.take() {
            None => self.first(points, watch)?,
            Some(before) => self.again(before, points, watch)?,
        };
        let met = tested.meeting.as_flattened().iter().filter_map(|&t| self.origins.get(t as usize).copied()).collect();
        self.tested = Some(tested);
        Ok(met)
    }

    /// Tests all pairs.
    fn first(&self, points: Vec<Point3>, watch: &Watch) -> Result<Tested, TetError> {
        let boxes = self.triangles.par_iter().map(|t| of_triangle(&points, *t)).collect();
        let tree = Bvh::of(boxes);
        let all: Vec<u32> = (0..self.triangles.len() as u32).collect();
        let meeting = self.pairs(
            &points,
            &all,
            |i, found| {
                tree.query(&of_triangle(&points, self.triangles[i as usize]), |j| {
                    if j > i {
                        found.push(j);
                    }
                });
            },
            watch,
        )?;
        Ok(Tested { tree, points, moved: vec![false; self.triangles.len()], meeting })
    }

    /// Tests the triangles that have moved since the last test, and keeps the other results.
    fn again(&self, before: Tested, points: Vec<Point3>, watch: &Watch) -> Result<Tested, TetError> {
        let Tested { tree, points: last, mut moved, mut meeting } = before;
        let has_moved = |t: &[u32; 3]| t.iter().any(|&v| points[v as usize] != last[v as usize]);
        let is_new: Vec<bool> = self.triangles.par_iter().map(has_moved).collect();
        let ids = |of: &[bool]| (0..).zip(of).filter(|(_, is)| **is).map(|(i, _)| i).collect::<Vec<u32>>();
        for (moved, is_new) in moved.iter_mut().zip(&is_new) {
            *moved |= is_new;
        }
        let (new, ever) = (ids(&is_new), ids(&moved));
        let current = Bvh::of(ever.iter().map(|&i| of_triangle(&points, self.triangles[i as usize])).collect());
        meeting.retain(|pair| !pair.iter().any(|&t| is_new[t as usize]));
        let near = |i: u32, found: &mut Vec<u32>| {
            let own = of_triangle(&points, self.triangles[i as usize]);
            tree.query(&own, |j| {
                if !moved[j as usize] {
                    found.push(j);
                }
            });
            current.query(&own, |k| {
                let j = ever[k as usize];
                // Of two that have moved, the first tests the pair.
                if j != i && (j > i || !is_new[j as usize]) {
                    found.push(j);
                }
            });
        };
        meeting.extend(self.pairs(&points, &new, near, watch)?.into_iter().map(|[i, j]| [i.min(j), i.max(j)]));
        meeting.sort_unstable();
        Ok(Tested { tree, points, moved, meeting })
    }

    /// Intersecting pairs of some triangles and those that `near` adds to a list for each.
    fn pairs(
        &self,
        points: &[Point3],
        of: &[u32],
        near: impl Fn(u32, &mut Vec<u32>) + Sync,
        watch: &Watch,
    ) -> Result<Vec<[u32; 2]>, TetError> {
        let triangle = |i: u32| self.triangles[i as usize];
        let tests = |found: &mut Vec<u32>, i: u32| {
            found.clear();
            near(i, found);
            found.sort_unstable();
            let meets = |j: &&u32| matches!(classify(points, triangle(i), triangle(**j)), Contact::Improper(_));
            found.iter().filter(meets).map(|&j| [i, j]).collect::<Vec<_>>()
        };
        let mut all = Vec::new();
        for batch in of.chunks(BATCH) {
            watch.ask()?;
            all.par_extend(batch.par_iter().map_init(Vec::new, |found, &i| tests(found, i)).flatten_iter());
        }
        Ok(all)
    }
}

/// Box of a triangle; those without area meet nothing.
fn of_triangle(points: &[Point3], triangle: [u32; 3]) -> Aabb {
    let [a, b, c] = triangle.map(|v| &points[v as usize]);
    if collinear(a, b, c) { Aabb::EMPTY } else { Aabb::of_points([a, b, c]) }
}
