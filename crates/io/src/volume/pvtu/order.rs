//! Order of mesh parts for pieces: along the tree of parts that share points. Pieces are ranges of this order and thus
//! separated at few joints.

use crate::volume::parts::BlockGraph;
use anastomesh_mesh::source::{FacePiece, LabelPiece, MeshSource, TetPiece};
use std::io;

/// Mesh with its parts in another order. Points keep their order and numbers.
pub(super) struct Reordered<'a> {
    mesh: &'a dyn MeshSource,
    order: Vec<u32>,
}

impl<'a> Reordered<'a> {
    /// Orders parts along the tree if each is a separate block, else keeps the order. Reads points and tetrahedra once.
    ///
    /// # Errors
    /// The mesh source fails.
    pub(super) fn along_the_tree(mesh: &'a dyn MeshSource) -> io::Result<Self> {
        let parts = graph_of(mesh)?;
        let order = parts.map_or_else(|| (0..mesh.parts()).collect(), |parts| parts.in_preorder(0..mesh.parts()));
        Ok(Self { mesh, order })
    }

    fn part(&self, part: u32) -> u32 {
        self.order[part as usize]
    }
}

impl MeshSource for Reordered<'_> {
    anastomesh_mesh::of_mesh!(counts, patches, parts, points, points_of);

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        self.mesh.tets(self.part(part))
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        self.mesh.boundary(self.part(part))
    }

    fn tet_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        self.mesh.tet_labels(self.part(part))
    }

    fn face_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        self.mesh.face_labels(self.part(part))
    }
}

/// Properties of a part.
struct Joined {
    /// Block of the part, if it is unique.
    block: Option<i32>,
    tets: u64,
    /// Other parts that own some of its points.
    owners: Vec<u32>,
}

impl Joined {
    /// Computes the properties; `starts` holds the first point added by each part.
    fn of(piece: &TetPiece, part: u32, starts: &[u32]) -> Self {
        let own = starts[part as usize]..starts[part as usize + 1];
        let mut others: Vec<u32> = piece.tets.as_flattened().iter().copied().filter(|v| !own.contains(v)).collect();
        others.sort_unstable();
        others.dedup();
        // A missing point is an error that the writer detects.
        others.retain(|v| starts.last().is_some_and(|end| v < end));
        let mut owners: Vec<u32> =
            others.into_iter().map(|v| starts.partition_point(|&start| start <= v) as u32 - 1).collect();
        owners.dedup();
        let block = piece.blocks.first().copied().filter(|block| piece.blocks.iter().all(|other| other == block));
        Self { block, tets: piece.tets.len() as u64, owners }
    }
}

/// Graph of parts. `None` if a part has several blocks, or a block several parts.
fn graph_of(mesh: &dyn MeshSource) -> io::Result<Option<BlockGraph>> {
    let mut starts = vec![0_u32];
    let mut sum = 0;
    mesh.each_part(
        |part| Ok(mesh.points(part)?.len() as u32),
        |count| {
            sum += count;
            starts.push(sum);
            Ok(())
        },
    )?;
    let mut parts = BlockGraph { neighbors: vec![Vec::new(); mesh.parts() as usize], sizes: Vec::new() };
    let mut blocks = Vec::with_capacity(parts.neighbors.len());
    mesh.each_part(
        |part| Ok(Joined::of(&mesh.tets(part)?, part, &starts)),
        |Joined { block, tets, owners }| {
            let part = parts.sizes.len() as u32;
            for other in owners {
                parts.neighbors[other as usize].push(part);
                parts.neighbors[part as usize].push(other);
            }
            parts.sizes.push(tets);
            blocks.push(block);
            Ok(())
        },
    )?;
    let count = blocks.len();
    blocks.sort_unstable();
    blocks.dedup();
    Ok(Some(parts).filter(|_| blocks.len() == count && blocks.iter().all(Option::is_some)))
}
