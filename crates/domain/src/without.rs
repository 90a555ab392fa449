//! Removal of regions from a mesh.

use anastomesh_mesh::adjacency::vertices_of;
use anastomesh_mesh::{TET_FACES, TetMesh, VolumeMesh, face_key};
use rustc_hash::FxHashMap;

/// Mesh without some regions. Interfaces to them become outer boundary.
pub fn without(volume: VolumeMesh, regions: &[i32]) -> VolumeMesh {
    let VolumeMesh { mesh, tet_block, boundary, boundary_patch, mut patches, .. } = volume;
    let kept = tet_block.iter().map(|block| !regions.contains(block));
    let (tets, tet_block): (Vec<[u32; 4]>, Vec<i32>) = mesh
        .tets
        .into_iter()
        .zip(tet_block.iter().copied())
        .zip(kept)
        .filter(|(_, kept)| *kept)
        .map(|(tet, _)| tet)
        .unzip();
    // Each face as one of its tetrahedra has it, outwards; that of the smallest region.
    let mut sides: FxHashMap<[u32; 3], Option<([u32; 3], i32)>> =
        boundary.iter().map(|&face| (face_key(face), None)).collect();
    for (tet, &block) in tets.iter().zip(&tet_block) {
        for face in TET_FACES.map(|face| face.map(|corner| tet[corner])) {
            if let Some(side) = sides.get_mut(&face_key(face))
                && side.is_none_or(|(_, other)| block < other)
            {
                *side = Some((face, block));
            }
        }
    }
    let faces = boundary.iter().zip(&boundary_patch);
    let faces: Vec<([u32; 3], i32, i32)> = faces
        .filter_map(|(&face, &patch)| sides[&face_key(face)].map(|(own, block)| (same_start(face, own), patch, block)))
        .collect();
    let used = vertices_of(&tets, mesh.points.len());
    let mut number = vec![u32::MAX; used.len()];
    let mut points = Vec::new();
    for v in (0..used.len()).filter(|&v| used[v]) {
        number[v] = points.len() as u32;
        points.push(mesh.points[v]);
    }
    let moved = |v: u32| number[v as usize];
    patches.retain(|patch| faces.iter().any(|face| face.1 == patch.id));
    VolumeMesh {
        mesh: TetMesh { points, tets: tets.into_iter().map(|tet| tet.map(moved)).collect() },
        tet_block,
        boundary: faces.iter().map(|face| face.0.map(moved)).collect(),
        boundary_block: faces.iter().map(|face| face.2).collect(),
        boundary_patch: faces.iter().map(|face| face.1).collect(),
        patches,
    }
}

/// The face `own` with the first vertex of `face`.
fn same_start(face: [u32; 3], own: [u32; 3]) -> [u32; 3] {
    let [a, b, c] = own;
    [[a, b, c], [b, c, a], [c, a, b]].into_iter().find(|turned| turned[0] == face[0]).unwrap_or(own)
}
