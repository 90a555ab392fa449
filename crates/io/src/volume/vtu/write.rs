//! Writer of unstructured grids, and of boundaries as poly data.

use super::arrays::{self, PieceArrays};
use super::file::File;
use crate::volume::content::MeshNotes;
use crate::volume::layers::LayerNumbers;
use crate::volume::options::{GridOptions, WriteOptions};
use crate::volume::second::{CellNodes, WithMiddles};
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts};
use std::io::{self, Seek, Write};

/// Writes a mesh as VTU. The bytes depend only on mesh, notes and options, not on threads or on the parts of the
/// source. Points, tetrahedra and boundary faces are each read in one pass, labels in others. Memory does not grow with
/// the mesh: it holds some blocks per thread.
///
/// # Errors
/// The output `out` or the mesh source fails.
pub(in crate::volume) fn write(
    out: &mut (impl Write + Seek),
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    options: &WriteOptions,
) -> io::Result<()> {
    let layers = LayerNumbers::of(mesh, options.layers)?;
    let second = options.second_order;
    Grid { layers, values: options.values, second, ..Grid::of(mesh, notes, options.grid) }.write(out)
}

/// Contents of a file.
pub(in crate::volume) struct Grid<'a> {
    pub mesh: &'a dyn MeshSource,
    /// Field data; `None` for a piece without them.
    pub notes: Option<&'a MeshNotes>,
    /// True if blocks are regions.
    pub has_regions: bool,
    /// For a piece of a mesh: number of each point in the whole mesh.
    pub global_ids: Option<&'a [u32]>,
    /// For a region of a mesh: numbers in the whole mesh, by which solvers match regions.
    pub solver_ids: Option<SolverIds<'a>>,
    /// For a piece with ghost cells: their marks, and numbers in the whole mesh.
    pub piece: Option<PieceArrays<'a>>,
    /// Layers of the cells, if the mesh has layers.
    pub layers: Option<LayerNumbers<'a>>,
    pub options: GridOptions,
    /// Additional values of the mesh.
    pub values: Option<&'a dyn Beside>,
    /// Midpoints of a second-order mesh.
    pub second: Option<&'a SecondOrder>,
}

/// Numbers in the whole mesh of the parts of a region.
pub(in crate::volume) struct SolverIds<'a> {
    pub points: &'a [u32],
    pub tets: &'a [u32],
    /// Tetrahedron under each boundary face.
    pub faces: &'a [u32],
}

impl<'a> SolverIds<'a> {
    /// Tetrahedron of each cell.
    fn cells(&self, options: GridOptions) -> [&'a [u32]; 2] {
        [self.tets, if options.tets_alone { &[] } else { self.faces }]
    }
}

impl<'a> Grid<'a> {
    /// Mesh with its notes.
    pub(in crate::volume) fn of(mesh: &'a dyn MeshSource, notes: &'a MeshNotes, options: GridOptions) -> Self {
        Self {
            mesh,
            notes: Some(notes),
            has_regions: !notes.regions.is_empty(),
            global_ids: None,
            solver_ids: None,
            piece: None,
            layers: None,
            options,
            values: None,
            second: None,
        }
    }

    /// Writes the file.
    pub(in crate::volume) fn write(&self, out: &mut (impl Write + Seek)) -> io::Result<()> {
        let with_middles = self.second.map(|second| WithMiddles { mesh: self.mesh, second });
        let mesh: &dyn MeshSource = with_middles.as_ref().map_or(self.mesh, |mesh| mesh);
        let alone = Recounted::without_boundary(mesh);
        let mesh: &dyn MeshSource = if self.options.tets_alone { &alone } else { mesh };
        let mut all = self.notes.map_or_else(Vec::new, |notes| arrays::of_fields(mesh.patches(), notes));
        all.extend(self.global_ids.map(arrays::of_ids));
        all.extend(self.solver_ids.iter().flat_map(|ids| arrays::of_solver(ids.points, ids.cells(self.options))));
        all.extend(self.piece.iter().flat_map(|piece| arrays::of_piece(*piece, mesh.counts().boundary)));
        all.extend(arrays::of_mesh(mesh, CellNodes(self.second), self.options.float32, self.has_regions));
        all.extend(self.layers.map(|layers| arrays::layer_array(layers, mesh.counts())));
        all.extend(self.values.into_iter().flat_map(|values| arrays::of_values(mesh, values)));
        let SourceCounts { points, tets, boundary } = mesh.counts();
        let counts = format!("NumberOfPoints=\"{points}\" NumberOfCells=\"{}\"", tets + boundary);
        File { kind: "UnstructuredGrid", counts, arrays: all, raw: self.options.raw }.write(out)
    }
}

/// Writes a boundary as poly data (`.vtp`), with the arrays of a grid.
///
/// # Errors
/// The output `out` or the mesh source fails.
pub fn write_boundary(
    out: &mut (impl Write + Seek),
    surface: &BoundarySurface,
    notes: &MeshNotes,
    options: GridOptions,
) -> io::Result<()> {
    let mut all = arrays::of_fields(surface.mesh().patches(), notes);
    all.extend(arrays::of_surface(surface, options.float32, !notes.regions.is_empty()));
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
    anastomesh_mesh::of_mesh!(patches, parts, points, tets);

    fn counts(&self) -> SourceCounts {
        self.counts
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        if self.counts.boundary == 0 { Ok(FacePiece::default()) } else { self.mesh.boundary(part) }
    }
}
