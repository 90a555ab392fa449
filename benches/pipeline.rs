//! Benchmark of a whole network, from skeleton to checked mesh.
//!
//! The network is a subtree of a real kidney if the shared data exists, else the fixture. One thread runs per core, or
//! `RAYON_NUM_THREADS` threads.

use anastomesh::io::{NetworkOptions, read_network};
use anastomesh::meshing::{MeshPlan, mesh_network};
use anastomesh::network::{Skeleton, clean};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::{Path, PathBuf};

fn network() -> (String, Skeleton) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let shared = std::env::var_os("ANASTOMESH_SHARED").map_or_else(|| root.join("../shared"), PathBuf::from);
    let paths = [shared.join("data/kidney/subtree_59.vtp"), root.join("fixtures/tree_30.vtp")];
    let path = paths.into_iter().find(|path| path.is_file()).expect("the fixture is there");
    let file = read_network(&path, &NetworkOptions::default()).expect("a network");
    let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
    (name, clean(&file.skeleton).expect("a sound network").0)
}

fn pipeline(c: &mut Criterion) {
    let (name, network) = network();
    let mut group = c.benchmark_group("pipeline");
    group.sample_size(10);
    for rho in [3.0, 4.0, 5.0] {
        let mut plan = MeshPlan::default();
        plan.rho = rho;
        let run = || mesh_network(black_box(&network), &plan, &());
        let meshed = run().unwrap_or_else(|error| panic!("{name}, rho {rho}: {error}"));
        group.throughput(Throughput::Elements(meshed.report.mesh.tets as u64));
        group.bench_function(format!("{name}, rho {rho}"), |b| b.iter(run));
    }
    group.finish();
}

criterion_group!(benches, pipeline);
criterion_main!(benches);
