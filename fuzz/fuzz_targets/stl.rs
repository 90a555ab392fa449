//! Surfaces in STL.
#![no_main]

use anastomesh_fuzz::surface;
use anastomesh_io::surface::SurfaceFormat;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| surface(bytes, SurfaceFormat::Stl));
