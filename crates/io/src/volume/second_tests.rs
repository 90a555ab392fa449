//! Second-order meshes: every format restores them, and errors are found.

use super::*;
use crate::volume::content::SecondOrderFault;
use crate::volume::error::MeshFault;
use anastomesh_mesh::adjacency::boundary_faces;
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::shapes::tube_lattice;
use anastomesh_mesh::{NamedRegion, Patch, VolumeMesh, WALL};

fn tube() -> (VolumeMesh, SecondOrder) {
    let mesh = tube_lattice(2, 4, 0.4);
    let boundary = boundary_faces(&mesh);
    let is_end = |f: &[u32; 3]| f.iter().all(|&v| mesh.points[v as usize].z == mesh.points[f[0] as usize].z);
    let named = |(id, name): (i32, &str)| Patch { id, name: name.into(), cap: None };
    let volume = VolumeMesh {
        tet_block: vec![0; mesh.tets.len()],
        boundary_block: vec![0; boundary.len()],
        boundary_patch: boundary.iter().map(|f| WALL + i32::from(is_end(f))).collect(),
        patches: [(WALL, "wall"), (2, "inlet")].map(named).into(),
        boundary,
        mesh,
    };
    let second = SecondOrder::curved(&volume).0;
    (volume, second)
}

#[test]
fn files_restore_second_order_meshes() {
    let (volume, second) = tube();
    let folder = tempfile::tempdir().unwrap();
    for name in ["tube.vtu", "tube.msh", "tube.msh2", "tube.npyd"] {
        let path = folder.path().join(name);
        let options = WriteOptions::default().second_order(&second);
        write_mesh_with(&options, &path, &volume, &MeshNotes::default(), &()).unwrap();
        let file = read_mesh(&path).unwrap();
        assert_eq!(file.second_order.as_ref(), Some(&second), "{name}");
        assert_eq!(file.volume, volume, "{name}");
    }
}

#[test]
fn regions_of_second_order_meshes_are_restored() {
    let (mut volume, second) = tube();
    let half = volume.mesh.tets.len() / 2;
    volume.tet_block[half..].fill(2);
    volume.tet_block[..half].fill(1);
    let regions = [1, 2].map(NamedRegion::numbered).to_vec();
    let notes = MeshNotes { regions, ..MeshNotes::default() };
    let folder = tempfile::tempdir().unwrap();
    for name in ["tube.vtu", "tube.msh", "tube.msh2"] {
        let path = folder.path().join(name);
        write_mesh_with(&WriteOptions::default().second_order(&second), &path, &volume, &notes, &()).unwrap();
        let file = read_mesh(&path).unwrap();
        assert_eq!(file.second_order.as_ref(), Some(&second), "{name}");
        assert_eq!((file.volume.tet_block, file.notes.regions), (volume.tet_block.clone(), notes.regions.clone()));
    }
}

#[test]
fn other_formats_refuse_midpoints() {
    let (mut volume, second) = tube();
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, volume: &VolumeMesh| {
        let options = WriteOptions::default().second_order(&second);
        write_mesh_with(&options, &folder.path().join(name), volume, &MeshNotes::default(), &())
            .map_err(|e| e.to_string())
    };
    for name in ["tube.mesh", "tube.pvtu", "tube.ele", "tube.foam"] {
        let error = write(name, &volume).unwrap_err();
        assert!(error.contains(".vtu, .msh, .msh2, .npyd and .svmesh"), "{error}");
    }
    volume.mesh.points.push(anastomesh_mesh::Point3::origin());
    assert!(write("tube.vtu", &volume).unwrap_err().contains("another number of points"));
}

#[test]
fn mixed_orders_and_missing_nodes_are_faults() {
    let (volume, second) = tube();
    let mut bytes = Vec::new();
    super::msh::write_2(&mut bytes, &volume, &MeshNotes::default(), (None, Some(&second))).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let fault = |text: &str| match read_mesh_from(text.as_bytes(), MeshFormat::Msh2) {
        Err(MeshFault::Msh(faults::MshFault::SecondOrder(fault))) => Some(fault),
        _ => None,
    };
    assert_eq!(fault(&text), None);
    let line = text.lines().find(|line| line.split(' ').nth(1) == Some("9")).unwrap();
    let words: Vec<&str> = line.split(' ').collect();
    let linear = [&words[..1], &["2"], &words[2..8]].concat().join(" ");
    assert_eq!(fault(&text.replace(line, &linear)), Some(SecondOrderFault::MixedOrders));
    let astray = [&words[..10], &["999999"]].concat().join(" ");
    assert_eq!(fault(&text.replace(line, &astray)), Some(SecondOrderFault::MissingNode));
}
