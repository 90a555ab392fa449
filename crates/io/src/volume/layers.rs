//! Layers of the tetrahedra of a mesh, for the writers.

use anastomesh_mesh::source::{MeshSource, TetPiece};
use anastomesh_mesh::stacks::{each_layers, is_layered, layers_in};
use std::borrow::Cow;
use std::io;

/// Layer of each tetrahedron, counted from 1 at the wall; 0 for tetrahedra outside of layers.
#[derive(Clone, Copy)]
pub(super) enum LayerNumbers<'a> {
    /// Found by the order of the tetrahedra in a mesh.
    Found(&'a dyn MeshSource),
    /// Given for all tetrahedra.
    Given(&'a [i32]),
}

impl<'a> LayerNumbers<'a> {
    /// Layers of a mesh; `None` if it has no layers.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    pub(super) fn of(mesh: &'a dyn MeshSource, given: Option<&'a [i32]>) -> io::Result<Option<Self>> {
        match given {
            Some(layers) => Ok((!layers.is_empty()).then_some(Self::Given(layers))),
            None => Ok(is_layered(mesh)?.then_some(Self::Found(mesh))),
        }
    }

    /// Passes on the layers in the order of the tetrahedra.
    ///
    /// # Errors
    /// Errors of reading the mesh, and of `each`.
    pub(super) fn each(self, mut each: impl FnMut(&[i32]) -> io::Result<()>) -> io::Result<()> {
        match self {
            Self::Found(mesh) => each_layers(mesh, each),
            Self::Given(layers) => each(layers),
        }
    }

    /// Layers of a part of the mesh that begins with tetrahedron `first`.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    pub(super) fn of_part(self, part: u32, tets: &TetPiece, first: usize) -> io::Result<Cow<'a, [i32]>> {
        match self {
            Self::Found(mesh) => Ok(layers_in(&tets.tets, &mesh.boundary(part)?).into()),
            Self::Given(layers) => Ok(layers.get(first..first + tets.tets.len()).unwrap_or_default().into()),
        }
    }
}
