//! One bifurcation cluster at three resolutions, end surfaces trimmed and closed by discs.

use anastomesh::testing::{
    BlockParams, Cluster, ClusterEnd, ClusterId, CutId, EndKind, EndStyle, Section, Tube, mesh_cluster, mesh_trimmed,
};
use anastomesh::{Point3, Vec3};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

/// Three vessels from one node, each cut at four units.
fn bifurcation() -> Cluster {
    let mut cluster = Cluster::default();
    for (i, (x, z, radius)) in [(0.0, 1.0, 1.0), (0.8, -0.7, 0.8), (-0.8, -0.6, 0.7)].into_iter().enumerate() {
        let axis = Vec3::new(x, 0.1, z).normalize();
        let origin = Point3::origin() + axis * 4.0;
        cluster.tubes.push(Tube { a: Point3::origin(), b: origin, ra: radius, rb: radius });
        cluster.tubes.push(Tube { a: origin, b: origin + axis * (1.7 * radius), ra: radius, rb: radius });
        let kind = EndKind::Cut { cut: CutId(i as u32), side: 0 };
        let overrun = cluster.tubes.len() as u32 - 1;
        cluster.ends.push(ClusterEnd { section: Section::new(origin, axis, radius), kind, overrun });
    }
    cluster
}

fn bench(c: &mut Criterion) {
    let cluster = bifurcation();
    let mut group = c.benchmark_group("cluster");
    group.sample_size(20);
    for rho in [3.0, 4.0, 5.0] {
        for ends in [EndStyle::Open, EndStyle::Disc] {
            let params = BlockParams { ends, ..BlockParams::with_rho(rho) };
            let make = if ends == EndStyle::Open { mesh_trimmed } else { mesh_cluster };
            let mesh = make(ClusterId(0), &cluster, &params).expect("the cluster is meshed");
            group.throughput(Throughput::Elements(mesh.mesh.tets.len() as u64));
            group.bench_with_input(
                BenchmarkId::new(if ends == EndStyle::Open { "trimmed" } else { "disc" }, rho),
                &params,
                |b, params| {
                    b.iter(|| make(ClusterId(0), black_box(&cluster), params));
                },
            );
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
