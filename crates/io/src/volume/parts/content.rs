//! Cells and boundary faces of each part.

use super::partition::Partition;
use super::shared::Shared;
use anastomesh_mesh::source::{MeshSource, miscounted};
use anastomesh_mesh::stacks::Cells;
use std::collections::BTreeMap;
use std::io;
use std::num::NonZeroUsize;

/// Mesh in parts, which are read one at a time.
pub(in crate::volume) struct PartReader<'a> {
    mesh: &'a dyn MeshSource,
    partition: Partition,
    cells: Option<Cells>,
    shared: Shared,
    /// Parts of the source with boundary faces of each part, and the number of the first face of each.
    sources: Vec<Vec<(u32, u32)>>,
    /// Numbers of boundary faces, by part and patch.
    faces: BTreeMap<(u32, i32), usize>,
}

/// Tetrahedra of a part, in the order of the mesh.
#[derive(Default)]
pub(in crate::volume) struct PartTets {
    pub ids: Vec<u32>,
    pub tets: Vec<[u32; 4]>,
    pub blocks: Vec<i32>,
}

/// Boundary faces of a part, in the order of the mesh.
#[derive(Default)]
pub(in crate::volume) struct PartFaces {
    pub ids: Vec<u32>,
    pub faces: Vec<[u32; 3]>,
    pub patches: Vec<i32>,
    pub blocks: Vec<i32>,
}

impl<'a> PartReader<'a> {
    /// Divides a mesh. Reads the tetrahedra three times and the boundary once, and once more if it has layers.
    ///
    /// # Errors
    /// As [`Partition::of`] and [`Shared::of`].
    pub(in crate::volume) fn of(mesh: &'a dyn MeshSource, parts: NonZeroUsize) -> io::Result<Self> {
        let cells = Cells::of(mesh)?;
        let partition = Partition::of(mesh, parts, cells.as_ref())?;
        let shared = Shared::of(mesh, &partition, cells.as_ref())?;
        let mut reader =
            Self { mesh, partition, cells, shared, sources: vec![Vec::new(); parts.get()], faces: BTreeMap::new() };
        reader.count_faces()?;
        Ok(reader)
    }

    fn count_faces(&mut self) -> io::Result<()> {
        let (mut source, mut first) = (0, 0);
        let (mesh, shared) = (self.mesh, &self.shared);
        mesh.each_part(
            |part| {
                let piece = mesh.boundary(part)?;
                let patch = |i: usize| piece.patches.get(i).copied().unwrap_or(0);
                let mut counts: BTreeMap<(u32, i32), usize> = BTreeMap::new();
                for (i, &face) in piece.faces.iter().enumerate() {
                    *counts.entry((shared.part_of_face(face), patch(i))).or_default() += 1;
                }
                Ok((piece.faces.len() as u32, counts))
            },
            |(count, counts)| {
                for ((part, patch), count) in counts {
                    let sources = &mut self.sources[part as usize];
                    if sources.last() != Some(&(source, first)) {
                        sources.push((source, first));
                    }
                    *self.faces.entry((part, patch)).or_default() += count;
                }
                (source, first) = (source + 1, first + count);
                Ok(())
            },
        )?;
        if first as usize == mesh.counts().boundary { Ok(()) } else { Err(miscounted()) }
    }

    /// Number of parts.
    pub(in crate::volume) fn parts(&self) -> u32 {
        self.partition.parts() as u32
    }

    /// Number of cells of the largest part.
    pub(in crate::volume) fn largest(&self) -> u32 {
        self.partition.sizes().iter().copied().max().unwrap_or(0)
    }

    /// Shared points and ghost cells.
    pub(in crate::volume) fn shared(&self) -> &Shared {
        &self.shared
    }

    /// Numbers of boundary faces, by part and patch.
    pub(in crate::volume) fn face_counts(&self) -> &BTreeMap<(u32, i32), usize> {
        &self.faces
    }

    /// Reads the tetrahedra of a part.
    ///
    /// # Errors
    /// The mesh source fails.
    pub(in crate::volume) fn tets(&self, part: u32) -> io::Result<PartTets> {
        let mut own = PartTets::default();
        let mut lookup = self.partition.lookup();
        let cell_of = |tet: u32| self.cells.as_ref().map_or(tet, |cells| cells.of_tet(tet));
        for run in self.partition.runs_of(part) {
            let piece = self.mesh.tets(run.source)?;
            let is_whole = run.only_part().is_some();
            for tet in run.tets.clone().filter(|&tet| is_whole || lookup.locate(cell_of(tet)).0 == part) {
                let index = (tet - run.start) as usize;
                own.ids.push(tet);
                own.tets.push(*piece.tets.get(index).ok_or_else(miscounted)?);
                own.blocks.push(piece.blocks.get(index).copied().unwrap_or(0));
            }
        }
        Ok(own)
    }

    /// Reads the boundary faces of a part.
    ///
    /// # Errors
    /// The mesh source fails.
    pub(in crate::volume) fn faces(&self, part: u32) -> io::Result<PartFaces> {
        let mut own = PartFaces::default();
        for &(source, first) in &self.sources[part as usize] {
            let piece = self.mesh.boundary(source)?;
            for (i, &face) in piece.faces.iter().enumerate() {
                if self.shared.part_of_face(face) == part {
                    own.ids.push(first + i as u32);
                    own.faces.push(face);
                    own.patches.push(piece.patches.get(i).copied().unwrap_or(0));
                    own.blocks.push(piece.blocks.get(i).copied().unwrap_or(0));
                }
            }
        }
        Ok(own)
    }
}
