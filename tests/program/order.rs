//! Command line tests of `--order 2`: ten-node tetrahedra in files, their report and their check.

use crate::common::fixture;
use crate::common::program::*;
use crate::common::surfaces::{save, sphere};
use anastomesh::io::{MeshFile, read_mesh};
use anastomesh::mesh::second_order::SecondOrder;
use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};

/// Straight tube of radius 1 and length 20 along z.
const TUBE: &str = "1 2 0 0 0 1 -1\n2 2 0 0 20 1 1\n";

/// Volume of a second-order mesh, by a quadrature that is exact for cubic polynomials.
fn volume(file: &MeshFile) -> f64 {
    let second = file.second_order.as_ref().expect("midpoints");
    let mesh = &file.volume.mesh;
    mesh.tets.iter().map(|&tet| of_element(&second.nodes(&mesh.points, tet))).sum()
}

fn of_element(nodes: &[anastomesh::mesh::Point3; 10]) -> f64 {
    let [edge, centre] = [1.0 / 6.0, 0.25];
    let mut sum = -0.8 * jacobian(nodes, [centre; 4]);
    for i in 0..4 {
        let mut at = [edge; 4];
        at[i] = 0.5;
        sum += 0.45 * jacobian(nodes, at);
    }
    sum / 6.0
}

fn jacobian(nodes: &[anastomesh::mesh::Point3; 10], at: [f64; 4]) -> f64 {
    let mut by = [0, 1, 2, 3].map(|i| nodes[i].coords * (4.0 * at[i] - 1.0));
    for ([i, j], middle) in [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]].into_iter().zip(&nodes[4..]) {
        by[i] += middle.coords * (4.0 * at[j]);
        by[j] += middle.coords * (4.0 * at[i]);
    }
    (by[1] - by[0]).cross(&(by[2] - by[0])).dot(&(by[3] - by[0]))
}

/// Network of one straight vessel.
fn tube(folder: &Path) -> PathBuf {
    let network = folder.join("tube.swc");
    fs::write(&network, TUBE).expect("written");
    network
}

fn second_order(path: &Path) -> SecondOrder {
    read_mesh(path).expect("a mesh").second_order.expect("midpoints")
}

#[test]
fn a_tube_has_the_volume_of_its_cylinder_in_every_format() {
    let folder = folder();
    let network = tube(folder.path());
    let linear = folder.path().join("linear.vtu");
    assert_code(&mesh(&network, &linear, &["--rho", "4"]), FINE);
    let linear = read_mesh(&linear).expect("a mesh");
    assert_eq!(linear.second_order, None);
    for name in ["tube.vtu", "tube.msh", "tube.msh2"] {
        let out = folder.path().join(name);
        let made = mesh(&network, &out, &["--rho", "4", "--order", "2"]);
        assert_code(&made, FINE);
        let said = stderr(&made);
        assert!(said.contains("midpoints on curved edges, none pulled back; scaled Jacobian min 0."), "{said}");
        let file = read_mesh(&out).expect("a mesh");
        assert_eq!(file.volume.mesh.tets, linear.volume.mesh.tets, "{name}");
        let share = volume(&file) / (PI * 20.0) - 1.0;
        assert!(share.abs() < 2e-3, "{name}: {share}");
        let checked = run("check", &[&out], &["-v"]);
        assert_says_out(&checked, "ok   every element has a positive Jacobian determinant");
        assert_says_out(&checked, "\nvalid\n");
    }
    // Caps stay planar.
    let [vtu, msh] = ["tube.vtu", "tube.msh"].map(|name| second_order(&folder.path().join(name)));
    assert_eq!(vtu, msh);
    let on_end = |z: f64| vtu.middles().iter().filter(|p| (p.z - z).abs() < 1e-12).count();
    assert!(on_end(0.0) > 30 && on_end(20.0) > 30);
}

fn assert_says_out(output: &std::process::Output, words: &str) {
    assert_code(output, FINE);
    assert!(stdout(output).contains(words), "{}", stdout(output));
}

#[test]
fn a_tree_has_valid_elements_and_the_json_counts_them() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    let made = mesh(&fixture("tree_30.vtp"), &out, &["--order", "2", "--json"]);
    assert_code(&made, FINE);
    let report = &json(&made)["second_order"];
    let number = |name: &str| report[name].as_f64().expect("a number");
    assert!(number("curved") > 1000.0 && number("pulled") < 0.02 * number("curved"), "{report}");
    assert!(number("least_scaled") >= 0.1);
    assert_eq!(second_order(&out).middles().len() as f64, number("midpoints"));
    assert_code(&run("check", &[&out], &[]), FINE);
}

#[test]
fn a_ball_from_a_surface_is_round() {
    let folder = folder();
    let surface = save(&folder, "ball.off", &sphere(16));
    let out = folder.path().join("ball.msh");
    let made = fill(&surface, &out, &["--order", "2"]);
    assert_code(&made, FINE);
    assert!(stderr(&made).contains("midpoints on curved edges"), "{}", stderr(&made));
    let file = read_mesh(&out).expect("a mesh");
    let share = volume(&file) / (4.0 / 3.0 * PI) - 1.0;
    assert!(share.abs() < 2e-3, "{share}");
    assert_says_out(&run("check", &[&out], &["-v"]), "ok   every edge has one midpoint");
}

#[test]
fn regions_share_the_midpoints_of_their_interfaces() {
    let folder = folder();
    let out = folder.path().join("organ.vtu");
    let made = mesh(&fixture("tree_30.vtp"), &out, &["--order", "2", "--wall", "0.2r"]);
    assert_code(&made, FINE);
    let checked = run("check", &[&out], &["-v"]);
    assert_says_out(&checked, "ok   every element has a positive Jacobian determinant");
    assert_says_out(&checked, "ok   every edge has one midpoint");
}

#[test]
fn conversion_keeps_midpoints_where_the_format_has_them() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    assert_code(&mesh(&tube(folder.path()), &at("tube.vtu"), &["--order", "2"]), FINE);
    let convert = |to: &str| run("convert", &[&at("tube.vtu")], &["-o", at(to).to_str().expect("a path")]);
    assert_code(&convert("other.msh"), FINE);
    assert_eq!(second_order(&at("other.msh")), second_order(&at("tube.vtu")));
    assert_says(&convert("linear.mesh"), FINE, &["midpoints of second-order elements left out"]);
    assert_eq!(read_mesh(&at("linear.mesh")).expect("a mesh").second_order, None);
}

#[test]
fn folded_elements_and_mixed_orders_are_faults() {
    let folder = folder();
    let network = tube(folder.path());
    let out = folder.path().join("tube.msh2");
    assert_code(&mesh(&network, &out, &["--order", "2"]), FINE);
    let text = fs::read_to_string(&out).expect("a file");
    let file = read_mesh(&out).expect("a mesh");
    // The midpoint of the first edge, on a rim, moves across its elements.
    let node = file.volume.mesh.points.len() + 1;
    let line = text.lines().find(|line| line.starts_with(&format!("{node} "))).expect("its midpoint");
    fs::write(&out, text.replacen(&format!("\n{line}\n"), &format!("\n{node} 0.0 0.0 5.0\n"), 1)).expect("written");
    let checked = run("check", &[&out], &[]);
    assert_code(&checked, GATE_NOT_MET);
    assert!(stdout(&checked).contains("Jacobian determinant that is not positive everywhere"), "{}", stdout(&checked));
    let triangle = text.lines().find(|line| line.split(' ').nth(1) == Some("9")).expect("a triangle");
    let words: Vec<&str> = triangle.split(' ').collect();
    let linear = [&words[..1], &["2"], &words[2..8]].concat().join(" ");
    fs::write(&out, text.replacen(triangle, &linear, 1)).expect("written");
    assert_message(&run("check", &[&out], &[]), &out, &["linear and second-order cells"]);
}

#[test]
fn other_formats_and_options_are_refused() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let tree = fixture("tree_30.vtp");
    for (name, options, words) in [
        ("tree.mesh", &["--order", "2"][..], ".vtu, .msh, .msh2, .npyd or .svmesh"),
        ("tree.pvtu", &["--order", "2"], ".vtu, .msh, .msh2, .npyd or .svmesh"),
        ("tree.foam", &["--order", "2"], ".vtu, .msh, .msh2, .npyd or .svmesh"),
        ("tree.vtu", &["--order", "3"], "1..=2"),
        ("tree.vtu", &["--order", "2", "--layers", "2", "--prisms"], "--order 2 does not combine with --prisms"),
        ("tree.msh", &["--order", "2", "--parts", "2"], "--order 2 does not combine with --parts"),
        ("tree.vtu", &["--order", "2", "--cells", "tets"], "--order 2 does not combine with --cells tets"),
        (
            "tree.svmesh",
            &["--order", "2", "--wall", "0.2r"],
            "--order 2 does not combine with regions around the lumen",
        ),
    ] {
        assert_says(&mesh(&tree, &at(name), options), USAGE, &[words]);
    }
    let surface = save(&folder, "ball.off", &sphere(6));
    assert_says(&fill(&surface, &at("ball.ele"), &["--order", "2"]), USAGE, &[".vtu, .msh, .msh2, .npyd or .svmesh"]);
}
