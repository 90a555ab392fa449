//! Bifurcations and bends by template beside contoured ones: how many there are, their shapes and times.
//!
//! `cargo bench --bench forks -- NETWORK...` for refined networks; the fixture without one.

use anastomesh::check::TetQuality;
use anastomesh::io::{NetworkOptions, read_network};
use anastomesh::network::clean;
use anastomesh::testing::{
    BlockParams, Cluster, ClusterId, ClusterMesh, EndKind, EndStyle, PartitionParams, SHARP_BEND, mesh_cluster,
    partition, shared_cells, template_of,
};
use std::path::Path;
use std::time::Instant;

/// Contoured forks are compared for every such fork.
const EVERY: usize = 10;

fn main() {
    let mut paths: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    if paths.is_empty() {
        paths.push(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/tree_30.vtp").into());
    }
    for path in paths {
        measure(path.as_ref());
    }
}

fn measure(path: &Path) {
    let file = read_network(path, &NetworkOptions::default()).expect("a network");
    let (network, _) = clean(&file.skeleton).expect("a sound network");
    let params = PartitionParams { cut_terminals: true, ..PartitionParams::default() };
    let mut clusters = partition(&network, &params).expect("a partition").clusters;
    let cells = shared_cells(clusters.len() as u32, 1.0, |i| clusters[i as usize].clone());
    (0..).zip(&mut clusters).for_each(|(i, cluster)| cluster.cells = cells.of(i));
    // Canonical forks are kept for a while, so forks of one follow each other.
    clusters.sort_by_key(template_of);
    println!("{}", path.display());
    compare("bifurcations", &clusters.iter().filter(|cluster| cluster.ends.len() > 2).collect::<Vec<_>>(), params.rho);
    compare("bends", &clusters.iter().filter(|cluster| is_bend(cluster)).collect::<Vec<_>>(), params.rho);
}

/// True for two straight vessels with a sharp bend between them.
fn is_bend(cluster: &Cluster) -> bool {
    let [a, b, _, _] = cluster.tubes.as_slice() else { return false };
    cluster.ends.len() == 2 && (a.b - a.a).angle(&(b.b - b.a)) > SHARP_BEND
}

fn compare(kind: &str, forks: &[&Cluster], rho: f64) {
    let is_cut = |cluster: &&&Cluster| cluster.ends.iter().all(|end| matches!(end.kind, EndKind::Cut { .. }));
    let between = forks.iter().filter(is_cut).count();
    let shared = BlockParams { ends: EndStyle::Shared, ..BlockParams::with_rho(rho) };
    // Templates are for usual parameters only.
    let contoured = BlockParams { shift: [1e-9, 0.0, 0.0], ..shared };
    let made = |cluster: &Cluster, params: &BlockParams| {
        let start = Instant::now();
        let mesh = mesh_cluster(ClusterId(0), cluster, params).ok();
        (mesh, start.elapsed().as_secs_f64())
    };
    let first: Vec<(Option<ClusterMesh>, f64)> = forks.iter().map(|fork| made(fork, &shared)).collect();
    let images: Vec<usize> =
        (0..forks.len()).filter(|&i| first[i].0.as_ref().is_some_and(ClusterMesh::is_image)).collect();
    let seconds: f64 = first.iter().map(|(_, seconds)| seconds).sum();
    drop(first);
    let (all, by_template) = (forks.len(), images.len());
    let share = share(by_template, all);
    println!("{kind}: {all}, {between} of them between cuts; by template {by_template} ({share:.1} %); {seconds:.2} s");
    for (name, params) in [("images", &shared), ("contoured", &contoured)] {
        let made: Vec<_> = images.iter().step_by(EVERY).map(|&i| made(forks[i], params)).collect();
        let quality: Vec<TetQuality> =
            made.iter().flat_map(|(mesh, _)| mesh).map(|m| TetQuality::of(&m.mesh)).collect();
        let mean = |of: fn(&TetQuality) -> f64| quality.iter().map(of).sum::<f64>() / quality.len() as f64;
        let worst = quality.iter().map(|quality| quality.min).fold(1.0, f64::min);
        let milliseconds = 1e3 * made.iter().map(|(_, seconds)| seconds).sum::<f64>() / made.len() as f64;
        let (least, average) = (mean(|quality| quality.min), mean(|quality| quality.mean));
        println!(
            "{name:9}  {milliseconds:.2} ms, radius ratio mean {average:.3}, smallest {least:.3} on average, {worst:.3} of all"
        );
    }
}

fn share(part: usize, of: usize) -> f64 {
    100.0 * part as f64 / of.max(1) as f64
}
