//! Command line tests of `mesh --size-at`: shorter edges at bifurcations, stretched tubes.

mod common;

use anastomesh::io::read_mesh;
use anastomesh::{Point3, WALL};
use common::program::{BAD_INPUT, FINE, assert_code, assert_says, folder, json, mesh, run, stderr};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Position of the bifurcation.
const FORK: [f64; 3] = [0.0, 0.0, 20.0];

/// A bifurcation with long vessels, and a number for each of its nodes.
fn network(folder: &TempDir, sizes: [f64; 4]) -> PathBuf {
    let mut text = "id,x,y,z,radius,Size\n".to_owned();
    let nodes = [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 20.0, 1.0], [0.0, 14.0, 34.0, 0.8], [0.0, -14.0, 34.0, 0.8]];
    for (id, ([x, y, z, r], size)) in nodes.into_iter().zip(sizes).enumerate() {
        let _ = writeln!(text, "{id},{x},{y},{z},{r},{size}");
    }
    text.push_str("\nsource,target\n0,1\n1,2\n1,3\n");
    let path = folder.path().join("network.csv");
    fs::write(&path, text).expect("written");
    path
}

/// Valid mesh of the network: bytes, tetrahedra, and mean length of wall edges at the bifurcation and far from it.
fn made(network: &Path, options: &[&str]) -> (Vec<u8>, usize, [f64; 2]) {
    let out = network.with_file_name("out.vtu");
    assert_code(&mesh(network, &out, &[&["-q"], options].concat()), FINE);
    assert_code(&run("check", &[&out], &[]), FINE);
    let bytes = fs::read(&out).expect("the mesh");
    let volume = read_mesh(&out).expect("a mesh").volume;
    let length = |[a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|v| volume.mesh.points[v as usize]);
        let middle = Point3::from((a.coords + b.coords) / 2.0);
        ((middle - Point3::from(FORK)).norm(), (b - a).norm())
    };
    let wall = volume.boundary.iter().zip(&volume.boundary_patch).filter(|(_, patch)| **patch == WALL);
    let edges: Vec<(f64, f64)> = wall.flat_map(|(t, _)| (0..3).map(|i| [t[i], t[(i + 1) % 3]])).map(length).collect();
    let mean = |from: f64, to: f64| {
        let kept: Vec<f64> = edges.iter().filter(|(far, _)| (from..to).contains(far)).map(|edge| edge.1).collect();
        kept.iter().sum::<f64>() / kept.len() as f64
    };
    (bytes, volume.mesh.tets.len(), [mean(0.0, 1.12), mean(6.0, 10.0)])
}

#[test]
fn edges_are_shorter_at_forks_alone() {
    let folder = folder();
    let network = network(&folder, [1.0; 4]);
    let (plain, tets, [_, far]) = made(&network, &[]);
    fs::write(network.with_file_name("usual.vtu"), plain).expect("written");
    for factor in [0.5, 0.25] {
        let option = factor.to_string();
        let (bytes, more, [shorter, same]) = made(&network, &["--size-at", &option, "-j", "1"]);
        assert!((0.85..1.15).contains(&(shorter / far / factor)), "{factor}: {shorter} of {far}");
        assert!((0.98..1.02).contains(&(same / far)), "{factor}: {same} of {far}");
        assert!(more > tets, "{more} {tets}");
        // The number of threads has no influence.
        assert!(bytes == made(&network, &["--size-at", &option, "-j", "2"]).0);
    }
    // With factor 1 the mesh is the default one.
    made(&network, &["--size-at", "1"]);
    let [same, usual] = ["out.vtu", "usual.vtu"].map(|name| read_mesh(&network.with_file_name(name)).expect("a mesh"));
    assert!(same.volume.mesh == usual.volume.mesh);
}

#[test]
fn an_array_of_the_network_says_where() {
    let folder = folder();
    let plain = network(&folder, [1.0; 4]);
    let (_, tets, [_, far]) = made(&plain, &[]);
    let (_, finer, _) = made(&plain, &["--size-at", "0.5"]);
    // Edges at the bifurcation are half as long, and the vessels below it are stretched by about four.
    let sized = network(&folder, [1.0, 0.5, 8.0, 8.0]);
    let (bytes, stretched, [shorter, longer]) = made(&sized, &["--size-at", "size"]);
    assert!((0.85..1.15).contains(&(shorter / far / 0.5)), "{shorter} of {far}");
    assert!(longer > 1.2 * far, "{longer} of {far}");
    assert!(stretched < tets && stretched < finer, "{stretched} of {tets} and {finer}");
    assert!(bytes == made(&sized, &["--size-at", "size", "-j", "1"]).0);
    // Values beyond the limits are clamped, with a message.
    let out = folder.path().join("wild.vtu");
    let wild = mesh(&network(&folder, [1.0, 0.01, 500.0, 1.0]), &out, &["--size-at", "Size"]);
    assert_code(&wild, FINE);
    assert!(stderr(&wild).contains("edge length at 1 fork multiplied by 0.25"), "{}", stderr(&wild));
    assert!(stderr(&wild).contains("limited to the range 0.25 to 20: 1 fork and "), "{}", stderr(&wild));
}

#[test]
fn kept_blocks_are_found_by_what_was_asked_of_them() {
    let folder = folder();
    let sized = network(&folder, [1.0, 0.5, 8.0, 8.0]);
    let alone = made(&sized, &["--size-at", "Size"]).0;
    let work = folder.path().join("work");
    let options = |more: &[&'static str]| -> Vec<String> {
        let all = ["--size-at", "Size", "--work-dir"].into_iter().map(str::to_owned);
        all.chain([work.display().to_string()]).chain(more.iter().map(|&word| word.to_owned())).collect()
    };
    let run_with = |more: &[&'static str]| {
        let options = options(more);
        mesh(&sized, &folder.path().join("out.vtu"), &options.iter().map(String::as_str).collect::<Vec<_>>())
    };
    // Two shards, joined: existing blocks are not recomputed.
    for shard in ["1/2", "2/2"] {
        assert_code(&run_with(&["--shard", shard]), FINE);
    }
    assert_code(&run_with(&["-q"]), FINE);
    assert!(fs::read(folder.path().join("out.vtu")).expect("the mesh") == alone);
    let again = json(&run_with(&["--json"]));
    assert_eq!(again["check"]["verdict"], "valid");
    assert_eq!(again["plan"]["size_at"]["array"], "Size");
    assert!(fs::read(folder.path().join("out.vtu")).expect("the mesh") == alone);
    // Other numbers under this name define another run.
    network(&folder, [1.0, 0.6, 8.0, 8.0]);
    assert_says(&run_with(&[]), BAD_INPUT, &["--restart"]);
    assert_code(&run_with(&["--restart", "-q"]), FINE);
    assert!(fs::read(folder.path().join("out.vtu")).expect("the mesh") != alone);
}
