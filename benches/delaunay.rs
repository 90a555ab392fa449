//! Delaunay tetrahedralization of random points, and a torus from surface to improved mesh.

use anastomesh::Point3;
use anastomesh::mesh::shapes::torus_surface;
use anastomesh::testing::delaunay;
use anastomesh::tet::{Effort, Interior, Plc, Tetrahedralizer};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

fn random_points(n: usize) -> Vec<Point3> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut coordinate = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..n).map(|_| Point3::new(coordinate(), coordinate(), coordinate())).collect()
}

fn points(c: &mut Criterion) {
    let mut group = c.benchmark_group("delaunay");
    group.sample_size(10);
    for n in [10_000, 100_000] {
        let p = random_points(n);
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(format!("{n} random points"), |b| b.iter(|| delaunay(black_box(&p)).map(|c| c.slots())));
    }
    group.finish();
}

fn surface(c: &mut Criterion) {
    let mut group = c.benchmark_group("tetrahedralize");
    group.sample_size(10);
    let s = torus_surface(120, 42, 0.35);
    let plc = Plc::from(&s);
    let options = Tetrahedralizer::new().effort(Effort::Fast);
    group.throughput(Throughput::Elements(s.triangles.len() as u64));
    for (name, options) in [
        ("torus, no interior points", options.clone().interior(Interior::None).optimize(false)),
        ("torus, lattice", options.clone().optimize(false)),
        ("torus, lattice, improved", options),
    ] {
        group.bench_function(name, |b| b.iter(|| options.run(black_box(&plc)).map(|made| made.mesh.tets.len())));
    }
    group.finish();
}

criterion_group!(benches, points, surface);
criterion_main!(benches);
