//! Block meshes → one mesh, by identity of vertices and never by a distance.

use crate::geometry::Point3;
use crate::mesh::TetMesh;

/// One block's mesh on its way into the whole.
#[derive(Clone, Debug)]
pub struct Part {
    /// The block's own mesh.
    pub mesh: TetMesh,
    /// Vertices that the block did not make: it took them over from blocks that come before it.
    pub shared: Vec<SharedVertex>,
}

/// A vertex of a part that is a vertex of an earlier part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharedVertex {
    /// Index in the part's own mesh.
    pub local: u32,
    /// The earlier part.
    pub part: u32,
    /// Index in the earlier part's mesh.
    pub vertex: u32,
}

/// All parts in one mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Merged {
    /// The mesh: parts in order, shared vertices once.
    pub mesh: TetMesh,
    /// For each tetrahedron the index of its part.
    pub tet_block: Vec<i32>,
    /// For each part and each of its own vertices the index in `mesh`.
    pub vertex_of: Vec<Vec<u32>>,
}

/// Why parts do not fit together. Any of these is a fault of the program, not of the network.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// A shared vertex names a part that does not come earlier, or a vertex that the parts do not have.
    #[error("part {part} refers to vertex {} of part {} as its vertex {}, which do not exist", shared.vertex, shared.part, shared.local)]
    Dangling {
        /// The part that refers.
        part: u32,
        /// What it refers to.
        shared: SharedVertex,
    },
    /// The two positions of a shared vertex differ.
    #[error("part {part} moved vertex {} that it took over from part {}: {there:?} became {here:?}", shared.vertex, shared.part)]
    Moved {
        /// The part that refers.
        part: u32,
        /// What it refers to.
        shared: SharedVertex,
        /// Position in the part.
        here: Point3,
        /// Position in the earlier part.
        there: Point3,
    },
    /// More vertices than a `u32` can count.
    #[error("the whole mesh has more vertices than 32 bits can count")]
    TooLarge,
}

/// Joins parts into one mesh. Vertices are renumbered in the order of the parts, so the result depends on nothing else.
///
/// # Errors
/// When a shared vertex does not exist or does not agree bit for bit, see [`MergeError`].
pub fn merge(parts: Vec<Part>) -> Result<Merged, MergeError> {
    let mut out = Merged::default();
    out.mesh.tets.reserve(parts.iter().map(|p| p.mesh.tets.len()).sum());
    out.tet_block.reserve(out.mesh.tets.capacity());
    for (index, part) in parts.into_iter().enumerate() {
        let numbers = number_vertices(&mut out, index as u32, &part)?;
        out.mesh.tets.extend(part.mesh.tets.iter().map(|t| t.map(|v| numbers[v as usize])));
        out.tet_block.resize(out.mesh.tets.len(), index as i32);
        out.vertex_of.push(numbers);
    }
    Ok(out)
}

/// Index in the whole of each vertex of a part; appends those that are new.
fn number_vertices(out: &mut Merged, index: u32, part: &Part) -> Result<Vec<u32>, MergeError> {
    const NEW: u32 = u32::MAX;
    let mut numbers = vec![NEW; part.mesh.points.len()];
    for &shared in &part.shared {
        let earlier = out.vertex_of.get(shared.part as usize).and_then(|p| p.get(shared.vertex as usize));
        let (Some(&there), Some(slot)) = (earlier, numbers.get_mut(shared.local as usize)) else {
            return Err(MergeError::Dangling { part: index, shared });
        };
        let (here, kept) = (part.mesh.points[shared.local as usize], out.mesh.points[there as usize]);
        if here != kept {
            return Err(MergeError::Moved { part: index, shared, here, there: kept });
        }
        *slot = there;
    }
    for (number, point) in numbers.iter_mut().zip(&part.mesh.points) {
        if *number == NEW {
            *number = u32::try_from(out.mesh.points.len()).ok().filter(|&n| n != NEW).ok_or(MergeError::TooLarge)?;
            out.mesh.points.push(*point);
        }
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tet(z: f64) -> TetMesh {
        let p = |x, y, z| Point3::new(x, y, z);
        TetMesh { points: vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., z)], tets: vec![[0, 1, 2, 3]] }
    }

    fn mirrored() -> Part {
        let mut mesh = tet(-1.0);
        mesh.tets = vec![[0, 2, 1, 3]];
        let shared = (0..3).map(|v| SharedVertex { local: v, part: 0, vertex: v }).collect();
        Part { mesh, shared }
    }

    #[test]
    fn shared_vertices_are_stored_once() {
        let merged = merge(vec![Part { mesh: tet(1.0), shared: vec![] }, mirrored()]).expect("fits");
        assert_eq!(merged.mesh.points.len(), 5);
        assert_eq!(merged.mesh.tets, [[0, 1, 2, 3], [0, 2, 1, 4]]);
        assert_eq!(merged.tet_block, [0, 1]);
        assert_eq!(merged.vertex_of[1], [0, 1, 2, 4]);
    }

    #[test]
    fn equal_positions_alone_do_not_join() {
        let merged = merge(vec![Part { mesh: tet(1.0), shared: vec![] }, Part { shared: vec![], ..mirrored() }]);
        assert_eq!(merged.expect("fits").mesh.points.len(), 8);
    }

    #[test]
    fn a_moved_or_missing_vertex_is_an_error() {
        let mut moved = mirrored();
        moved.mesh.points[1].x += 1e-15;
        let first = || Part { mesh: tet(1.0), shared: vec![] };
        assert!(matches!(merge(vec![first(), moved]), Err(MergeError::Moved { part: 1, .. })));
        let mut dangling = mirrored();
        dangling.shared[0].part = 1;
        assert!(matches!(merge(vec![first(), dangling]), Err(MergeError::Dangling { part: 1, .. })));
    }
}
