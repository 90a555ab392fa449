//! Patches of a case: names and face ranges.

use super::joined::CellFaces;
use crate::flow::{Role, plain};
use crate::patches::usual_name;
use anastomesh_mesh::Patch;
use anastomesh_mesh::faces::Faces;
use anastomesh_mesh::source::{MeshSource, miscounted};
use anastomesh_mesh::stacks::Cells;
use std::collections::BTreeMap;
use std::io;

/// Patch of a case.
pub(super) struct FoamPatch {
    pub(super) patch: Patch,
    /// Name as an OpenFOAM word.
    pub(super) name: String,
    pub(super) role: Role,
    pub(super) faces: u64,
    /// Index of its first face.
    pub(super) first: u64,
    /// Number of vertices of all faces before it.
    pub(super) corners: u64,
}

/// Patches in ascending order of id; their faces follow the inner ones.
pub(super) struct Boundary {
    pub(super) patches: Vec<FoamPatch>,
    /// Number of inner faces.
    pub(super) inner: u64,
    pub(super) outer: u64,
    /// Number of vertices of all faces.
    pub(super) corners: u64,
    /// Faces with four vertices, if the mesh has layers.
    pub(super) quads: Option<Quads>,
}

/// Faces with four vertices: true for each, in order.
#[derive(Default)]
pub(super) struct Quads {
    inner: Vec<bool>,
    outer: BTreeMap<i32, Vec<bool>>,
}

impl Quads {
    /// Finds the faces of cells in one pass.
    fn of(faces: &Faces, cells: &Cells) -> io::Result<Self> {
        let mut quads = Self::default();
        faces.each_with(
            |_, _, part| Ok(CellFaces::of(part, Some(cells))),
            |_, part| {
                quads.inner.extend(part.inner.iter().map(|face| face.face.is_quad()));
                for face in part.outer {
                    quads.outer.entry(face.patch).or_default().push(face.face.is_quad());
                }
                Ok(())
            },
        )?;
        Ok(quads)
    }

    /// Number of vertices of each face, in the order of the file.
    pub(super) fn vertices(&self) -> impl Iterator<Item = u32> {
        self.inner.iter().chain(self.outer.values().flatten()).map(|&is_quad| 3 + u32::from(is_quad))
    }
}

impl Boundary {
    /// Collects the patches in one pass: over the labels, or over the faces of a mesh with layers.
    pub(super) fn of(mesh: &dyn MeshSource, faces: &Faces, cells: Option<&Cells>) -> io::Result<Self> {
        let counts = mesh.counts();
        // By patch, faces and their vertices.
        let mut sizes: BTreeMap<i32, [u64; 2]> = mesh.patches().iter().map(|patch| (patch.id, [0; 2])).collect();
        let mut add = |patch: i32, vertices: u64| {
            let [faces, corners] = sizes.entry(patch).or_default();
            (*faces, *corners) = (*faces + 1, *corners + vertices);
        };
        let quads = cells.map(|cells| Quads::of(faces, cells)).transpose()?;
        let (inner, corners) = if let Some(quads) = &quads {
            let all = quads.outer.iter().flat_map(|(&patch, quads)| quads.iter().map(move |&is_quad| (patch, is_quad)));
            all.for_each(|(patch, is_quad)| add(patch, 3 + u64::from(is_quad)));
            let inner = quads.inner.len() as u64;
            (inner, 3 * inner + quads.inner.iter().filter(|is_quad| **is_quad).count() as u64)
        } else {
            mesh.each_face_labels(|piece| {
                (0..piece.count).for_each(|i| add(piece.patches.get(i).copied().unwrap_or(0), 3));
                Ok(())
            })?;
            let inner = (4 * counts.tets as u64).checked_sub(counts.boundary as u64).ok_or_else(miscounted)? / 2;
            (inner, 3 * inner)
        };
        let named: BTreeMap<i32, &Patch> = mesh.patches().iter().map(|patch| (patch.id, patch)).collect();
        let (mut first, mut corner) = (inner, corners);
        let place = |(id, [faces, corners]): (i32, [u64; 2])| {
            let unnamed = || Patch { id, name: usual_name(id), cap: None };
            let patch = named.get(&id).map_or_else(unnamed, |&patch| patch.clone());
            let (name, role) = (plain(&patch.name), Role::of(&patch));
            let placed = FoamPatch { name, role, patch, faces, first, corners: corner };
            (first, corner) = (first + faces, corner + corners);
            placed
        };
        let patches = sizes.into_iter().map(place).collect();
        Ok(Self { patches, inner, outer: first - inner, corners: corner, quads })
    }

    pub(super) fn with_role(&self, role: Role) -> impl Iterator<Item = &FoamPatch> {
        self.patches.iter().filter(move |patch| patch.role == role)
    }
}
