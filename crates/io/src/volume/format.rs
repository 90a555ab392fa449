//! Volume mesh formats and their file extensions.

use super::error::MeshFileError;
use crate::file::{FileError, by_extension};
use std::path::Path;

/// Format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// VTK unstructured grid, `.vtu`.
    Vtu,
    /// VTK unstructured grid in pieces: `.pvtu` and a folder beside it.
    Pvtu,
    /// Gmsh 4.1, `.msh`.
    Msh,
    /// Gmsh 2.2 as text, `.msh2`, which more programs read.
    Msh2,
    /// Medit text format, `.mesh`.
    Medit,
    /// `OpenFOAM` case, a folder; `.foam`.
    OpenFoam,
    /// `mesh-complete` folder of `SimVascular` and `svMultiPhysics`; `.svmesh`.
    SimVascular,
    /// Folder of `NumPy` arrays; `.npyd`.
    Npy,
    /// `TetGen` file family, identified by its `.ele` or `.node`.
    Tetgen,
}

/// Extensions in lower case.
const EXTENSIONS: [(&str, MeshFormat); 10] = [
    ("vtu", MeshFormat::Vtu),
    ("pvtu", MeshFormat::Pvtu),
    ("msh", MeshFormat::Msh),
    ("msh2", MeshFormat::Msh2),
    ("mesh", MeshFormat::Medit),
    ("foam", MeshFormat::OpenFoam),
    ("svmesh", MeshFormat::SimVascular),
    ("npyd", MeshFormat::Npy),
    ("ele", MeshFormat::Tetgen),
    ("node", MeshFormat::Tetgen),
];

/// Format names for explicit selection.
const NAMES: [(&str, MeshFormat); 9] = [
    ("vtu", MeshFormat::Vtu),
    ("pvtu", MeshFormat::Pvtu),
    ("msh", MeshFormat::Msh),
    ("msh2", MeshFormat::Msh2),
    ("medit", MeshFormat::Medit),
    ("openfoam", MeshFormat::OpenFoam),
    ("simvascular", MeshFormat::SimVascular),
    ("npy", MeshFormat::Npy),
    ("tetgen", MeshFormat::Tetgen),
];

impl MeshFormat {
    /// Names of all formats.
    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMES.into_iter().map(|(name, _)| name)
    }

    /// Format with this name.
    pub fn named(name: &str) -> Option<Self> {
        NAMES.into_iter().find(|(known, _)| *known == name).map(|(_, format)| format)
    }

    /// Format of a file name, by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` if no format has the extension.
    pub fn of(path: &Path) -> Result<Self, MeshFileError> {
        by_extension(path, &EXTENSIONS).ok_or_else(|| FileError::UnknownFormat {
            path: path.to_path_buf(),
            kind: "mesh",
            known: ".vtu, .pvtu, .msh, .msh2, .mesh, .foam, .svmesh, .npyd, .ele",
        })
    }

    /// True for VTK unstructured grids.
    pub fn is_grid(self) -> bool {
        matches!(self, Self::Vtu | Self::Pvtu)
    }

    /// True if the format can store values at points and in cells.
    pub fn holds_values(self) -> bool {
        self.is_grid() || matches!(self, Self::Msh | Self::Msh2 | Self::Npy)
    }

    /// True if a mesh can be written in parts for parallel solvers.
    pub fn has_parts(self) -> bool {
        matches!(self, Self::OpenFoam | Self::Pvtu | Self::Msh)
    }

    /// True if second-order meshes can be written, to [`Self::SimVascular`] without regions only.
    pub fn has_second_order(self) -> bool {
        matches!(self, Self::Vtu | Self::Msh | Self::Msh2 | Self::Npy | Self::SimVascular)
    }

    /// True if a mesh is a folder.
    pub(super) fn is_folder(self) -> bool {
        matches!(self, Self::OpenFoam | Self::SimVascular | Self::Npy)
    }

    /// True if a mesh can be written without being held in memory.
    pub fn is_written_in_passes(self) -> bool {
        self != Self::Tetgen
    }
}
