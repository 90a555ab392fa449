//! Writes unstructured grids, and boundaries as poly data.

use super::arrays;
use super::file::File;
use crate::volume::content::MeshNotes;
use crate::volume::options::GridOptions;
use anastomesh_mesh::Patch;
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use std::borrow::Cow;
use std::io::{self, Seek, Write};

/// Writes a mesh as VTU. The bytes depend on the mesh, the notes and the options alone, not on the number of threads, nor on
/// the pieces in which the mesh is read. Points, tetrahedra and boundary faces are read in one pass each, their labels in
/// others; memory does not grow with the mesh: some blocks for each thread are all that is held.
///
/// # Errors
/// What the writer `out` or reading the mesh reports.
pub(in crate::volume) fn write(
    out: &mut (impl Write + Seek),
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    options: GridOptions,
    values: Option<&dyn Beside>,
) -> io::Result<()> {
    Grid { mesh, notes: Some(notes), global_ids: None, options, values }.write(out)
}

/// What goes into a file.
pub(in crate::volume) struct Grid<'a> {
    pub mesh: &'a dyn MeshSource,
    /// What the field data say; none for a piece without.
    pub notes: Option<&'a MeshNotes>,
    /// For a piece of a mesh: which point of the whole each point is.
    pub global_ids: Option<&'a [u32]>,
    pub options: GridOptions,
    /// Values beside the mesh.
    pub values: Option<&'a dyn Beside>,
}

impl Grid<'_> {
    /// Writes the file.
    pub(in crate::volume) fn write(&self, out: &mut (impl Write + Seek)) -> io::Result<()> {
        let alone = Recounted::without_boundary(self.mesh);
        let mesh: &dyn MeshSource = if self.options.tets_alone { &alone } else { self.mesh };
        let mut all = self.notes.map_or_else(Vec::new, |notes| arrays::of_fields(mesh.patches(), notes));
        all.extend(self.global_ids.map(arrays::of_ids));
        all.extend(arrays::of_mesh(mesh, self.options.float32));
        all.extend(self.values.into_iter().flat_map(|values| arrays::of_values(mesh, values)));
        let SourceCounts { points, tets, boundary } = mesh.counts();
        let counts = format!("NumberOfPoints=\"{points}\" NumberOfCells=\"{}\"", tets + boundary);
        File { kind: "UnstructuredGrid", counts, arrays: all, raw: self.options.raw }.write(out)
    }
}

/// Writes a boundary as poly data (`.vtp`), with the arrays that a grid has.
///
/// # Errors
/// What the writer `out` or reading the mesh reports.
pub fn write_boundary(
    out: &mut (impl Write + Seek),
    surface: &BoundarySurface,
    notes: &MeshNotes,
    options: GridOptions,
) -> io::Result<()> {
    let mut all = arrays::of_fields(surface.mesh().patches(), notes);
    all.extend(arrays::of_surface(surface, options.float32));
    let SourceCounts { points, boundary, .. } = surface.counts();
    let counts = format!("NumberOfPoints=\"{points}\" NumberOfPolys=\"{boundary}\"");
    File { kind: "PolyData", counts, arrays: all, raw: options.raw }.write(out)
}

/// A mesh that announces other numbers; without a boundary where it announces no face.
pub(in crate::volume) struct Recounted<'a> {
    pub mesh: &'a dyn MeshSource,
    pub counts: SourceCounts,
}

impl<'a> Recounted<'a> {
    /// Takes the boundary off a mesh.
    pub(in crate::volume) fn without_boundary(mesh: &'a dyn MeshSource) -> Self {
        Self { mesh, counts: SourceCounts { boundary: 0, ..mesh.counts() } }
    }
}

impl MeshSource for Recounted<'_> {
    fn counts(&self) -> SourceCounts {
        self.counts
    }

    fn patches(&self) -> &[Patch] {
        self.mesh.patches()
    }

    fn parts(&self) -> u32 {
        self.mesh.parts()
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        self.mesh.points(part)
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        self.mesh.tets(part)
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        if self.counts.boundary == 0 { Ok(FacePiece::default()) } else { self.mesh.boundary(part) }
    }
}
