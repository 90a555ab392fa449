//! Delaunay tetrahedralization: incremental insertion along a Hilbert curve in random rounds (Amenta, Choi, Rote,
//! 'Incremental constructions con BRIO', 2003), location by walking, Bowyer–Watson cavities, all decided exactly.
//!
//! Cospherical points are decided by a symbolic perturbation of their lifts (Devillers, Teillaud, 'Perturbations and
//! Delaunay triangulations in 3D', 2003), which depends on coordinates alone: the answer is unique, whatever the order
//! of the points, and has no flat tetrahedra. Large sets are therefore cut in two, which are tetrahedralized in parallel
//! and merged.

mod conflict;
mod insert;
mod merge;
mod order;
mod parallel;
mod perturb;

use super::complex::Complex;
use super::error::{NAMED, TetError};
use crate::geometry::Point3;
use crate::geometry::predicates::{collinear, in_exact_range, orient3d};
use insert::Inserter;
use order::brio;
pub(super) use order::hash;
pub use perturb::in_sphere_perturbed;

/// The Delaunay tetrahedralization of points, with ghosts around their convex hull. Vertices are numbered as the
/// points are.
///
/// # Errors
/// [`TetError::Empty`], [`TetError::OutOfRange`], [`TetError::DuplicatePoints`], [`TetError::Flat`].
pub fn delaunay(points: &[Point3]) -> Result<Complex, TetError> {
    validate(points)?;
    if points.len() >= parallel::SPLIT_FROM
        && let Some((cells, vertex_tet)) = parallel::tetrahedralize(points)
    {
        return Ok(Complex::from_cells(points.to_vec(), cells, Vec::new(), vertex_tet));
    }
    let order = brio(points);
    let inserter = insert_all(points, &order)?;
    let (cells, free, vertex_tet) = inserter.finish(&order);
    Ok(Complex::from_cells(points.to_vec(), cells, free, vertex_tet))
}

/// All points inserted in this order: vertex `v` of the inserter is the point `order[v]`.
fn insert_all(points: &[Point3], order: &[u32]) -> Result<Inserter, TetError> {
    let sorted: Vec<Point3> = order.iter().map(|&i| points[i as usize]).collect();
    let seed = seed_tet(&sorted).ok_or(TetError::Flat)?;
    let mut inserter = Inserter::new(&sorted);
    drop(sorted);
    inserter.start(seed);
    let mut duplicates: Vec<(u32, u32)> = Vec::new();
    for v in 0..order.len() as u32 {
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

fn validate(points: &[Point3]) -> Result<(), TetError> {
    if points.is_empty() {
        return Err(TetError::Empty { points: 0, triangles: 0 });
    }
    // Half-faces are numbered 4 × tetrahedron + face in a `u32`; there are about seven tetrahedra to a point.
    if points.len() > (u32::MAX / 64) as usize {
        return Err(TetError::TooLarge { points: points.len() });
    }
    match points.iter().position(|p| !p.iter().all(|&x| in_exact_range(x))) {
        Some(i) => Err(TetError::OutOfRange { points: vec![i as u32], count: 1, position: points[i] }),
        None => Ok(()),
    }
}

/// Four points that span a positive tetrahedron, the first such in order.
fn seed_tet(p: &[Point3]) -> Option<[u32; 4]> {
    let b = (1..p.len()).find(|&i| p[i] != p[0])?;
    let c = (b + 1..p.len()).find(|&i| !collinear(&p[0], &p[b], &p[i]))?;
    let d = (b + 1..p.len()).find(|&i| orient3d(&p[0], &p[b], &p[c], &p[i]) != 0.0)?;
    let flip = orient3d(&p[0], &p[b], &p[c], &p[d]) < 0.0;
    let (b, c, d) = (b as u32, c as u32, d as u32);
    Some(if flip { [0, c, b, d] } else { [0, b, c, d] })
}

#[cfg(test)]
mod tests;
