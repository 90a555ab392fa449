//! What can be chosen beside the format when a mesh is written.

use super::format::MeshFormat;
use anastomesh_mesh::beside::Beside;
use std::path::{Path, PathBuf};

/// How a mesh is written; each format takes what concerns it.
#[derive(Clone, Copy, Default)]
#[non_exhaustive]
pub struct WriteOptions<'a> {
    /// The format, if not that of the extension.
    pub format: Option<MeshFormat>,
    /// How many bytes of a mesh in pieces are held at a time, about; other formats take less.
    pub memory: Option<usize>,
    /// How VTK's files are written.
    pub grid: GridOptions,
    /// Values beside the mesh that files of VTK and Gmsh are to have.
    pub values: Option<&'a dyn Beside>,
}

anastomesh_mesh::setters!(WriteOptions<'a> {
    format: impl Into<Option<MeshFormat>>,
    memory: impl Into<Option<usize>>,
    grid: GridOptions,
    values: impl Into<Option<&'a dyn Beside>>,
});

/// How VTK's files are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct GridOptions {
    /// Coordinates are rounded to 32 bits.
    pub float32: bool,
    /// Tetrahedra are the only cells; the boundary goes into a file of its own.
    pub tets_alone: bool,
    /// Arrays stand in the file as they are instead of compressed.
    pub raw: bool,
}

anastomesh_mesh::setters!(GridOptions { float32: bool, tets_alone: bool, raw: bool });

/// Where the boundary goes that a grid of tetrahedra alone leaves out.
pub(super) fn boundary_beside(path: &Path) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push("_boundary.vtp");
    path.with_file_name(name)
}
