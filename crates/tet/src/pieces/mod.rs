//! Filling of a large region in pieces, which are independent of each other.
//!
//! Interfaces divide the region until its pieces are small enough. Each depends on the piece that it divides alone, so that
//! the pieces do not depend on the number of threads.

mod band;
mod divide;
mod interface;
mod plane;
mod points;
mod sides;
#[cfg(test)]
mod tests;

use crate::builder::{Tetrahedralization, Tetrahedralizer, fill_spaced};
use crate::error::TetError;
use crate::input;
use crate::plc::InputKind;
use crate::progress::{Stage, Watch};
use anastomesh_mesh::adjacency::vertices_of;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{TetMesh, TriMesh};
use divide::divide;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A region, divided into pieces.
#[derive(Clone, Debug, Default)]
pub struct Pieces {
    /// Points of the region's surface, then those of interfaces.
    pub points: Vec<Point3>,
    /// Pieces, which fill the region.
    pub pieces: Vec<Piece>,
    /// Triangles of the region's surface, oriented outwards.
    pub faces: Vec<[u32; 3]>,
}

/// Piece of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Closed surface, oriented outwards.
    pub surface: TriMesh,
    /// Point of the region that each point is.
    pub numbers: Vec<u32>,
}

impl Pieces {
    /// Divides the region inside a closed surface that is oriented outwards, until pieces have at most `most` triangles or cannot
    /// be divided. Interior and sizing are those of the tetrahedralizer, as in [`fill_spaced`].
    ///
    /// # Errors
    /// [`TetError::Cancelled`].
    pub fn of(by: &Tetrahedralizer, surface: &TriMesh, most: usize, watch: &Watch) -> Result<Self, TetError> {
        let mut made = Self { points: surface.points.clone(), pieces: Vec::new(), faces: surface.triangles.clone() };
        let numbers = (0..surface.points.len() as u32).collect();
        let mut open = vec![Piece { surface: surface.clone(), numbers }];
        while !open.is_empty() {
            let is_large = |piece: &Piece| piece.surface.triangles.len() > most;
            let (large, small): (Vec<Piece>, Vec<Piece>) = open.into_iter().partition(is_large);
            made.pieces.extend(small);
            let cut = |piece: Piece| Ok((divide(by, &piece.surface, watch)?, piece));
            let cuts: Vec<_> = large.into_par_iter().map(cut).collect::<Result<_, TetError>>()?;
            let mut divided = Vec::new();
            for (cut, mut piece) in cuts {
                let Some(cut) = cut else {
                    made.pieces.push(piece);
                    continue;
                };
                let first = made.points.len() as u32;
                made.points.extend_from_slice(&cut.points);
                piece.numbers.extend(first..made.points.len() as u32);
                piece.surface.points.extend(cut.points);
                divided.push((piece, cut.halves));
            }
            let halves = divided.into_par_iter().map(|(piece, halves)| halves.map(|half| piece.part(half)));
            open = halves.collect::<Vec<_>>().into_iter().flatten().collect();
        }
        Ok(made)
    }
}

impl Piece {
    /// Number in the region of a point of the filled piece, whose own interior points begin at `first`.
    pub fn number(&self, v: u32, first: u32) -> u32 {
        self.numbers.get(v as usize).copied().unwrap_or_else(|| v - self.numbers.len() as u32 + first)
    }

    /// Part of a piece with these triangles.
    fn part(&self, mut triangles: Vec<[u32; 3]>) -> Self {
        let is_used = vertices_of(&triangles, self.numbers.len());
        let (mut own, mut points, mut numbers) = (vec![0; is_used.len()], Vec::new(), Vec::new());
        for v in (0..is_used.len()).filter(|&v| is_used[v]) {
            own[v] = points.len() as u32;
            points.push(self.surface.points[v]);
            numbers.push(self.numbers[v]);
        }
        triangles.as_flattened_mut().iter_mut().for_each(|v| *v = own[*v as usize]);
        Self { surface: TriMesh { points, triangles }, numbers }
    }
}

/// Fills a closed surface that is oriented outwards as [`fill_spaced`] does, in pieces of at most about `most` triangles, on
/// all threads. The result has no summary. The limit on tetrahedra holds for all pieces together.
///
/// # Errors
/// See [`fill_spaced`].
pub fn fill_in_pieces(
    by: &Tetrahedralizer,
    surface: &TriMesh,
    most: usize,
    watch: &Watch,
) -> Result<Tetrahedralization, TetError> {
    if surface.triangles.len() <= most {
        return fill_spaced(by, surface, watch);
    }
    watch.report(Stage::Tissue, 0, 0)?;
    input::validate(surface, &[], InputKind::Closed)?;
    let silent = watch.silent();
    let Pieces { points, pieces, faces } = Pieces::of(by, surface, most, &silent)?;
    let (done, total) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let fill = |piece: &Piece| {
        let mesh = fill_spaced(by, &piece.surface, &silent)?.mesh;
        by.ensure_within(total.fetch_add(mesh.tets.len(), Ordering::Relaxed) + mesh.tets.len())?;
        watch.report(Stage::Tissue, done.fetch_add(1, Ordering::Relaxed) + 1, pieces.len())?;
        Ok(mesh)
    };
    let filled: Vec<TetMesh> = pieces.par_iter().map(fill).collect::<Result<_, TetError>>()?;
    let tets = filled.iter().map(|mesh| mesh.tets.len()).sum();
    let mut mesh = TetMesh { points, tets: Vec::with_capacity(tets) };
    for (piece, own) in pieces.iter().zip(filled) {
        let first = mesh.points.len() as u32;
        mesh.points.extend_from_slice(&own.points[piece.numbers.len()..]);
        mesh.tets.extend(own.tets.iter().map(|tet| tet.map(|v| piece.number(v, first))));
    }
    Ok(Tetrahedralization { mesh, faces, ..Tetrahedralization::default() })
}
