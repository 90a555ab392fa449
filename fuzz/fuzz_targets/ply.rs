//! Whatever the bytes: a surface whose triangles name points that exist, or an error.
#![no_main]

use anastomesh::testing::{SurfaceFormat, read_surface_from};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(surface) = read_surface_from(bytes, SurfaceFormat::Ply) {
        assert!(surface.triangles.as_flattened().iter().all(|&v| (v as usize) < surface.points.len()));
        assert!(surface.points.iter().all(|p| p.iter().all(|x| x.is_finite())));
    }
});
