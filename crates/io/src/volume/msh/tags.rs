//! Tags of nodes and elements in version 4.1.

use super::surfaces::Surfaces;
use anastomesh_mesh::bits::Ranks;
use rustc_hash::FxHashMap;

/// Tags count from 1. They follow the mesh, tetrahedra first, so that reading restores its order. If data sections
/// follow, tags are in file order, which some readers (meshio) require.
pub(super) struct Tags<'a> {
    surfaces: &'a Surfaces,
    in_file: Option<InFile<'a>>,
    elements: usize,
}

/// File positions of nodes: those of the first surface, of the other surfaces, and inside.
struct InFile<'a> {
    first: Ranks<'a>,
    outer: Ranks<'a>,
    /// Positions of nodes on the other surfaces.
    owned: FxHashMap<u32, u32>,
    /// Number of nodes on the boundary.
    on_boundary: u32,
}

impl<'a> Tags<'a> {
    pub(super) fn new(surfaces: &'a Surfaces, as_in_file: bool) -> Self {
        let in_file = || {
            let first = surfaces.list.first().map_or(0, |surface| surface.points as u32);
            let others = surfaces.list.iter().skip(1).flat_map(|surface| surfaces.points_of(surface.patch));
            InFile {
                first: surfaces.first.ranks(),
                outer: surfaces.outer.ranks(),
                owned: others.map(|&(v, _)| v).zip(first..).collect(),
                on_boundary: surfaces.outer.count() as u32,
            }
        };
        Self { surfaces, in_file: as_in_file.then(in_file), elements: 0 }
    }

    /// Tag of the node with this index.
    pub(super) fn node(&self, v: u32) -> usize {
        let index = match &self.in_file {
            None => v,
            Some(place) if self.surfaces.first.has(v) => place.first.rank(v),
            Some(place) => place.owned.get(&v).copied().unwrap_or_else(|| place.on_boundary + v - place.outer.rank(v)),
        };
        index as usize + 1
    }

    /// Tag of the next element in the file, which has this index.
    pub(super) fn element(&mut self, index: usize) -> usize {
        self.elements += 1;
        if self.in_file.is_some() { self.elements } else { index + 1 }
    }
}
