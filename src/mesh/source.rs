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

/// Takes a piece; what it fails with ends the pass.
pub type Each<'a, T> = &'a mut dyn FnMut(T) -> io::Result<()>;

/// A labelled mesh, read in passes. Every pass gives the same things in the same order; how they are cut into pieces says
/// nothing.
pub trait MeshSource: Sync {
    /// How much there is.
    fn counts(&self) -> SourceCounts;

    /// The patches, in ascending order of their id.
    fn patches(&self) -> &[Patch];

    /// Gives all points, in order.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    fn points(&self, each: Each<&[Point3]>) -> io::Result<()>;

    /// Gives all tetrahedra, in order.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    fn tets(&self, each: Each<TetPiece>) -> io::Result<()>;

    /// Gives all boundary faces, in order.
    ///
    /// # Errors
    /// What reading the mesh or `each` fails with.
    fn boundary(&self, each: Each<FacePiece>) -> io::Result<()>;
}

impl MeshSource for VolumeMesh {
    fn counts(&self) -> SourceCounts {
        SourceCounts { points: self.mesh.points.len(), tets: self.mesh.tets.len(), boundary: self.boundary.len() }
    }

    fn patches(&self) -> &[Patch] {
        &self.patches
    }

    fn points(&self, each: Each<&[Point3]>) -> io::Result<()> {
        each(&self.mesh.points)
    }

    fn tets(&self, each: Each<TetPiece>) -> io::Result<()> {
        each(TetPiece { tets: &self.mesh.tets, blocks: &self.tet_block })
    }

    fn boundary(&self, each: Each<FacePiece>) -> io::Result<()> {
        each(FacePiece { faces: &self.boundary, patches: &self.boundary_patch, blocks: &self.boundary_block })
    }
}
