//! Patches of a case: names and face ranges.

use crate::flow::{Role, plain};
use crate::patches::usual_name;
use anastomesh_mesh::Patch;
use anastomesh_mesh::source::{MeshSource, miscounted};
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
}

/// Patches in ascending order of id; their faces follow the inner ones.
pub(super) struct Boundary {
    pub(super) patches: Vec<FoamPatch>,
    /// Number of inner faces.
    pub(super) inner: u64,
    pub(super) outer: u64,
}

impl Boundary {
    /// Collects the patches in one pass over the labels.
    pub(super) fn of(mesh: &dyn MeshSource) -> io::Result<Self> {
        let counts = mesh.counts();
        let outer = counts.boundary as u64;
        let inner = (4 * counts.tets as u64).checked_sub(outer).ok_or_else(miscounted)? / 2;
        let mut faces: BTreeMap<i32, u64> = mesh.patches().iter().map(|patch| (patch.id, 0)).collect();
        mesh.each_face_labels(|piece| {
            for i in 0..piece.count {
                *faces.entry(piece.patches.get(i).copied().unwrap_or(0)).or_default() += 1;
            }
            Ok(())
        })?;
        let named: BTreeMap<i32, &Patch> = mesh.patches().iter().map(|patch| (patch.id, patch)).collect();
        let mut first = inner;
        let place = |(id, faces): (i32, u64)| {
            let unnamed = || Patch { id, name: usual_name(id), cap: None };
            let patch = named.get(&id).map_or_else(unnamed, |&patch| patch.clone());
            first += faces;
            FoamPatch { name: plain(&patch.name), role: Role::of(&patch), patch, faces, first: first - faces }
        };
        Ok(Self { patches: faces.into_iter().map(place).collect(), inner, outer })
    }

    pub(super) fn with_role(&self, role: Role) -> impl Iterator<Item = &FoamPatch> {
        self.patches.iter().filter(move |patch| patch.role == role)
    }
}
