//! Tests of partitioned meshes.

use crate::volume::fixtures::{labelled_tube, slab};
use crate::volume::in_pieces::InPieces;
use crate::volume::{MeshNotes, WriteOptions, read_mesh, write_mesh_with};
use anastomesh_mesh::NamedRegion;
use anastomesh_mesh::source::MeshSource;
use std::num::NonZeroUsize;

fn written(mesh: &dyn MeshSource, notes: &MeshNotes, parts: usize) -> Result<tempfile::TempDir, String> {
    let folder = tempfile::tempdir().unwrap();
    let options = WriteOptions::default().parts(NonZeroUsize::new(parts));
    write_mesh_with(&options, &folder.path().join("a.msh"), mesh, notes, &()).map_err(|e| e.to_string())?;
    Ok(folder)
}

#[test]
fn a_partitioned_mesh_is_read_as_the_undivided_one() {
    let (volume, notes) = labelled_tube(9);
    for parts in [1, 2, 7] {
        let folder = written(&volume, &notes, parts).unwrap();
        let read = read_mesh(&folder.path().join("a.msh")).unwrap();
        assert_eq!(read.volume.mesh, volume.mesh);
        assert_eq!(read.volume.boundary, volume.boundary);
        assert_eq!(read.volume.boundary_patch, volume.boundary_patch);
        assert_eq!(read.volume.patches, volume.patches);
        assert_eq!(read.notes, notes);
    }
    let folder = written(&InPieces { volume: &volume, sizes: &[7, 100] }, &notes, 3).unwrap();
    assert_eq!(read_mesh(&folder.path().join("a.msh")).unwrap().volume.mesh, volume.mesh);
    let folder = written(&slab(), &MeshNotes::default(), 2).unwrap();
    assert_eq!(read_mesh(&folder.path().join("a.msh")).unwrap().volume.mesh, slab().mesh);
}

#[test]
fn regions_are_refused() {
    let (volume, notes) = labelled_tube(1);
    let regions = vec![NamedRegion::new(1, "lumen")];
    let error = written(&volume, &MeshNotes { regions, ..notes }, 2).unwrap_err();
    assert!(error.contains("regions of an MSH file cannot be written in parts; write .pvtu"), "{error}");
}
