//! Delaunay tetrahedralization by incremental insertion along a Hilbert curve in random rounds.
//!
//! The order is that of Amenta, Choi and Rote ('Incremental constructions con BRIO', 2003). Points are located by a
//! visibility walk and inserted into Bowyer–Watson cavities. All predicates are exact.
//!
//! A symbolic perturbation of the lifts decides cospherical points (Devillers, Teillaud, 'Perturbations and Delaunay
//! triangulations in 3D', 2003). It depends on coordinates alone, so the result is unique for any order of the points,
//! and has no flat tetrahedra. Large sets are therefore split in two, tetrahedralized in parallel and merged.

mod conflict;
mod insert;
mod merge;
mod order;
mod ordered;
mod parallel;
mod perturb;
mod sequence;

use super::complex::Complex;
use super::error::TetError;
use super::progress::Watch;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::in_exact_range;
use order::brio;
pub(super) use order::hash;
use ordered::Ordered;
use sequence::insert_all;

/// Computes the Delaunay tetrahedralization of points, with ghosts around the hull. Vertices are numbered like points.
///
/// # Errors
/// [`TetError::Empty`], [`TetError::OutOfRange`], [`TetError::DuplicatePoints`], [`TetError::Flat`].
pub fn delaunay(points: &[Point3]) -> Result<Complex, TetError> {
    delaunay_watched(points, &Watch::NOBODY)
}

/// As [`delaunay`], with a watch.
///
/// # Errors
/// As [`delaunay`]; [`TetError::Cancelled`] if the watch cancels.
pub(super) fn delaunay_watched(points: &[Point3], watch: &Watch) -> Result<Complex, TetError> {
    Ok(delaunay_ordered(points, watch)?.into_complex(points))
}

/// As [`delaunay_watched`], in the order of insertion.
///
/// # Errors
/// As [`delaunay_watched`].
pub(super) fn delaunay_ordered(points: &[Point3], watch: &Watch) -> Result<Ordered, TetError> {
    validate(points)?;
    if points.len() >= parallel::SPLIT_FROM
        && let Some(made) = parallel::tetrahedralize(points, watch)
    {
        return Ok(made);
    }
    let order = brio(points);
    let (cells, free, vertex_tet) = insert_all(points, &order, watch)?.finish();
    let sorted = order.iter().map(|&i| points[i as usize]).collect();
    Ok(Ordered { complex: Complex::from_cells(sorted, cells, free, vertex_tet), order })
}

fn validate(points: &[Point3]) -> Result<(), TetError> {
    if points.is_empty() {
        return Err(TetError::Empty { points: 0, triangles: 0 });
    }
    // Half-faces are numbered 4 × tetrahedron + face in a `u32`, with about seven tetrahedra per point.
    if points.len() > (u32::MAX / 64) as usize {
        return Err(TetError::TooLarge { points: points.len() });
    }
    match points.iter().position(|p| !p.iter().all(|&x| in_exact_range(x))) {
        Some(i) => Err(TetError::OutOfRange { points: vec![i as u32], count: 1, position: points[i] }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
