//! Labels of boundary faces: the wall and the patches that close vessels.

use anastomesh_mesh::face_key;
use rustc_hash::FxHashMap;

use anastomesh_mesh::adjacency::{self, TetAdjacency};
use anastomesh_mesh::{Patch, TetMesh, VolumeMesh, WALL};

/// Faces of one patch other than the wall.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchFaces {
    pub patch: Patch,
    /// Faces with vertices in any order.
    pub faces: Vec<[u32; 3]>,
}

/// Errors of labelling; each is a bug.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LabelError {
    /// A face of a patch is not a face of the boundary.
    #[error("face {face:?} of patch {patch} does not lie on the boundary")]
    NotOnBoundary {
        /// Patch id.
        patch: i32,
        face: [u32; 3],
    },
    /// A face belongs to two patches.
    #[error("face {face:?} belongs to patch {first} and to patch {second}")]
    Twice {
        face: [u32; 3],
        /// Id of the first patch.
        first: i32,
        /// Id of the second patch.
        second: i32,
    },
}

/// Assigns every boundary face of `mesh` to the patch that lists it, or else to the wall. Also returns the face
/// neighbours, which are computed on the way.
///
/// # Errors
/// A listed face is not on the boundary or is listed twice.
pub fn label(
    mesh: TetMesh,
    tet_block: Vec<i32>,
    patches: Vec<PatchFaces>,
) -> Result<(VolumeMesh, TetAdjacency), LabelError> {
    let mut listed: FxHashMap<[u32; 3], i32> = FxHashMap::default();
    for PatchFaces { patch, faces } in &patches {
        for &face in faces {
            if let Some(first) = listed.insert(face_key(face), patch.id) {
                return Err(LabelError::Twice { face, first, second: patch.id });
            }
        }
    }
    let mut out = VolumeMesh::default();
    let neighbors = adjacency::tet_adjacency(&mesh.tets, mesh.points.len());
    for handle in neighbors.boundary() {
        let face = adjacency::face_vertices(&mesh.tets, handle);
        out.boundary.push(face);
        out.boundary_block.push(tet_block[handle as usize / 4]);
        out.boundary_patch.push(listed.remove(&face_key(face)).unwrap_or(WALL));
    }
    out.mesh = mesh;
    // Remaining faces are not on the boundary; the smallest makes the message independent of hashing.
    if let Some((&face, &patch)) = listed.iter().min() {
        return Err(LabelError::NotOnBoundary { patch, face });
    }
    out.tet_block = tet_block;
    out.patches.push(Patch { id: WALL, name: "wall".into(), cap: None });
    out.patches.extend(patches.into_iter().map(|p| p.patch));
    out.patches.sort_by_key(|p| p.id);
    Ok((out, neighbors))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Point3;

    fn mesh() -> TetMesh {
        let p = |x, y, z| Point3::new(x, y, z);
        TetMesh { points: vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.)], tets: vec![[0, 1, 2, 3]] }
    }

    fn patch(id: i32, faces: Vec<[u32; 3]>) -> PatchFaces {
        PatchFaces { patch: Patch { id, name: format!("outlet_{}", id - 3), cap: None }, faces }
    }

    #[test]
    fn faces_that_no_patch_lists_are_wall() {
        let (labelled, _) = label(mesh(), vec![7], vec![patch(3, vec![[2, 1, 0]])]).expect("on the boundary");
        assert_eq!(labelled.boundary.len(), 4);
        assert_eq!(labelled.boundary_patch.iter().filter(|&&p| p == WALL).count(), 3);
        let capped = labelled.boundary_patch.iter().position(|&p| p == 3).expect("labelled");
        assert_eq!(face_key(labelled.boundary[capped]), [0, 1, 2]);
        assert_eq!(labelled.boundary_block, [7; 4]);
    }

    #[test]
    fn a_face_inside_or_listed_twice_is_an_error() {
        let inside = label(mesh(), vec![0], vec![patch(3, vec![[0, 1, 5]])]);
        assert!(matches!(inside, Err(LabelError::NotOnBoundary { patch: 3, .. })));
        let twice = label(mesh(), vec![0], vec![patch(3, vec![[0, 1, 2]]), patch(4, vec![[0, 2, 1]])]);
        assert!(matches!(twice, Err(LabelError::Twice { first: 3, second: 4, .. })));
    }
}
