//! Points shared by several parts, and the ghost cells around them.

use super::partition::Partition;
use anastomesh_mesh::bits::Bits;
use anastomesh_mesh::source::{MeshSource, TetPiece};
use anastomesh_mesh::stacks::Cells;
use anastomesh_mesh::{TET_FACES, face_key};
use rustc_hash::{FxHashMap, FxHashSet};
use std::io;

/// Marks a point without tetrahedra.
const NONE: u32 = u32::MAX;

/// Ghost cell of a part: a tetrahedron of another part that shares a point with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::volume) struct Ghost {
    /// Part that receives the copy.
    pub part: u32,
    /// Number of the tetrahedron in the mesh.
    pub tet: u32,
    /// Part of the tetrahedron.
    pub owner: u32,
    pub vertices: [u32; 4],
    pub block: i32,
}

/// Points of a mesh in parts. Needs 4 bytes per point, and 32 bytes per ghost cell.
pub(in crate::volume) struct Shared {
    /// First part of each point, in the order of the tetrahedra.
    owners: Vec<u32>,
    /// Further parts of shared points, in ascending order.
    others: Vec<(u32, u32)>,
    /// Points of several parts.
    common: Bits,
    /// Parts of tetrahedra, by their faces with shared points only.
    rim: FxHashMap<[u32; 3], u32>,
    /// Ascending by part and tetrahedron.
    ghosts: Vec<Ghost>,
}

/// Passes on the parts of tetrahedra.
pub(super) fn each_part_of_tets(
    mesh: &dyn MeshSource,
    partition: &Partition,
    cells: Option<&Cells>,
    mut each: impl FnMut(&TetPiece, u32, &[u32]) -> io::Result<()>,
) -> io::Result<()> {
    let mut lookup = partition.lookup();
    let (mut first, mut parts) = (0, Vec::new());
    mesh.each_tets(|piece| {
        parts.clear();
        let tets = first..first + piece.tets.len() as u32;
        parts.extend(tets.clone().map(|tet| lookup.locate(cells.map_or(tet, |cells| cells.of_tet(tet))).0));
        each(piece, first, &parts)?;
        first = tets.end;
        Ok(())
    })
}

impl Shared {
    /// Finds shared points and ghost cells. Reads the tetrahedra twice.
    ///
    /// # Errors
    /// The mesh source fails; `InvalidData` if a cell refers to a missing point.
    pub(in crate::volume) fn of(
        mesh: &dyn MeshSource,
        partition: &Partition,
        cells: Option<&Cells>,
    ) -> io::Result<Self> {
        let count = mesh.counts().points;
        let mut owners = vec![NONE; count];
        let mut others: FxHashSet<(u32, u32)> = FxHashSet::default();
        each_part_of_tets(mesh, partition, cells, |piece, _, parts| {
            for (tet, &part) in piece.tets.iter().zip(parts) {
                for &v in tet {
                    let owner = owners.get_mut(v as usize).ok_or_else(|| missing(v))?;
                    if *owner == NONE {
                        *owner = part;
                    } else if *owner != part {
                        others.insert((v, part));
                    }
                }
            }
            Ok(())
        })?;
        let mut others: Vec<(u32, u32)> = others.into_iter().collect();
        others.sort_unstable();
        let mut points = Bits::new(count);
        for &(v, _) in &others {
            points.insert(v);
        }
        let mut shared = Self { owners, others, common: points, rim: FxHashMap::default(), ghosts: Vec::new() };
        each_part_of_tets(mesh, partition, cells, |piece, first, parts| {
            for (i, (tet, &part)) in piece.tets.iter().zip(parts).enumerate() {
                let block = piece.blocks.get(i).copied().unwrap_or(0);
                shared.add_ghosts(Ghost { part, tet: first + i as u32, owner: part, vertices: *tet, block });
            }
            Ok(())
        })?;
        shared.ghosts.sort_unstable();
        Ok(shared)
    }

    /// Adds the copies of a tetrahedron to other parts.
    fn add_ghosts(&mut self, own: Ghost) {
        let Ghost { part, vertices, .. } = own;
        let count = vertices.iter().filter(|&&v| self.common.has(v)).count();
        if count == 0 {
            return;
        }
        let mut parts: Vec<u32> = vertices.iter().flat_map(|&v| self.parts_of(v)).filter(|&p| p != part).collect();
        parts.sort_unstable();
        parts.dedup();
        self.ghosts.extend(parts.into_iter().map(|part| Ghost { part, ..own }));
        if count >= 3 {
            let faces = TET_FACES.map(|face| face.map(|i| vertices[i]));
            let faces = faces.iter().filter(|face| face.iter().all(|&v| self.common.has(v)));
            let keys: Vec<[u32; 3]> = faces.map(|face| face_key(*face)).collect();
            self.rim.extend(keys.into_iter().map(|key| (key, part)));
        }
    }

    /// Parts of a point: first its owner.
    fn parts_of(&self, v: u32) -> impl Iterator<Item = u32> {
        let owner = self.owner(v);
        let start = self.others.partition_point(|&(other, _)| other < v);
        let more = self.others[start..].iter().take_while(move |(other, _)| *other == v).map(|&(_, part)| part);
        owner.into_iter().chain(more)
    }

    /// Part that owns a point; `None` for a point without tetrahedra.
    pub(in crate::volume) fn owner(&self, v: u32) -> Option<u32> {
        self.owners.get(v as usize).copied().filter(|&part| part != NONE)
    }

    /// Part of the tetrahedron under a boundary face; the first one for a face without a tetrahedron.
    pub(in crate::volume) fn part_of_face(&self, face: [u32; 3]) -> u32 {
        let inside = face.into_iter().find(|&v| !self.common.has(v));
        let of_rim = || self.rim.get(&face_key(face)).copied();
        inside.map_or_else(of_rim, |v| self.owner(v)).unwrap_or(0)
    }

    /// Ghost cells of a part, ascending by tetrahedron.
    pub(in crate::volume) fn ghosts_of(&self, part: u32) -> &[Ghost] {
        let start = self.ghosts.partition_point(|ghost| ghost.part < part);
        let length = self.ghosts[start..].partition_point(|ghost| ghost.part == part);
        &self.ghosts[start..start + length]
    }

    /// All ghost cells.
    pub(in crate::volume) fn ghosts(&self) -> &[Ghost] {
        &self.ghosts
    }

    /// Points without tetrahedra.
    pub(in crate::volume) fn unused(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.owners).filter(|(_, owner)| **owner == NONE).map(|(v, _)| v)
    }
}

fn missing(v: u32) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("a cell names the point {v}, which does not exist"))
}
