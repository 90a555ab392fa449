//! Meshes in Gmsh's format.
#![no_main]

use anastomesh_fuzz::mesh;
use anastomesh_io::volume::MeshFormat;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| mesh(bytes, MeshFormat::Msh));
