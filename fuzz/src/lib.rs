//! Properties that the fuzz targets of one family of formats share, and networks from bytes.

pub mod networks;

use anastomesh_io::NetworkOptions;
use anastomesh_io::network::{NetworkFormat, read_network_from};
use anastomesh_io::surface::{SurfaceFormat, read_surface_from};
use anastomesh_io::tetgen::{Plc, PlcFormat};
use anastomesh_io::volume::{MeshFile, MeshFormat, read_mesh_from, write_mesh_to};
use anastomesh_mesh::check::{check_tets, check_volume};
use anastomesh_mesh::facets::triangulate;
use anastomesh_skeleton::clean;
use std::sync::Once;

/// Makes the fuzzer's thread the only one of the pool. Handing small inputs to another thread takes longer than the work.
pub fn stay_on_this_thread() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // The pool may exist already.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    });
}

/// Reads a network. A network that can be read is cleaned or refused with an error.
pub fn network(bytes: &[u8], format: NetworkFormat) {
    if let Ok(file) = read_network_from(bytes, format, &NetworkOptions::default()) {
        let _ = clean(&file.skeleton);
    }
}

/// Reads a surface. Its triangles refer to points that exist, and coordinates are finite.
pub fn surface(bytes: &[u8], format: SurfaceFormat) {
    if let Ok(surface) = read_surface_from(bytes, format) {
        assert!(surface.triangles.as_flattened().iter().all(|&v| (v as usize) < surface.points.len()));
        assert!(surface.points.iter().all(|p| p.iter().all(|x| x.is_finite())));
    }
}

/// Reads a mesh. A mesh that can be read can be checked. A mesh with valid indices and finite coordinates survives writing and reading.
pub fn mesh(bytes: &[u8], format: MeshFormat) {
    let Ok(file) = read_mesh_from(bytes, format) else { return };
    check(&file);
    let volume = &file.volume;
    let points = volume.mesh.points.len();
    let mut corners = volume.mesh.tets.as_flattened().iter().chain(volume.boundary.as_flattened());
    if corners.all(|&v| (v as usize) < points) && volume.mesh.points.iter().all(|p| p.iter().all(|x| x.is_finite())) {
        let mut written = Vec::new();
        write_mesh_to(&mut written, format, volume, &file.notes).expect("memory does not fail");
        let back = read_mesh_from(&written, format).expect("a written mesh can be read");
        assert_eq!(back.volume.mesh, volume.mesh);
    }
}

/// Checks a mesh that was read.
pub fn check(file: &MeshFile) {
    let _ = if file.labelled { check_volume(&file.volume, None) } else { check_tets(&file.volume.mesh, None) };
}

/// Reads a piecewise linear complex. Its facets are triangulated over their own corners or refused.
pub fn complex(bytes: &[u8], format: PlcFormat) {
    let Ok(plc) = Plc::parse(bytes, format) else { return };
    for facet in &plc.facets {
        if let Ok(cut) = triangulate(&plc.points, &facet.polygons, &facet.holes) {
            let known = |v: &u32| facet.polygons.iter().flatten().any(|corner| corner == v);
            assert!(cut.triangles.as_flattened().iter().chain(cut.segments.as_flattened()).all(known));
        }
    }
}
