//! Command line tests of `--size-at` (shorter edges at bifurcations, stretched tubes) and `--sizes-from` (edge lengths at
//! points).

use crate::common::program::{BAD_INPUT, FINE, assert_code, assert_says, fill, folder, json, mesh, run, stderr};
use anastomesh::io::read_mesh;
use anastomesh::{Point3, WALL};
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
    made_near(FORK, network, options)
}

/// As [`made`], with the lengths at and far from another position.
fn made_near(place: [f64; 3], network: &Path, options: &[&str]) -> (Vec<u8>, usize, [f64; 2]) {
    let out = network.with_file_name("out.vtu");
    assert_code(&mesh(network, &out, &[&["-q"], options].concat()), FINE);
    assert_code(&run("check", &[&out], &[]), FINE);
    let bytes = fs::read(&out).expect("the mesh");
    let volume = read_mesh(&out).expect("a mesh").volume;
    let length = |[a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|v| volume.mesh.points[v as usize]);
        let middle = Point3::from((a.coords + b.coords) / 2.0);
        ((middle - Point3::from(place)).norm(), (b - a).norm())
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

/// Points on the axis of the first vessel with edge lengths, as a grid: short between z = 8 and z = 12.
fn lengths(folder: &TempDir, short: f64) -> PathBuf {
    let heights: Vec<f64> = (0..=40).map(|i| 0.5 * f64::from(i)).collect();
    let points: String = heights.iter().map(|z| format!("0 0 {z} ")).collect();
    let values: String =
        heights.iter().map(|z| format!("{} ", if (8.0..=12.0).contains(z) { short } else { 9.0 })).collect();
    let array = |head: &str, values: &str| format!("<DataArray {head} format='ascii'>{values}</DataArray>");
    let cells = ["connectivity", "offsets", "types"].map(|name| array(&format!("type='Int64' Name='{name}'"), ""));
    let text = format!(
        "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='41' NumberOfCells='0'>\
        <Points>{}</Points><Cells>{}</Cells><PointData>{}</PointData></Piece></UnstructuredGrid></VTKFile>",
        array("type='Float64' NumberOfComponents='3'", &points),
        cells.concat(),
        array("type='Float64' Name='edge'", &values),
    );
    let path = folder.path().join("lengths.vtu");
    fs::write(&path, text).expect("written");
    path
}

#[test]
fn edges_are_shorter_where_an_earlier_mesh_asks_for_it() {
    let folder = folder();
    let (network, middle) = (network(&folder, [1.0; 4]), [0.0, 0.0, 10.0]);
    let (plain, tets, [usual, far]) = made_near(middle, &network, &[]);
    for share in [0.6, 0.3] {
        let lengths = lengths(&folder, share * usual).display().to_string();
        let options = ["--sizes-from", &lengths, "--array", "edge", "-j"];
        let (bytes, more, [shorter, same]) = made_near(middle, &network, &[&options[..], &["1"]].concat());
        assert!((0.85..1.15).contains(&(shorter / usual / share)), "{share}: {shorter} of {usual}");
        assert!((0.95..1.05).contains(&(same / far)), "{share}: {same} of {far}");
        assert!(more > tets, "{more} {tets}");
        assert!(bytes == made_near(middle, &network, &[&options[..], &["2"]].concat()).0);
    }
    // Longer edges than those of the resolution change nothing, and the log reports it.
    let lengths = lengths(&folder, 1.0).display().to_string();
    let out = folder.path().join("same.vtu");
    let same = mesh(&network, &out, &["--sizes-from", &lengths, "--array", "edge"]);
    assert!(
        stderr(&same).contains("sizes-from edge: edges are at most as long as requested everywhere"),
        "{}",
        stderr(&same)
    );
    fs::write(folder.path().join("plain.vtu"), plain).expect("written");
    let [same, plain] = ["same.vtu", "plain.vtu"].map(|name| read_mesh(&folder.path().join(name)).expect("a mesh"));
    assert!(same.volume.mesh == plain.volume.mesh);
    // A request below the limit is counted.
    let low =
        mesh(&network, &out, &["--sizes-from", &self::lengths(&folder, 0.01).display().to_string(), "--array", "edge"]);
    assert_code(&low, FINE);
    assert!(stderr(&low).contains("of them the field requests less"), "{}", stderr(&low));
}

#[test]
fn surfaces_are_filled_as_finely_as_an_earlier_mesh_asks_for() {
    let folder = folder();
    let [surface, plain, fine] = ["wall.off", "plain.vtu", "fine.vtu"].map(|name| folder.path().join(name));
    assert_code(&run("surface", &[&network(&folder, [1.0; 4])], &["-q", "-o", &surface.display().to_string()]), FINE);
    let lengths = lengths(&folder, 0.15).display().to_string();
    assert_code(&fill(&surface, &plain, &["-q"]), FINE);
    assert_code(&fill(&surface, &fine, &["-q", "--sizes-from", &lengths, "--array", "edge"]), FINE);
    assert_code(&run("check", &[&fine], &[]), FINE);
    // Interior points near the axis, where the field is short and where it is not.
    let count = |path: &Path, z: f64| {
        let points = read_mesh(path).expect("a mesh").volume.mesh.points;
        points.iter().filter(|p| p.x.hypot(p.y) < 0.7 && (p.z - z).abs() < 1.5).count()
    };
    assert!(count(&fine, 10.0) > 4 * count(&plain, 10.0), "{} of {}", count(&fine, 10.0), count(&plain, 10.0));
    assert!(count(&fine, 3.0) < 2 * count(&plain, 3.0), "{} of {}", count(&fine, 3.0), count(&plain, 3.0));
    let other = fill(&surface, &fine, &["--sizes-from", &lengths, "--array", "size"]);
    assert_says(&other, BAD_INPUT, &["there is no array 'size'", "'edge'"]);
}
