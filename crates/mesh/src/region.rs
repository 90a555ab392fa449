//! Regions of a mesh: their names, and the regions beside each labelled face.

use super::adjacency::{NONE, face_vertices};
use super::{VolumeMesh, face_key, same_turn};
use rustc_hash::FxHashMap;

/// Region of a mesh with its name. [`VolumeMesh::tet_block`](crate::VolumeMesh::tet_block) holds the id of each tetrahedron.
///
/// A mesh with regions lists every outer boundary face once and every interface face once. An interface face lies
/// between two tetrahedra of different regions. It faces out of the region with the smaller id, which is its
/// [`boundary_block`](crate::VolumeMesh::boundary_block).
///
/// ```
/// use anastomesh_mesh::NamedRegion;
///
/// let regions = [NamedRegion::new(1, "lumen"), NamedRegion::numbered(7)];
/// assert_eq!(NamedRegion::name_of(&regions, 1), "lumen");
/// assert_eq!(NamedRegion::name_of(&regions, 7), "region_7");
/// assert_eq!(NamedRegion::name_of(&regions, 9), "region_9");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct NamedRegion {
    /// Id of the region.
    pub id: i32,
    /// Name of the region.
    pub name: String,
}

impl NamedRegion {
    /// Name of the region inside the vessels.
    pub const LUMEN: &str = "lumen";

    /// Region with a name.
    pub fn new(id: i32, name: impl Into<String>) -> Self {
        Self { id, name: name.into() }
    }

    /// Region with the default name `region_ID`.
    pub fn numbered(id: i32) -> Self {
        Self::new(id, format!("region_{id}"))
    }

    /// Regions with these ids, ascending, with default names.
    pub fn all_numbered(ids: impl IntoIterator<Item = i32>) -> Vec<Self> {
        let mut ids: Vec<i32> = ids.into_iter().collect();
        ids.sort_unstable();
        ids.dedup();
        ids.into_iter().map(Self::numbered).collect()
    }

    /// Name of a region; the default name if the list does not contain it.
    pub fn name_of(regions: &[Self], id: i32) -> String {
        regions
            .iter()
            .find(|region| region.id == id)
            .map_or_else(|| Self::numbered(id).name, |found| found.name.clone())
    }

    /// Id of the region with a name.
    pub fn id_of(regions: &[Self], name: &str) -> Option<i32> {
        regions.iter().find(|region| region.name == name).map(|region| region.id)
    }
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
        let region = |handle: &u32| tet_block.get(*handle as usize / 4).copied().unwrap_or(0);
        if let Some(own) = sides.iter().filter(|&&handle| handle != NONE).min_by_key(|handle| region(handle)) {
            *block = region(own);
            let outwards = face_vertices(&mesh.tets, *own);
            // Faces of a single region keep their orientation.
            let alone = sides.iter().all(|&handle| handle != NONE && region(&handle) == *block);
            if !alone && !same_turn(*face, outwards) {
                face.swap(1, 2);
            }
        }
    }
}

/// Handles of the tetrahedra at each listed face; [`NONE`] if there is no further one.
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
