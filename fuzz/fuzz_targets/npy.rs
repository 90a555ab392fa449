//! Whatever the bytes stand for among sound arrays: a mesh, a network or a complex, or an error; never more memory than they ask for.
#![no_main]

use anastomesh::check::{check_tets, check_volume};
use anastomesh::io::NetworkOptions;
use anastomesh::network::clean;
use anastomesh::testing::{read_complex_arrays, read_mesh_arrays, read_network_arrays};
use libfuzzer_sys::fuzz_target;

macro_rules! seeds {
    ($($name:literal),*) => { [$(($name, include_bytes!(concat!("../seeds/npy/", $name)).as_slice())),*] };
}

fuzz_target!(|bytes: &[u8]| {
    let sound = seeds!(
        "points.npy", "tets.npy", "tet_blocks.npy", "triangles.npy", "triangle_patches.npy", "mesh.json", "markers.npy",
        "segments.npy", "holes.npy", "regions.npy", "nodes.npy", "edges.npy", "radii.npy", "edge_radii.npy", "roots.npy"
    );
    for at in 0..sound.len() {
        let mut files = sound;
        files[at].1 = bytes;
        if let Ok(file) = read_mesh_arrays(&files) {
            let volume = &file.volume;
            let _ = if file.labelled { check_volume(volume, None) } else { check_tets(&volume.mesh, None) };
        }
        if let Ok(file) = read_network_arrays(&files, &NetworkOptions::default()) {
            let _ = clean(&file.skeleton);
        }
        let _ = read_complex_arrays(&files);
    }
});
