//! `mesh --certificate`, and the meshes of `mesh` in all formats of the second checker, which must agree.

use crate::common::fixture;
use crate::common::program::*;
use anastomesh_verify::{Demands, Report, certificate, read_mesh, read_network, verify};
use std::fs;
use std::path::Path;

/// Report of the second checker on a mesh with its certificate, and the input of the mesh.
fn verified(path: &Path, text: &str, input: &Path) -> Report {
    let mut report = verify(&read_mesh(path).expect("a mesh"), &Demands::default());
    certificate::check(text, path, Some(input), None, &mut report).expect("a certificate");
    report
}

fn violated(report: &Report) -> Vec<&'static str> {
    report.violated().map(|outcome| outcome.condition.name()).collect()
}

#[test]
fn both_checkers_agree_in_every_format() {
    let (folder, input) = (folder(), fixture("tree_30.vtp"));
    let file = folder.path().join("certificate.json");
    let words = ["--certificate", file.to_str().expect("UTF-8")];
    for (name, options) in [
        ("tree.vtu", &[][..]),
        ("tree.msh", &["--layers", "2"]),
        ("tree.msh2", &[]),
        ("tree.ele", &[]),
        ("grouped.vtu", &["--outlets", "grouped"]),
        ("rounded.vtu", &["--float32", "--compress", "none"]),
        ("tets.vtu", &["--cells", "tets"]),
    ] {
        let out = folder.path().join(name);
        assert_code(&mesh(&input, &out, &[&words, options].concat()), FINE);
        let text = fs::read_to_string(&file).expect("a certificate");
        let report = verified(&out, &text, &input);
        assert!(report.is_valid(), "{name}: {report}");
        assert!(text.contains("\"options\": \"mesh --rho 3 --follow 1"), "{text}");
        // 24 conditions and three of the certificate. Without labels or names, fewer apply.
        let least = if name.starts_with("tree.ele") || name.starts_with("tets") { 15 } else { 24 };
        assert!(report.outcomes.len() >= least, "{name}: {report}");
    }
}

#[test]
fn changes_are_found() {
    let (folder, input) = (folder(), fixture("tree_30.vtp"));
    let [out, file] = ["tree.msh2", "tree.json"].map(|name| folder.path().join(name));
    assert_code(&mesh(&input, &out, &["--certificate", file.to_str().expect("UTF-8")]), FINE);
    let text = fs::read_to_string(&file).expect("a certificate");
    assert!(verified(&out, &text, &input).is_valid());
    assert_eq!(violated(&verified(&out, &text, &fixture("crotch.vtp"))), ["hashes"]);
    let other = text.replace("\"components\": 1", "\"components\": 2");
    assert_eq!(violated(&verified(&out, &other, &input)), ["seal", "claims"]);
    // Two vertices of the last tetrahedron are exchanged.
    let mesh = fs::read_to_string(&out).expect("text");
    let last = mesh.split("\n$EndElements").next().and_then(|head| head.lines().last()).expect("an element");
    let mut numbers: Vec<&str> = last.split(' ').collect();
    let count = numbers.len();
    numbers.swap(count - 1, count - 2);
    fs::write(&out, mesh.replace(last, &numbers.join(" "))).expect("writable");
    let found = violated(&verified(&out, &text, &input));
    assert!(
        ["positive_tets", "opposite_sides", "hashes", "claims"].iter().all(|name| found.contains(name)),
        "{found:?}"
    );
    assert!(!found.contains(&"seal"));
}

#[test]
fn formats_of_several_files_have_no_certificate() {
    let folder = folder();
    let made = mesh(&fixture("tree_30.vtp"), &folder.path().join("tree.pvtu"), &["--certificate", "tree.json"]);
    assert_says(&made, USAGE, &["--certificate is not supported by this format: use .vtu, .msh, .msh2 or .ele"]);
    assert_eq!(entries(folder.path()), [""; 0]);
    let missing = folder.path().join("missing").join("tree.json");
    let words = ["--certificate", missing.to_str().expect("UTF-8")];
    let made = mesh(&fixture("tree_30.vtp"), &folder.path().join("tree.vtu"), &words);
    assert_says(&made, BAD_INPUT, &["tree.json: cannot be written"]);
    assert_eq!(entries(folder.path()), [""; 0]);
}

#[test]
fn the_wall_is_near_the_vessels() {
    let (folder, input) = (folder(), fixture("tree_30.swc"));
    let out = folder.path().join("tree.vtu");
    assert_code(&mesh(&input, &out, &[]), FINE);
    let near = |tolerance: f64| {
        let network = Some((read_network(&input).expect("a network"), tolerance));
        violated(&verify(&read_mesh(&out).expect("a mesh"), &Demands { surface: None, network }))
    };
    assert_eq!(near(0.3), [""; 0]);
    assert_eq!(near(0.01), ["wall_distance"]);
}
