//! Whether a surface meets itself: all pairs of triangles with overlapping boxes, tested exactly, until what is found
//! is enough for an answer.

use super::error::{Obstacle, Stuck, TetError};
use super::input::Offenders;
use super::progress::{Stage, Watch};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::adjacency::vertices_of;
use anastomesh_mesh::geometry::predicates::{collinear, orient2d, orient3d};
use anastomesh_mesh::geometry::{Aabb, Bvh, Contact, Point3, classify};

/// Pairs tested after which counting ends once a pair has been found.
const ENOUGH: usize = 20_000_000;

/// Pairs tested after which the search ends in any case: only triangles whose boxes all overlap come to so many.
const MOST: usize = 2_000_000_000;

/// Triangles between two reports.
const STEP: usize = 4096;

/// Checks that no two triangles have more in common than the vertices they share by id. Triangles without area are
/// left out.
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

/// The pairs of triangles that have more in common than that; not all where there are very many.
pub(super) fn contacts(surface: &TriMesh) -> Vec<[u32; 2]> {
    let mut found = Vec::new();
    // Nobody watches, so nothing is cancelled.
    let _ = each_contact(surface, &Watch::NOBODY, |pair| found.push(pair));
    found
}

/// Calls `found` for each such pair; whether these are all.
fn each_contact(surface: &TriMesh, watch: &Watch, mut found: impl FnMut([u32; 2])) -> Result<bool, TetError> {
    let (points, triangles) = (&surface.points, &surface.triangles);
    let boxes = boxes_of(surface);
    let tree = Bvh::new(&boxes);
    let (mut near, mut tests, mut any) = (Vec::new(), 0_usize, false);
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
        for &j in &near {
            if let Contact::Improper(_) = classify(points, triangles[i], triangles[j as usize]) {
                any = true;
                found([i as u32, j]);
            }
        }
        if tests > MOST || (tests > ENOUGH && any) {
            return Ok(i + 1 == boxes.len());
        }
    }
    Ok(true)
}

/// Checks that no point that is none of a triangle's vertices lies in a triangle.
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
            met = met.or_else(|| place_in(corners, p).map(|place| (triangles[t as usize], place)));
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

/// The boxes of the triangles that have area.
fn boxes_of(surface: &TriMesh) -> Vec<Aabb> {
    let of_triangle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| &surface.points[v as usize]);
        if collinear(a, b, c) { Aabb::EMPTY } else { Aabb::of_points([a, b, c]) }
    };
    surface.triangles.iter().map(of_triangle).collect()
}

/// Where in a triangle a point lies.
#[derive(Clone, Copy)]
enum TrianglePlace {
    Inside,
    /// On the edge from this vertex to the next.
    Edge(usize),
}

/// Where in a triangle with area a point lies; none when it is not in the triangle. Exact.
fn place_in([a, b, c]: [&Point3; 3], p: &Point3) -> Option<TrianglePlace> {
    if orient3d(a, b, c, p) != 0.0 {
        return None;
    }
    // In one of the coordinate planes the shadow has area, too.
    let shadows = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [a, b, c, p].map(|q| [q[i], q[j]]));
    let [a, b, c, p] = shadows.into_iter().find(|[a, b, c, _]| orient2d(*a, *b, *c) != 0.0)?;
    let turn = orient2d(a, b, c).signum();
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| turn * orient2d(from, to, p));
    let on_edge = sides.iter().position(|&side| side == 0.0);
    sides.iter().all(|&side| side >= 0.0).then(|| on_edge.map_or(TrianglePlace::Inside, TrianglePlace::Edge))
}
