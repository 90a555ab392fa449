//! One damaged array among valid ones: a mesh, a network, a complex or an error. Memory stays in proportion to the bytes.
#![no_main]

use anastomesh_fuzz::check;
use anastomesh_io::NetworkOptions;
use anastomesh_io::network::read_network_arrays;
use anastomesh_io::surface::read_complex_arrays;
use anastomesh_io::volume::read_mesh_arrays;
use anastomesh_skeleton::clean;
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
            check(&file);
        }
        if let Ok(file) = read_network_arrays(&files, &NetworkOptions::default()) {
            let _ = clean(&file.skeleton);
        }
        let _ = read_complex_arrays(&files);
    }
});
