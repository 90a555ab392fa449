//! The wall of a bifurcation, from tubes to relaxed triangles, at the usual resolutions.

use anastomesh::Point3;
use anastomesh::testing::{SurfaceParams, Tube, vessel_surface};
use criterion::{Criterion, criterion_group, criterion_main};

fn tube(a: [f64; 3], b: [f64; 3], r: f64) -> Tube {
    Tube { a: Point3::from(a), b: Point3::from(b), ra: r, rb: r }
}

fn contour(c: &mut Criterion) {
    let fork = [
        tube([-8.0, 0.4, 0.3], [0.0; 3], 1.0),
        tube([0.0; 3], [6.0, 5.0, 0.8], 0.8),
        tube([0.0; 3], [6.0, -5.0, -0.5], 0.8),
    ];
    for rho in [3.0, 4.0, 5.0] {
        let params = SurfaceParams::with_voxel(1.6 / rho);
        c.bench_function(&format!("wall/bifurcation/rho {rho}"), |b| b.iter(|| vessel_surface(&fork, &params)));
    }
}

criterion_group!(benches, contour);
criterion_main!(benches);
