//! Meshes with a split surface ([`Boundary::Split`]). Surface edges that are too long are halved. If the shape of tetrahedra
//! is bounded, plane facets become Delaunay, and badly shaped triangles are refined (`shape`). The pieces are kept like any
//! input.
//!
//! New points are rounded, so the pieces of a triangle are coplanar up to rounding. The certificate refers to the pieces.

mod encroached;
mod pieces;
mod shape;

use crate::builder::{Tetrahedralization, Tetrahedralizer};
use crate::error::TetError;
use crate::options::{Boundary, Interior, Refinement, Sizing};
use crate::outside::without;
use crate::plc::{LeftOut, PlcRef};
use crate::sized;
use anastomesh_mesh::Bounds;
use anastomesh_mesh::geometry::Point3;
use pieces::Pieces;
use std::sync::Arc;

/// Smallest ratio of circumradius to shortest edge to which triangles are refined, and the usual one.
const RATIO: [f64; 2] = [1.15, 2.0];

/// Maximum pieces for the sake of shape: a number, and a number per triangle.
const MAX_PIECES: [usize; 2] = [10_000, 20];

/// Maximum divisions of encroached pieces.
const MAX_DIVISIONS: usize = 3;

/// Share of tetrahedra above the ratio below which no piece is divided for them. TetGen leaves more on most surfaces.
const ENOUGH: f64 = 0.03;

impl Tetrahedralizer {
    /// Meshes a checked complex with triangles that may be split. If some cannot be recovered, retries without those
    /// outside the filled volume, whose pieces are not needed.
    ///
    /// # Errors
    /// As [`Tetrahedralizer::run`].
    pub(super) fn run_split(&self, plc: PlcRef) -> Result<Tetrahedralization, TetError> {
        let error = match self.run_pieces(plc) {
            Err(error @ (TetError::Stuck { .. } | TetError::NotRecovered { .. })) => error,
            other => return other,
        };
        let bare =
            self.clone().boundary(Boundary::Keep).interior(Interior::None).refine(None::<Refinement>).optimize(false);
        match bare.sizing(Sizing::Surface).run(plc) {
            Ok(Tetrahedralization { summary, .. }) if !summary.left_out.is_empty() => {
                self.run_without(plc, summary.left_out)
            }
            Err(error) if error.is_stop() => Err(error),
            _ => Err(error),
        }
    }

    /// Meshes the complex without its outside parts.
    fn run_without(&self, plc: PlcRef, left_out: LeftOut) -> Result<Tetrahedralization, TetError> {
        let kept: Vec<u32> = without(&(0..plc.surface.triangles.len() as u32).collect::<Vec<_>>(), &left_out.triangles);
        let surface = left_out.kept_surface(plc.surface);
        let inner = PlcRef {
            surface: &surface,
            markers: &without(plc.markers, &left_out.triangles),
            segments: &without(plc.segments, &left_out.segments),
            ..plc
        };
        let mut done = self.run_pieces(inner)?;
        for id in &mut done.origins {
            *id = kept[*id as usize];
        }
        done.summary.left_out = left_out;
        Ok(done)
    }

    fn run_pieces(&self, plc: PlcRef) -> Result<Tetrahedralization, TetError> {
        let (refinement, sizing) = self.refinement_and_sizing();
        let max_volume = refinement.and_then(|r| r.bounds.max_volume);
        let size = Arc::new(sized::size_function(plc.surface, sizing, max_volume));
        let mut pieces = Pieces::new(plc.to_owned());
        if max_volume.is_some() || !matches!(sizing, Sizing::Surface) {
            pieces.split_to(&*size);
        }
        let keep = self.clone().boundary(Boundary::Keep);
        let keep = match sizing {
            // The size field of the input also applies to its pieces.
            Sizing::PerVertex(_) => {
                let size = Arc::clone(&size);
                keep.sizing(Sizing::Function(Arc::new(move |p: &Point3| size(p))))
            }
            _ => keep,
        };
        let bounds = refinement.map_or_else(Bounds::default, |r| r.bounds);
        let wanted = bounds.max_radius_edge.or(bounds.min_dihedral.map(|_| RATIO[1]));
        let Some(ratio) = wanted.map(|ratio| ratio.max(RATIO[0])) else { return run(&keep, &pieces) };
        let plain = pieces.clone();
        match self.improved(&keep, &mut pieces, ratio) {
            // Rounding may make facets intersect that almost touch.
            Err(error) if !error.is_stop() => run(&keep, &plain),
            done => done,
        }
    }

    /// Meshes the pieces after improving them for tetrahedra with this ratio of circumradius to shortest edge. Encroached pieces
    /// are divided, and meshed again, as long as the share of tetrahedra above it falls.
    fn improved(&self, keep: &Self, pieces: &mut Pieces, ratio: f64) -> Result<Tetrahedralization, TetError> {
        let most = MAX_PIECES[0] + MAX_PIECES[1] * pieces.plc.surface.triangles.len();
        let watch = self.watch();
        pieces.improve(ratio, most, &watch)?;
        let mut best = run(keep, pieces)?;
        let mut encroached = pieces.encroached(&best.mesh, ratio, &watch)?;
        for _ in 0..MAX_DIVISIONS {
            if encroached.share <= ENOUGH || !pieces.divide_encroached(&encroached, ratio, most, &watch)? {
                break;
            }
            let next = run(keep, pieces)?;
            let after = pieces.encroached(&next.mesh, ratio, &watch)?;
            if after.share >= encroached.share {
                break;
            }
            (best, encroached) = (next, after);
        }
        Ok(best)
    }
}

/// Meshes the pieces, and names the triangles that they are pieces of.
fn run(keep: &Tetrahedralizer, pieces: &Pieces) -> Result<Tetrahedralization, TetError> {
    let mut done = keep.run(&pieces.plc)?;
    pieces.name_origins(&mut done);
    Ok(done)
}
