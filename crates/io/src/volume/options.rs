//! Options of writing a mesh.

use super::format::MeshFormat;
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::second_order::SecondOrder;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Options of writing a mesh; each format uses those that apply.
#[derive(Clone, Copy, Default)]
#[non_exhaustive]
pub struct WriteOptions<'a> {
    /// Mesh format; that of the extension if `None`.
    pub format: Option<MeshFormat>,
    /// Approximate memory for a mesh in pieces, in bytes; other formats need less.
    pub memory: Option<usize>,
    /// Options of VTK files.
    pub grid: GridOptions,
    /// Additional values for VTK and Gmsh files.
    pub values: Option<&'a dyn Beside>,
    /// Layer of each tetrahedron, for VTU, PVTU and `NumPy`: 1 at the wall, 0 outside of layers. If `None`, layers are found by
    /// the order of the tetrahedra.
    pub layers: Option<&'a [i32]>,
    /// Write the prisms and pyramids of layers as whole cells, not as tetrahedra. VTU, PVTU and MSH only, without values.
    pub prisms: bool,
    /// Number of parts for parallel solvers: folders of processors beside an `OpenFOAM` mesh, pieces of a PVTU mesh, and
    /// partitions of an MSH 4.1 mesh. Other formats have none ([`PartsError`](super::PartsError)).
    pub parts: Option<NonZeroUsize>,
    /// Midpoints of the mesh, which make it a second-order mesh: VTU, MSH and `NumPy` only, neither with prisms nor in parts.
    pub second_order: Option<&'a SecondOrder>,
    /// Receiver of remarks on a solver case, such as a reason why it is not expected to converge.
    pub remark: Option<&'a dyn Fn(&str)>,
}

anastomesh_mesh::setters!(WriteOptions<'a> {
    format: impl Into<Option<MeshFormat>>,
    memory: impl Into<Option<usize>>,
    grid: GridOptions,
    values: impl Into<Option<&'a dyn Beside>>,
    layers: impl Into<Option<&'a [i32]>>,
    prisms: bool,
    parts: impl Into<Option<NonZeroUsize>>,
    second_order: impl Into<Option<&'a SecondOrder>>,
    remark: impl Into<Option<&'a dyn Fn(&str)>>,
});

/// Options of VTK files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct GridOptions {
    /// Round coordinates to 32 bits.
    pub float32: bool,
    /// Write tetrahedra only; the boundary goes to a separate file.
    pub tets_alone: bool,
    /// Write raw instead of compressed arrays.
    pub raw: bool,
}

anastomesh_mesh::setters!(GridOptions { float32: bool, tets_alone: bool, raw: bool });

/// Path of the separate boundary file of a tetrahedra-only grid.
pub(super) fn boundary_beside(path: &Path) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push("_boundary.vtp");
    path.with_file_name(name)
}
