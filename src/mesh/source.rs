//! A labelled mesh that is read in passes, a piece at a time: what writers write, whether the mesh stands in memory or
//! is put together from blocks on the way.

use std::io;

use super::{Patch, VolumeMesh};
use crate::geometry::Point3;

/// How much a mesh holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SourceCounts {
    /// Points.
    pub points: usize,
    /// Tetrahedra.
    pub tets: usize,
    /// Boundary faces.
    pub boundary: usize,
}

/// Consecutive tetrahedra.
#[derive(Clone, Copy, Debug)]
pub struct TetPiece<'a> {
    /// Vertices, as indices into the whole mesh's points.
    pub tets: &'a [[u32; 4]],
    /// Block of each tetrahedron; may be empty when blocks are not known, then all are 0.
    pub blocks: &'a [i32],
}

/// Consecutive boundary faces.
#[derive(Clone, Copy, Debug)]
pub struct FacePiece<'a> {
    /// Vertices, oriented outwards, as indices into the whole mesh's points.
    pub faces: &'a [[u32; 3]],
    /// Patch of each face; may be empty when the boundary is not labelled, then all are 0.
    pub patches: &'a [i32],
    /// Block of the tetrahedron under each face; may be empty when blocks are not known, then all are 0.
    pub blocks: &'a [i32],
}

/// Takes consecutive points; what it fails with ends the pass.
pub type EachPoints<'a> = &'a mut dyn FnMut(&[Point3]) -> io::Result<()>;

/// Takes consecutive tetrahedra; what it fails with ends the pass.
pub type EachTets<'a> = &'a mut dyn FnMut(TetPiece) -> io::Result<()>;

/// Takes consecutive boundary faces; what it fails with ends the pass.
pub type EachFaces<'a> = &'a mut dyn FnMut(FacePiece) -> io::Result<()>;

/// The blocks, or patches and blocks, of consecutive tetrahedra or boundary faces.
#[derive(Clone, Copy, Debug)]
pub struct LabelPiece<'a> {
    /// How many tetrahedra or faces.
    pub count: usize,
    /// As in [`FacePiece`]; empty for tetrahedra.
    pub patches: &'a [i32],
    /// As in [`TetPiece`] and [`FacePiece`].
    pub blocks: &'a [i32],
}

/// Takes consecutive labels; what it fails with ends the pass.
pub type EachLabels<'a> = &'a mut dyn FnMut(LabelPiece) -> io::Result<()>;

/// A labelled mesh, read in passes. Every pass gives the same things in the same order; how they are cut into pieces says
/// nothing. A pass may be made inside another one: no lock may be held while `each` runs.
pub trait MeshSource: Sync {
    /// How much there is.
    fn counts(&self) -> SourceCounts;

    /// The patches, in ascending order of their id.
    fn patches(&self) -> &[Patch];

    /// Gives all points, in order.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    fn points(&self, each: EachPoints) -> io::Result<()>;

    /// Gives all tetrahedra, in order.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    fn tets(&self, each: EachTets) -> io::Result<()>;

    /// Gives all boundary faces, in order.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    fn boundary(&self, each: EachFaces) -> io::Result<()>;

    /// Gives what [`tets`](Self::tets) says of blocks, without the tetrahedra.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    fn tet_labels(&self, each: EachLabels) -> io::Result<()> {
        self.tets(&mut |TetPiece { tets, blocks }| each(LabelPiece { count: tets.len(), patches: &[], blocks }))
    }

    /// Gives what [`boundary`](Self::boundary) says of patches and blocks, without the faces.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    fn face_labels(&self, each: EachLabels) -> io::Result<()> {
        self.boundary(&mut |FacePiece { faces, patches, blocks }| {
            each(LabelPiece { count: faces.len(), patches, blocks })
        })
    }

    /// The whole mesh, when it stands in memory: for formats that cannot be written in passes.
    fn whole(&self) -> Option<&VolumeMesh> {
        None
    }
}

/// Puts a mesh together in memory.
///
/// # Errors
/// What reading the mesh fails with.
pub fn gather(source: &dyn MeshSource) -> io::Result<VolumeMesh> {
    let counts = source.counts();
    let mut volume = VolumeMesh { patches: source.patches().to_vec(), ..VolumeMesh::default() };
    volume.mesh.points.reserve_exact(counts.points);
    volume.mesh.tets.reserve_exact(counts.tets);
    source.points(&mut |points| {
        volume.mesh.points.extend_from_slice(points);
        Ok(())
    })?;
    source.tets(&mut |piece| {
        volume.mesh.tets.extend_from_slice(piece.tets);
        extend_or_zero(&mut volume.tet_block, piece.blocks, piece.tets.len());
        Ok(())
    })?;
    source.boundary(&mut |piece| {
        volume.boundary.extend_from_slice(piece.faces);
        extend_or_zero(&mut volume.boundary_patch, piece.patches, piece.faces.len());
        extend_or_zero(&mut volume.boundary_block, piece.blocks, piece.faces.len());
        Ok(())
    })?;
    Ok(volume)
}

/// Appends as many values as there are things; those that are not known are 0.
fn extend_or_zero(values: &mut Vec<i32>, piece: &[i32], count: usize) {
    let (before, known) = (values.len(), piece.len().min(count));
    values.extend_from_slice(&piece[..known]);
    values.resize(before + count, 0);
}

impl MeshSource for VolumeMesh {
    fn counts(&self) -> SourceCounts {
        SourceCounts { points: self.mesh.points.len(), tets: self.mesh.tets.len(), boundary: self.boundary.len() }
    }

    fn patches(&self) -> &[Patch] {
        &self.patches
    }

    fn points(&self, each: EachPoints) -> io::Result<()> {
        each(&self.mesh.points)
    }

    fn tets(&self, each: EachTets) -> io::Result<()> {
        each(TetPiece { tets: &self.mesh.tets, blocks: &self.tet_block })
    }

    fn boundary(&self, each: EachFaces) -> io::Result<()> {
        each(FacePiece { faces: &self.boundary, patches: &self.boundary_patch, blocks: &self.boundary_block })
    }

    fn whole(&self) -> Option<&VolumeMesh> {
        Some(self)
    }
}
