//! Labelled mesh that is read part by part.
//!
//! Writers and the check by parts read such a mesh. It may be in memory, in a file, or assembled from blocks while it is
//! read.

use std::borrow::Cow;
use std::io;
use std::ops::Range;

use rayon::prelude::*;

use super::{Patch, VolumeMesh};
use crate::geometry::Point3;

/// Counts of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct SourceCounts {
    /// Points.
    pub points: usize,
    /// Tetrahedra.
    pub tets: usize,
    /// Boundary faces.
    pub boundary: usize,
}

/// Consecutive tetrahedra.
#[derive(Clone, Debug, Default)]
pub struct TetPiece<'a> {
    /// Vertices, as indices into the whole mesh's points.
    pub tets: Cow<'a, [[u32; 4]]>,
    /// Block of each tetrahedron; empty if blocks are unknown, which means 0 for all.
    pub blocks: Cow<'a, [i32]>,
}

/// Consecutive boundary faces.
#[derive(Clone, Debug, Default)]
pub struct FacePiece<'a> {
    /// Vertices, oriented outwards, as indices into the whole mesh's points.
    pub faces: Cow<'a, [[u32; 3]]>,
    /// Patch of each face; empty if the boundary is not labelled, which means 0 for all.
    pub patches: Cow<'a, [i32]>,
    /// Block of the tetrahedron under each face; empty if blocks are unknown, which means 0 for all.
    pub blocks: Cow<'a, [i32]>,
}

/// The blocks, or patches and blocks, of consecutive tetrahedra or boundary faces.
#[derive(Clone, Debug, Default)]
pub struct LabelPiece<'a> {
    /// Number of tetrahedra or faces.
    pub count: usize,
    /// As in [`FacePiece`]; empty for tetrahedra.
    pub patches: Cow<'a, [i32]>,
    /// As in [`TetPiece`] and [`FacePiece`].
    pub blocks: Cow<'a, [i32]>,
}

/// Labelled mesh in parts. Its points, tetrahedra and boundary faces are numbered in the order of the parts. Parts may be
/// read concurrently and repeatedly. A mesh in memory is one part.
pub trait MeshSource: Sync {
    /// Counts over all parts.
    fn counts(&self) -> SourceCounts;

    /// The patches, in ascending order of their id.
    fn patches(&self) -> &[Patch];

    /// Number of parts.
    fn parts(&self) -> u32;

    /// Points that a part adds to those of earlier parts. Its tetrahedra may refer to points of all parts.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>>;

    /// The tetrahedra of a part.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>>;

    /// The boundary faces of a part.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>>;

    /// Blocks of [`tets`](Self::tets), without the tetrahedra.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    fn tet_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        let TetPiece { tets, blocks } = self.tets(part)?;
        Ok(LabelPiece { count: tets.len(), blocks, ..LabelPiece::default() })
    }

    /// Patches and blocks of [`boundary`](Self::boundary), without the faces.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    fn face_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        let FacePiece { faces, patches, blocks } = self.boundary(part)?;
        Ok(LabelPiece { count: faces.len(), patches, blocks })
    }

    /// Points with these indices, which must be valid and ascending. Sources with random access read only these points.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    fn points_of(&self, ids: &[u32]) -> io::Result<Vec<Point3>> {
        let mut found = Vec::with_capacity(ids.len());
        let mut before = 0;
        for part in 0..self.parts() {
            let points = self.points(part)?;
            let here = ids[found.len()..].iter().map_while(|&id| points.get(id as usize - before));
            found.extend(here.copied());
            before += points.len();
        }
        Ok(found)
    }

    /// The whole mesh, if it is in memory. For formats that cannot be written in passes.
    fn whole(&self) -> Option<&VolumeMesh> {
        None
    }
}

/// Passes over all parts in order. An error of `each` ends the pass.
///
/// A mesh with other counts than [`MeshSource::counts`] fails with `InvalidData`, because writers write the counts first.
/// A pass may run inside another one.
impl dyn MeshSource + '_ {
    /// Gives all points.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_points(&self, mut each: impl FnMut(&[Point3]) -> io::Result<()>) -> io::Result<()> {
        let read = |part| self.points(part);
        self.in_order(self.counts().points, read, |points| points.len(), |points| each(points))
    }

    /// Gives all tetrahedra.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_tets(&self, each: impl FnMut(&TetPiece) -> io::Result<()>) -> io::Result<()> {
        self.in_order(self.counts().tets, |part| self.tets(part), |piece| piece.tets.len(), each)
    }

    /// Gives all boundary faces.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_faces(&self, each: impl FnMut(&FacePiece) -> io::Result<()>) -> io::Result<()> {
        self.in_order(self.counts().boundary, |part| self.boundary(part), |piece| piece.faces.len(), each)
    }

    /// Gives the labels of all tetrahedra.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_tet_labels(&self, each: impl FnMut(&LabelPiece) -> io::Result<()>) -> io::Result<()> {
        self.in_order(self.counts().tets, |part| self.tet_labels(part), |piece| piece.count, each)
    }

    /// Gives the labels of all boundary faces.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_face_labels(&self, each: impl FnMut(&LabelPiece) -> io::Result<()>) -> io::Result<()> {
        self.in_order(self.counts().boundary, |part| self.face_labels(part), |piece| piece.count, each)
    }

    /// Gives the corners of all tetrahedra.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_tet_corners(&self, mut each: impl FnMut(&[[Point3; 4]]) -> io::Result<()>) -> io::Result<()> {
        let read = |part| self.corners_of(&self.tets(part)?.tets);
        self.in_order(self.counts().tets, read, Vec::len, |corners| each(corners))
    }

    /// Gives the corners of all boundary faces.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`.
    pub fn each_face_corners(&self, mut each: impl FnMut(&[[Point3; 3]]) -> io::Result<()>) -> io::Result<()> {
        let read = |part| self.corners_of(&self.boundary(part)?.faces);
        self.in_order(self.counts().boundary, read, Vec::len, |corners| each(corners))
    }

    /// The corners of cells.
    ///
    /// # Errors
    /// Errors of reading the mesh; `InvalidData` if a cell refers to a missing point.
    pub fn corners_of<const N: usize>(&self, cells: &[[u32; N]]) -> io::Result<Vec<[Point3; N]>> {
        let mut ids = cells.as_flattened().to_vec();
        ids.sort_unstable();
        ids.dedup();
        let points = self.points_of(&ids)?;
        if points.len() != ids.len() {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a cell names a point that does not exist"));
        }
        let at = |v: u32| points[ids.partition_point(|&id| id < v)];
        Ok(cells.iter().map(|cell| cell.map(at)).collect())
    }

    /// As [`each_part`](Self::each_part), and compares the number of items with the expected one.
    pub(super) fn in_order<T: Send>(
        &self,
        expected: usize,
        read: impl Fn(u32) -> io::Result<T> + Sync,
        count: impl Fn(&T) -> usize,
        mut each: impl FnMut(&T) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut left = expected;
        self.each_part(read, |piece| {
            left = left.checked_sub(count(&piece)).ok_or_else(miscounted)?;
            each(&piece)
        })?;
        if left == 0 { Ok(()) } else { Err(miscounted()) }
    }

    /// Reads several parts at a time on all threads, and passes the results to `each` in the order of the parts.
    ///
    /// # Errors
    /// Errors of `read` or `each`.
    pub fn each_part<T: Send>(
        &self,
        read: impl Fn(u32) -> io::Result<T> + Sync,
        mut each: impl FnMut(T) -> io::Result<()>,
    ) -> io::Result<()> {
        for first in (0..self.parts()).step_by(MAX_HELD_PARTS as usize) {
            for piece in read_parts(first..self.parts().min(first + MAX_HELD_PARTS), &read) {
                each(piece?)?;
            }
        }
        Ok(())
    }
}

/// Reads parts on all threads. Compiled once for each `T`, whoever reads.
fn read_parts<T: Send>(parts: Range<u32>, read: &(dyn Fn(u32) -> io::Result<T> + Sync)) -> Vec<io::Result<T>> {
    parts.into_par_iter().map(read).collect()
}

/// Maximum number of parts in memory at a time.
const MAX_HELD_PARTS: u32 = 64;

/// Error of a source whose contents differ from its counts.
pub fn miscounted() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the contents of the mesh differ from its counts")
}

/// Assembles a mesh in memory.
///
/// # Errors
/// Errors of reading the mesh.
pub fn gather(source: &dyn MeshSource) -> io::Result<VolumeMesh> {
    let counts = source.counts();
    let mut volume = VolumeMesh { patches: source.patches().to_vec(), ..VolumeMesh::default() };
    volume.mesh.points.reserve_exact(counts.points);
    volume.mesh.tets.reserve_exact(counts.tets);
    source.each_points(|points| {
        volume.mesh.points.extend_from_slice(points);
        Ok(())
    })?;
    source.each_tets(|piece| {
        volume.mesh.tets.extend_from_slice(&piece.tets);
        extend_or_zero(&mut volume.tet_block, &piece.blocks, piece.tets.len());
        Ok(())
    })?;
    source.each_faces(|piece| {
        volume.boundary.extend_from_slice(&piece.faces);
        extend_or_zero(&mut volume.boundary_patch, &piece.patches, piece.faces.len());
        extend_or_zero(&mut volume.boundary_block, &piece.blocks, piece.faces.len());
        Ok(())
    })?;
    Ok(volume)
}

/// Appends one value per item; unknown values are 0.
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

    fn parts(&self) -> u32 {
        1
    }

    fn points(&self, _: u32) -> io::Result<Cow<'_, [Point3]>> {
        Ok(Cow::Borrowed(&self.mesh.points))
    }

    fn tets(&self, _: u32) -> io::Result<TetPiece<'_>> {
        Ok(TetPiece { tets: Cow::Borrowed(&self.mesh.tets), blocks: Cow::Borrowed(&self.tet_block) })
    }

    fn boundary(&self, _: u32) -> io::Result<FacePiece<'_>> {
        Ok(FacePiece {
            faces: Cow::Borrowed(&self.boundary),
            patches: Cow::Borrowed(&self.boundary_patch),
            blocks: Cow::Borrowed(&self.boundary_block),
        })
    }

    fn whole(&self) -> Option<&VolumeMesh> {
        Some(self)
    }
}
