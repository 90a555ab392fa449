//! Whatever the bytes: a mesh or an error; a mesh can be checked, and one that is sound comes back from what is written.
#![no_main]

use anastomesh::testing::{MeshFormat, read_mesh_from, write_mesh_to};
use anastomesh::check::{check_tets, check_volume};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = read_mesh_from(bytes, MeshFormat::Medit) else { return };
    let volume = &file.volume;
    let _ = if file.labelled { check_volume(volume, None) } else { check_tets(&volume.mesh, None) };
    let points = volume.mesh.points.len();
    let cells = volume.mesh.tets.as_flattened().iter().chain(volume.boundary.as_flattened());
    if cells.into_iter().all(|&v| (v as usize) < points) && volume.mesh.points.iter().all(|p| p.iter().all(|x| x.is_finite())) {
        let mut written = Vec::new();
        write_mesh_to(&mut written, MeshFormat::Medit, volume, &file.notes).expect("memory");
        let back = read_mesh_from(&written, MeshFormat::Medit).expect("what is written can be read");
        assert_eq!(back.volume.mesh, volume.mesh);
    }
});
