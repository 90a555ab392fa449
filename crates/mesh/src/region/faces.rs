//! Faces on the boundaries of regions.

use crate::adjacency::{NONE, TetAdjacency, face_vertices, tet_adjacency};
use crate::{VolumeMesh, face_key, same_turn};
use rustc_hash::FxHashMap;

/// Face on the boundary of a region: outer face or interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RegionFace {
    /// Vertices, oriented out of `region`.
    pub vertices: [u32; 3],
    /// Tetrahedron under the face, in `region`.
    pub tet: u32,
    /// Region of the tetrahedron; the smaller one of an interface.
    pub region: i32,
    /// Tetrahedron and region on the other side of an interface; `None` for an outer face.
    pub beyond: Option<(u32, i32)>,
}

/// All outer faces and interfaces of a mesh, in ascending order of tetrahedron and face. `regions` holds the region of each
/// tetrahedron; missing ones are 0. Faces of more than two tetrahedra are left out.
///
/// ```
/// use anastomesh_mesh::region::region_faces;
/// use anastomesh_mesh::shapes::cube_lattice;
///
/// let mesh = cube_lattice(2);
/// // Left half and right half.
/// let right = |t: &[u32; 4]| t.iter().map(|&v| mesh.points[v as usize].x).sum::<f64>() > 2.0;
/// let regions: Vec<i32> = mesh.tets.iter().map(|t| 1 + i32::from(right(t))).collect();
/// let faces = region_faces(&mesh, &regions);
/// assert_eq!(faces.iter().filter(|face| face.beyond.is_some()).count(), 8);
/// assert_eq!(faces.len(), 8 + 48);
/// ```
pub fn region_faces(mesh: &crate::TetMesh, regions: &[i32]) -> Vec<RegionFace> {
    faces_with(&mesh.tets, regions, &tet_adjacency(&mesh.tets, mesh.points.len()))
}

/// As [`region_faces`], with known adjacency.
pub(crate) fn faces_with(tets: &[[u32; 4]], regions: &[i32], adjacency: &TetAdjacency) -> Vec<RegionFace> {
    let of = |tet: u32| regions.get(tet as usize).copied().unwrap_or(0);
    let mut faces = Vec::new();
    for (handle, &neighbor) in (0..).zip(adjacency.neighbors.as_flattened()) {
        let (tet, region) = (handle / 4, of(handle / 4));
        let beyond = if neighbor == NONE {
            if adjacency.crowded.binary_search(&handle).is_ok() {
                continue;
            }
            None
        } else {
            let other = of(neighbor / 4);
            if region >= other {
                continue;
            }
            Some((neighbor / 4, other))
        };
        faces.push(RegionFace { vertices: face_vertices(tets, handle), tet, region, beyond });
    }
    faces
}

/// Sets the block of each labelled face: the smaller region of its tetrahedra. Turns interface faces out of that region.
///
/// ```
/// use anastomesh_mesh::shapes::cube_lattice;
/// use anastomesh_mesh::{VolumeMesh, adjacency::boundary_faces, region::label_faces};
///
/// let mesh = cube_lattice(1);
/// let mut volume = VolumeMesh {
///     tet_block: vec![7; mesh.tets.len()],
///     boundary: boundary_faces(&mesh),
///     mesh,
///     ..VolumeMesh::default()
/// };
/// label_faces(&mut volume);
/// assert_eq!(volume.boundary_block, [7; 12]);
/// ```
pub fn label_faces(volume: &mut VolumeMesh) {
    let sides = sides_of_listed(volume);
    let VolumeMesh { mesh, tet_block, boundary, boundary_block, .. } = volume;
    boundary_block.clear();
    boundary_block.resize(boundary.len(), 0);
    for ((face, block), sides) in boundary.iter_mut().zip(boundary_block).zip(sides) {
        let region = |handle: u32| tet_block.get(handle as usize / 4).copied().unwrap_or(0);
        let Some(own) = sides.into_iter().filter(|&handle| handle != NONE).min_by_key(|&handle| region(handle)) else {
            continue;
        };
        *block = region(own);
        let outwards = face_vertices(&mesh.tets, own);
        // Faces of a single region keep their orientation.
        let is_interface = sides.iter().all(|&handle| handle != NONE) && region(sides[0]) != region(sides[1]);
        if is_interface && !same_turn(*face, outwards) {
            face.swap(1, 2);
        }
    }
}

/// True if a labelled face lies between two tetrahedra of different blocks. Blocks of such a mesh are regions.
pub fn has_interfaces(volume: &VolumeMesh) -> bool {
    let block = |handle: u32| volume.tet_block.get(handle as usize / 4);
    let differ = volume.tet_block.windows(2).any(|pair| pair[0] != pair[1]);
    differ && sides_of_listed(volume).iter().any(|&[a, b]| a != NONE && b != NONE && block(a) != block(b))
}

/// Handles (`4 · tet + face`) of the tetrahedra at each listed face; `NONE` if there is no further one.
fn sides_of_listed(volume: &VolumeMesh) -> Vec<[u32; 2]> {
    let listed: FxHashMap<[u32; 3], usize> =
        volume.boundary.iter().enumerate().map(|(i, &face)| (face_key(face), i)).collect();
    let mut sides = vec![[NONE; 2]; volume.boundary.len()];
    for handle in 0..4 * volume.mesh.tets.len() as u32 {
        if let Some(&i) = listed.get(&face_key(face_vertices(&volume.mesh.tets, handle)))
            && let Some(free) = sides[i].iter_mut().find(|side| **side == NONE)
        {
            *free = handle;
        }
    }
    sides
}
