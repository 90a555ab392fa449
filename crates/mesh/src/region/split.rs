//! Mesh of each region.

use super::NamedRegion;
use super::faces::{RegionFace, region_faces};
use crate::adjacency::NONE;
use crate::{Patch, TetMesh, VolumeMesh, face_key};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Region as a mesh of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionMesh {
    /// Id and name of the region.
    pub region: NamedRegion,
    /// Mesh with the patches that have faces in the region. All faces are oriented out of it.
    pub volume: VolumeMesh,
    /// Number in the whole mesh of each point, ascending.
    pub points: Vec<u32>,
    /// Number in the whole mesh of each tetrahedron, ascending.
    pub tets: Vec<u32>,
    /// Number in the whole mesh of the tetrahedron under each boundary face.
    pub face_tets: Vec<u32>,
}

/// Boundaries of all regions of a mesh. Faces without a label are in patches `interface_A_B` or `boundary`.
///
/// ```
/// use anastomesh_mesh::region::RegionMeshes;
/// use anastomesh_mesh::shapes::walled_channel;
///
/// let (volume, regions) = walled_channel(1);
/// let meshes = RegionMeshes::of(&volume, &regions);
/// let lumen = meshes.mesh(&regions[0]);
/// let names: Vec<&str> = lumen.volume.patches.iter().map(|patch| patch.name.as_str()).collect();
/// assert_eq!(names, ["inlet", "outlet_0", "interface_lumen_wall"]);
/// ```
pub struct RegionMeshes<'a> {
    volume: &'a VolumeMesh,
    faces: Vec<RegionFace>,
    /// Patch of each face.
    patches: Vec<i32>,
    /// Patches of the mesh, and those of faces without a label.
    named: Vec<Patch>,
}

impl<'a> RegionMeshes<'a> {
    /// Finds the boundaries of the regions.
    pub fn of(volume: &'a VolumeMesh, regions: &[NamedRegion]) -> Self {
        let faces = region_faces(&volume.mesh, &volume.tet_block);
        let labels = volume.boundary.iter().zip(&volume.boundary_patch);
        let labels: FxHashMap<[u32; 3], i32> = labels.map(|(&face, &patch)| (face_key(face), patch)).collect();
        let mut named = volume.patches.clone();
        let used = labels.values().copied().chain(named.iter().map(|patch| patch.id));
        let mut next = used.max().unwrap_or(0).max(0);
        let mut added: BTreeMap<(i32, Option<i32>), i32> = BTreeMap::new();
        let mut patch_of = |face: &RegionFace| {
            if let Some(&patch) = labels.get(&face_key(face.vertices)) {
                return patch;
            }
            let beyond = face.beyond.map(|(_, region)| region);
            let key = beyond.map_or((0, None), |beyond| (face.region, Some(beyond)));
            *added.entry(key).or_insert_with(|| {
                next = next.saturating_add(1);
                let name = |id| NamedRegion::name_of(regions, id);
                let name = beyond.map_or_else(
                    || "boundary".into(),
                    |beyond| format!("interface_{}_{}", name(face.region), name(beyond)),
                );
                named.push(Patch { id: next, name, cap: None });
                next
            })
        };
        let patches = faces.iter().map(&mut patch_of).collect();
        Self { volume, faces, patches, named }
    }

    /// Mesh of one region.
    pub fn mesh(&self, region: &NamedRegion) -> RegionMesh {
        let whole = self.volume;
        let of = |tet: u32| whole.tet_block.get(tet as usize).copied().unwrap_or(0);
        let tets: Vec<u32> = (0..whole.mesh.tets.len() as u32).filter(|&tet| of(tet) == region.id).collect();
        let mut numbers = vec![NONE; whole.mesh.points.len()];
        for &tet in &tets {
            whole.mesh.tets[tet as usize].iter().for_each(|&v| numbers[v as usize] = 0);
        }
        let points: Vec<u32> = (0..).zip(&numbers).filter(|(_, number)| **number == 0).map(|(v, _)| v).collect();
        (0..).zip(&points).for_each(|(number, &v)| numbers[v as usize] = number);
        let own = |v: u32| numbers[v as usize];
        let mesh = TetMesh {
            points: points.iter().map(|&v| whole.mesh.points[v as usize]).collect(),
            tets: tets.iter().map(|&tet| whole.mesh.tets[tet as usize].map(own)).collect(),
        };
        let (mut boundary, mut boundary_patch, mut face_tets) = (Vec::new(), Vec::new(), Vec::new());
        for (face, &patch) in self.faces.iter().zip(&self.patches) {
            let [a, b, c] = face.vertices;
            let (vertices, tet) = match face.beyond {
                _ if face.region == region.id => ([a, b, c], face.tet),
                Some((tet, beyond)) if beyond == region.id => ([a, c, b], tet),
                _ => continue,
            };
            boundary.push(vertices.map(own));
            boundary_patch.push(patch);
            face_tets.push(tet);
        }
        let mut used = boundary_patch.clone();
        used.sort_unstable();
        used.dedup();
        let patches = self.named.iter().filter(|patch| used.binary_search(&patch.id).is_ok()).cloned().collect();
        let volume = VolumeMesh {
            tet_block: vec![region.id; mesh.tets.len()],
            boundary_block: vec![region.id; boundary.len()],
            mesh,
            boundary,
            boundary_patch,
            patches,
        };
        RegionMesh { region: region.clone(), volume, points, tets, face_tets }
    }
}
