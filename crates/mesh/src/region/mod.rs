//! Regions of a mesh: their names, the faces between them, and the mesh of each.

mod faces;
mod split;
#[cfg(test)]
mod tests;

pub(crate) use faces::faces_with;
pub use faces::{RegionFace, has_interfaces, label_faces, region_faces};
pub use split::{RegionMesh, RegionMeshes};

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
    /// Beginning of the names of interface patches.
    pub const INTERFACE: &str = "interface_";

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

    /// Regions of a patch that is named `interface_A_B` after two regions, the smaller id first.
    ///
    /// ```
    /// use anastomesh_mesh::NamedRegion;
    ///
    /// let regions = [NamedRegion::new(1, "lumen"), NamedRegion::new(2, "wall_2")];
    /// assert_eq!(NamedRegion::pair_of(&regions, "interface_wall_2_lumen"), Some([1, 2]));
    /// assert_eq!(NamedRegion::pair_of(&regions, "interface_lumen_tissue"), None);
    /// ```
    pub fn pair_of(regions: &[Self], patch: &str) -> Option<[i32; 2]> {
        let rest = patch.strip_prefix(Self::INTERFACE)?;
        regions.iter().find_map(|first| {
            let second = rest.strip_prefix(&first.name)?.strip_prefix('_')?;
            let second = Self::id_of(regions, second)?;
            Some([first.id.min(second), first.id.max(second)])
        })
    }

    /// Id of the region with a name.
    pub fn id_of(regions: &[Self], name: &str) -> Option<i32> {
        regions.iter().find(|region| region.name == name).map(|region| region.id)
    }
}
