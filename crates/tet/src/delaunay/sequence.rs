//! Sequential insertion of points.

use super::insert::Inserter;
use crate::error::{NAMED, TetError};
use crate::progress::Watch;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::{collinear, orient3d};

/// Points between two checks for cancellation: some milliseconds.
const CANCEL_INTERVAL: u32 = 1024;

/// Operations per inserted point, as counted by budgets.
const OPERATIONS: usize = 20;

/// Inserts all points in the given order: vertex `v` of the inserter is the point `order[v]`.
///
/// # Errors
/// [`TetError::Flat`], [`TetError::DuplicatePoints`], [`TetError::Cancelled`], [`TetError::OverBudget`].
pub(super) fn insert_all(points: &[Point3], order: &[u32], watch: &Watch) -> Result<Inserter, TetError> {
    let sorted: Vec<Point3> = order.iter().map(|&i| points[i as usize]).collect();
    let seed = seed_tet(&sorted).ok_or(TetError::Flat)?;
    let mut inserter = Inserter::new(&sorted);
    drop(sorted);
    inserter.start(seed);
    let mut duplicates: Vec<(u32, u32)> = Vec::new();
    for v in 0..order.len() as u32 {
        if v.is_multiple_of(CANCEL_INTERVAL) {
            watch.spend(OPERATIONS * CANCEL_INTERVAL as usize)?;
        }
        if !seed.contains(&v)
            && let Err(twin) = inserter.insert(v)
        {
            let (a, b) = (order[v as usize], order[twin as usize]);
            duplicates.push((a.min(b), a.max(b)));
        }
    }
    duplicates.sort_unstable_by_key(|&(_, second)| second);
    if let Some(&(first, _)) = duplicates.first() {
        let (count, position) = (duplicates.len(), points[first as usize]);
        let pairs = duplicates.iter().take(NAMED).map(|&(a, b)| [a, b]).collect();
        return Err(TetError::DuplicatePoints { pairs, count, position });
    }
    Ok(inserter)
}

/// First four points in order that span a positive tetrahedron.
fn seed_tet(p: &[Point3]) -> Option<[u32; 4]> {
    let b = (1..p.len()).find(|&i| p[i] != p[0])?;
    let c = (b + 1..p.len()).find(|&i| !collinear(&p[0], &p[b], &p[i]))?;
    let d = (b + 1..p.len()).find(|&i| orient3d(&p[0], &p[b], &p[c], &p[i]) != 0.0)?;
    let flip = orient3d(&p[0], &p[b], &p[c], &p[d]) < 0.0;
    let (b, c, d) = (b as u32, c as u32, d as u32);
    Some(if flip { [0, c, b, d] } else { [0, b, c, d] })
}
