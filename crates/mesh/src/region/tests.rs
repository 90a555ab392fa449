//! Tests of faces and meshes of regions.

use super::*;
use crate::adjacency::boundary_faces;
use crate::check::check_volume;
use crate::shapes::{cube_lattice, walled_channel};
use crate::{VolumeMesh, face_key};

#[test]
fn faces_of_a_channel_have_their_regions() {
    let (volume, _) = walled_channel(1);
    // Five cells of 1 × 1 in the lumen, of 3 × 3 within the wall.
    let count = |name: &str| {
        let id = volume.patches.iter().find(|patch| patch.name == name).unwrap().id;
        volume.boundary_patch.iter().filter(|patch| **patch == id).count()
    };
    let names = ["inlet", "outlet_0", "interface_lumen_wall", "interface_wall_tissue", "ring_inlet", "ring_outlet_0"];
    assert_eq!(names.map(count), [2, 2, 40, 120, 16, 16]);
    assert_eq!(count("organ"), 2 * (25 - 9) * 2 + 4 * 25 * 2);
}

#[test]
fn labels_of_faces_come_back() {
    let (volume, _) = walled_channel(1);
    let mut lost = volume.clone();
    lost.boundary_block.fill(0);
    for face in lost.boundary.iter_mut().zip(&volume.boundary_patch).filter(|(_, patch)| [4, 5].contains(*patch)) {
        face.0.swap(0, 2);
    }
    label_faces(&mut lost);
    let keys = |volume: &VolumeMesh| volume.boundary.iter().map(|&face| face_key(face)).collect::<Vec<_>>();
    assert_eq!((lost.boundary_block.clone(), keys(&lost)), (volume.boundary_block.clone(), keys(&volume)));
    assert!(lost.boundary.iter().zip(&volume.boundary).all(|(a, b)| crate::same_turn(*a, *b)));
    assert!(has_interfaces(&volume));
    let mut outer = volume.clone();
    outer.boundary = boundary_faces(&volume.mesh);
    assert!(!has_interfaces(&outer) && !has_interfaces(&VolumeMesh::default()));
}

#[test]
fn regions_are_meshes_of_their_own() {
    let (volume, regions) = walled_channel(2);
    let meshes = RegionMeshes::of(&volume, &regions);
    let mut tets = Vec::new();
    for region in &regions {
        let part = meshes.mesh(region);
        let report = check_volume(&part.volume, None);
        assert_eq!(report.failed().count(), 0, "{report}");
        assert_eq!((report.counts.components, report.counts.boundary_components), (1, 1));
        for (own, &number) in part.volume.mesh.points.iter().zip(&part.points) {
            assert_eq!(*own, volume.mesh.points[number as usize]);
        }
        for (own, &number) in part.volume.mesh.tets.iter().zip(&part.tets) {
            assert_eq!(own.map(|v| part.points[v as usize]), volume.mesh.tets[number as usize]);
        }
        for (face, &tet) in part.volume.boundary.iter().zip(&part.face_tets) {
            let tet = volume.mesh.tets[tet as usize];
            assert!(face.iter().all(|&v| tet.contains(&part.points[v as usize])));
        }
        tets.extend(part.tets);
    }
    tets.sort_unstable();
    assert!(tets.iter().copied().eq(0..volume.mesh.tets.len() as u32));
}

#[test]
fn faces_without_a_label_are_interfaces() {
    let mesh = cube_lattice(2);
    let upper = |t: &[u32; 4]| t.iter().map(|&v| mesh.points[v as usize].z).sum::<f64>() > 2.0;
    let tet_block = mesh.tets.iter().map(|t| if upper(t) { 5 } else { -3 }).collect();
    let volume = VolumeMesh { mesh: mesh.clone(), tet_block, ..VolumeMesh::default() };
    let regions = NamedRegion::all_numbered([5, -3, 5]);
    let part = RegionMeshes::of(&volume, &regions).mesh(&regions[1]);
    let names: Vec<&str> = part.volume.patches.iter().map(|patch| patch.name.as_str()).collect();
    assert_eq!(names, ["boundary", "interface_region_-3_region_5"]);
    let interface = part.volume.patches[1].id;
    assert_eq!(part.volume.boundary_patch.iter().filter(|&&patch| patch == interface).count(), 8);
    assert_eq!(check_volume(&part.volume, None).failed().count(), 0);
}
