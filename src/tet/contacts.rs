//! Whether a surface meets itself: all pairs of triangles with overlapping boxes, tested exactly, until what is found
//! is enough for an answer.

use super::error::TetError;
use super::input::Offenders;
use super::progress::{Stage, Watch};
use crate::geometry::predicates::collinear;
use crate::geometry::{Aabb, Bvh, Contact, classify};
use crate::mesh::TriMesh;

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
    let (points, triangles) = (&surface.points, &surface.triangles);
    let boxes: Vec<Aabb> = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| &points[v as usize]);
            if collinear(a, b, c) { Aabb::EMPTY } else { Aabb::of_points([a, b, c]) }
        })
        .collect();
    let tree = Bvh::new(&boxes);
    let mut found: Offenders<[u32; 2]> = Offenders { named: Vec::new(), count: 0 };
    let (mut near, mut tests) = (Vec::new(), 0_usize);
    let mut complete = true;
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
                found.add([i as u32, j]);
            }
        }
        if tests > MOST || (tests > ENOUGH && found.count > 0) {
            complete = i + 1 == boxes.len();
            break;
        }
    }
    if found.count == 0 {
        return Ok(());
    }
    Err(TetError::SelfIntersection { pairs: found.named, count: found.count, complete })
}
