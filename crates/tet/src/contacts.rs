//! Exact search for self-intersections: tests all pairs of triangles with overlapping boxes, up to a limit.

use super::error::{Obstacle, Stuck, TetError};
use super::input::Offenders;
use super::progress::{Stage, Watch};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::adjacency::vertices_of;
use anastomesh_mesh::geometry::predicates::{collinear, orient2d, orient3d};
use anastomesh_mesh::geometry::{Aabb, Bvh, Contact, Point3, classify};

/// Pairs tested after which counting ends if an intersection has been found.
const MAX_PAIRS_AFTER_HIT: usize = 20_000_000;

/// Pairs tested after which the search ends in any case. Only triangles with mutually overlapping boxes reach this.
const MOST: usize = 2_000_000_000;

/// Triangles between two progress reports.
const STEP: usize = 4096;

/// Pairs tested between two checks for cancellation and the budget.
const ASKED_EVERY: usize = 100_000;

/// Checks that two triangles share only their common vertices by index. Triangles without area are left out.
///
/// # Errors
/// [`TetError::SelfIntersection`]; [`TetError::Cancelled`].
pub(super) fn no_contacts(surface: &TriMesh, watch: &Watch) -> Result<(), TetError> {
    let mut found: Offenders<[u32; 2]> = Offenders { named: Vec::new(), count: 0 };
    let complete = each_contact(surface, watch, |pair| found.add(pair))?;
    if found.count == 0 {
        return Ok(());
    }
    Err(TetError::SelfIntersection { pairs: found.named, count: found.count, complete })
}

/// Pairs of intersecting triangles; incomplete if their number exceeds the limit.
pub(super) fn contacts(surface: &TriMesh) -> Vec<[u32; 2]> {
    let mut found = Vec::new();
    // Without a watch, nothing is cancelled.
    let _ = each_contact(surface, &Watch::NOBODY, |pair| found.push(pair));
    found
}

/// Pairs of intersecting triangles, as [`contacts`].
///
/// # Errors
/// [`TetError::Cancelled`], [`TetError::OverBudget`].
pub(super) fn contacts_within(surface: &TriMesh, watch: &Watch) -> Result<Vec<[u32; 2]>, TetError> {
    let mut found = Vec::new();
    each_contact(surface, watch, |pair| found.push(pair))?;
    Ok(found)
}

/// Calls `found` for each intersecting pair. Returns true if the search was complete.
fn each_contact(surface: &TriMesh, watch: &Watch, mut found: impl FnMut([u32; 2])) -> Result<bool, TetError> {
    let (points, triangles) = (&surface.points, &surface.triangles);
    let boxes = boxes_of(surface);
    let tree = Bvh::new(&boxes);
    let (mut near, mut tests, mut any, mut counted) = (Vec::new(), 0_usize, false, 0);
    for (i, aabb) in boxes.iter().enumerate() {
        if i.is_multiple_of(STEP) {
            watch.report(Stage::Validate, i, boxes.len())?;
        }
        near.clear();
        tree.query(aabb, |j| {
            if j as usize > i {
                near.push(j);
            }
        });
        near.sort_unstable();
        tests += near.len() + 1;
        if tests - counted > ASKED_EVERY {
            watch.spend(tests - counted)?;
            counted = tests;
        }
        for &j in &near {
            if let Contact::Improper(_) = classify(points, triangles[i], triangles[j as usize]) {
                any = true;
                found([i as u32, j]);
            }
        }
        if tests > MOST || (tests > MAX_PAIRS_AFTER_HIT && any) {
            return Ok(i + 1 == boxes.len());
        }
    }
    Ok(true)
}

/// Checks that no point lies in a triangle without being its vertex.
///
/// # Errors
/// [`TetError::EdgeMeets`], or [`TetError::Stuck`] with the triangle that has the point inside.
pub(super) fn no_points_in_triangles(surface: &TriMesh) -> Result<(), TetError> {
    let (points, triangles) = (&surface.points, &surface.triangles);
    let used = vertices_of(triangles, points.len());
    if used.iter().all(|&used| used) {
        return Ok(());
    }
    let tree = Bvh::new(&boxes_of(surface));
    for (v, p) in (0..).zip(points).filter(|&(v, _)| !used[v as usize]) {
        let mut met = None;
        tree.query(&Aabb::of_points([p]), |t| {
            let corners = triangles[t as usize].map(|v| &points[v as usize]);
            met = met.or_else(|| locate_in_triangle(corners, p).map(|place| (triangles[t as usize], place)));
        });
        if let Some((triangle, place)) = met {
            return Err(match place {
                TrianglePlace::Inside => {
                    TetError::Stuck { part: Obstacle::Triangle(triangle), reason: Stuck::Intersection }
                }
                TrianglePlace::Edge(k) => {
                    let edge = [triangle[k], triangle[(k + 1) % 3]];
                    TetError::EdgeMeets { edge, obstacle: Obstacle::Point(v) }
                }
            });
        }
    }
    Ok(())
}

/// Bounding boxes of the triangles with area.
fn boxes_of(surface: &TriMesh) -> Vec<Aabb> {
    let of_triangle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| &surface.points[v as usize]);
        if collinear(a, b, c) { Aabb::EMPTY } else { Aabb::of_points([a, b, c]) }
    };
    surface.triangles.iter().map(of_triangle).collect()
}

/// Position of a point in a triangle.
#[derive(Clone, Copy)]
enum TrianglePlace {
    Inside,
    /// On the edge from this vertex to the next.
    Edge(usize),
}

/// Exact position of a point in a triangle with area; `None` if it is outside.
fn locate_in_triangle([a, b, c]: [&Point3; 3], p: &Point3) -> Option<TrianglePlace> {
    if orient3d(a, b, c, p) != 0.0 {
        return None;
    }
    // The projection to one of the coordinate planes has area, too.
    let shadows = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [a, b, c, p].map(|q| [q[i], q[j]]));
    let [a, b, c, p] = shadows.into_iter().find(|[a, b, c, _]| orient2d(*a, *b, *c) != 0.0)?;
    let turn = orient2d(a, b, c).signum();
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| turn * orient2d(from, to, p));
    let on_edge = sides.iter().position(|&side| side == 0.0);
    sides.iter().all(|&side| side >= 0.0).then(|| on_edge.map_or(TrianglePlace::Inside, TrianglePlace::Edge))
}
