//! Whatever the bytes: a complex whose facets are triangulated or refused, or an error.
#![no_main]

use anastomesh::io::tetgen::{Plc, PlcFormat};
use anastomesh::testing::triangulate;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(plc) = Plc::parse(bytes, PlcFormat::Poly) else { return };
    for facet in &plc.facets {
        if let Ok(cut) = triangulate(&plc.points, &facet.polygons, &facet.holes) {
            let known = |v: &u32| facet.polygons.iter().flatten().any(|corner| corner == v);
            assert!(cut.triangles.as_flattened().iter().chain(cut.segments.as_flattened()).all(known));
        }
    }
});
