//! Tests of round trips and of inconsistent arrays.

use super::{read, stage};
use crate::volume::content::{MeshFile, MeshNotes};
use crate::volume::fixtures::labelled_tube;
use crate::volume::in_pieces::InPieces;
use crate::volume::options::WriteOptions;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::source::MeshSource;
use std::fs;
use std::path::Path;

fn written(folder: &Path, mesh: &dyn MeshSource, notes: &MeshNotes) -> std::path::PathBuf {
    let path = folder.join("mesh.npyd");
    stage(&path, mesh, notes, &WriteOptions::default(), &()).unwrap().place().unwrap();
    path
}

#[test]
fn a_mesh_comes_back_whatever_pieces_it_is_written_in() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, notes) = labelled_tube(9);
    for sizes in [&[1000][..], &[1, 7, 30]] {
        let path = written(folder.path(), &InPieces { volume: &volume, sizes }, &notes);
        let back = read(&path).unwrap();
        assert_eq!(back, MeshFile { volume: volume.clone(), labelled: true, second_order: None, notes: notes.clone() });
    }
}

#[test]
fn points_and_tetrahedra_are_enough() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, notes) = labelled_tube(2);
    let path = written(folder.path(), &volume, &notes);
    for file in ["tet_blocks.npy", "triangle_patches.npy", "triangle_blocks.npy", "mesh.json"] {
        fs::remove_file(path.join(file)).unwrap();
    }
    let back = read(&path).unwrap();
    assert!(
        back.labelled && back.volume.boundary == volume.boundary && back.volume.boundary_patch.iter().all(|&p| p == 0)
    );
    fs::remove_file(path.join("triangles.npy")).unwrap();
    let back = read(&path).unwrap();
    assert!(!back.labelled && back.volume.mesh == volume.mesh);
    fs::remove_file(path.join("tets.npy")).unwrap();
    assert!(read(&path).unwrap_err().to_string().contains("tets.npy: is missing"));
}

#[test]
fn a_mesh_of_nothing_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), &VolumeMesh::default(), &MeshNotes::default());
    assert_eq!(read(&path).unwrap(), MeshFile::default());
}

#[test]
fn files_cut_off_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, notes) = labelled_tube(1);
    let path = written(folder.path(), &volume, &notes);
    for entry in fs::read_dir(&path).unwrap() {
        let file = entry.unwrap().path();
        let whole = fs::read(&file).unwrap();
        for end in 0..whole.len() {
            fs::write(&file, &whole[..end]).unwrap();
            assert!(read(&path).is_err(), "{} cut at {end}", file.display());
        }
        fs::write(&file, &whole).unwrap();
    }
    assert!(read(&path).is_ok());
}
