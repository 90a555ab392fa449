//! Meshes in TetGen's `.ele` and `.face` over fixed points. A mesh that can be read can be checked.
#![no_main]

use anastomesh_io::tetgen::read_mesh_from;
use anastomesh_mesh::check::check_volume;
use libfuzzer_sys::fuzz_target;

const NODE: &[u8] = b"6 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n6 -1 0 0\n";

fuzz_target!(|bytes: &[u8]| {
    let at = bytes.iter().position(|&b| b == b'|').unwrap_or(bytes.len());
    let (ele, face) = (&bytes[..at], bytes.get(at + 1..).unwrap_or_default());
    if let Ok(volume) = read_mesh_from(NODE, ele, face) {
        let _ = check_volume(&volume, None);
    }
});
