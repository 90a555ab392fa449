//! Limits of conditions, conditions that depend on others, and the texts of violations.

use super::common::{add, cuboid, label, lattice, torus, tube};
use anastomesh_verify::{Demands, Mesh, Report, verify};

fn report(mesh: &Mesh) -> Report {
    verify(mesh, &Demands::default())
}

/// Report of the tube after a change.
fn changed(change: impl FnOnce(&mut Mesh)) -> Report {
    let mut mesh = tube();
    change(&mut mesh);
    report(&mesh)
}

fn violated(report: &Report) -> Vec<&'static str> {
    report.violated().map(|outcome| outcome.condition.name()).collect()
}

/// Violations that are listed for a condition.
fn first<'a>(report: &'a Report, name: &str) -> &'a [String] {
    report.outcomes.iter().find(|outcome| outcome.condition.name() == name).map_or(&[], |outcome| &outcome.first)
}

/// One tetrahedron.
fn single(points: [[f64; 3]; 4]) -> Mesh {
    Mesh { points: points.to_vec(), tets: vec![[0, 1, 2, 3]], ..Mesh::default() }
}

/// Cube of this size at a place.
fn cube(size: f64, at: f64) -> Mesh {
    lattice([1, 1, 1], false, &|p| p.map(|x| at + size * f64::from(x)), &|_| true)
}

#[test]
fn the_volume_is_that_of_all_tetrahedra() {
    // Edges (2, 1, -1), (1, 3, 2) and (-1, 2, 4) from a point off the origin.
    let skew = single([[5., 6., 7.], [7., 7., 6.], [6., 9., 9.], [4., 8., 11.]]);
    assert_eq!(report(&skew).figures.volume, 5.0 / 6.0);
    let mut inverted = skew;
    inverted.tets[0].swap(2, 3);
    assert_eq!(report(&inverted).figures.volume, -5.0 / 6.0);
}

#[test]
fn indices_end_before_the_number_of_points() {
    let count = tube().points.len() as u32;
    assert_eq!(violated(&changed(|m| m.tets[5][2] = count)), ["indices_in_range"]);
    let report = changed(|m| m.triangles[5][2] = count);
    assert_eq!(violated(&report), ["labels_match_boundary"]);
    assert_eq!(report.outcomes.len(), 18);
}

#[test]
fn zeros_of_both_signs_are_one_place() {
    let mut mesh = single([[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]);
    add(&mut mesh, &single([[-0., 0., -0.], [-1., 0., 0.], [0., -1., 0.], [0., 0., -1.]]), [-0.0; 3]);
    mesh.tets[1].swap(0, 1);
    assert_eq!(first(&report(&mesh), "no_duplicate_points"), ["0 4"]);
}

#[test]
fn surfaces_that_are_no_manifold_are_compared_no_further() {
    let cells = |has: &dyn Fn([i32; 3]) -> bool| {
        let mesh = lattice([2, 2, 2], false, &|p| p.map(f64::from), has);
        report(&Mesh { expected_loops: Some(vec![0, 0]), ..mesh })
    };
    let names = |report: &Report| report.outcomes.iter().map(|outcome| outcome.condition.name()).collect::<Vec<_>>();
    // Cubes with a common edge, with a common vertex, and one cube that intersects nothing.
    let edge = cells(&|p| p[0] == p[1] && p[2] == 0);
    assert_eq!((violated(&edge), first(&edge, "boundary_edges")), (vec!["boundary_edges"], &["3 7".to_owned()][..]));
    let vertex = cells(&|p| p[0] == p[1] && p[1] == p[2]);
    assert_eq!((violated(&vertex), first(&vertex, "boundary_fans")), (vec!["boundary_fans"], &["7".to_owned()][..]));
    for found in [edge, vertex] {
        assert!(!names(&found).contains(&"loops") && !names(&found).contains(&"no_nesting"), "{found}");
    }
    // The expectation does not depend on intersections, the nesting does.
    let mut crossing = cuboid([1, 1, 1]);
    add(&mut crossing, &cuboid([1, 1, 1]), [0.3, 0.2, 0.1]);
    crossing.expected_loops = Some(vec![0, 0]);
    let found = report(&crossing);
    assert_eq!(violated(&found), ["no_self_intersection"]);
    assert!(names(&found).contains(&"loops") && !names(&found).contains(&"no_nesting"));
}

#[test]
fn a_collapsed_tetrahedron_encloses_nothing() {
    let line = single([[0., 0., 0.], [1., 1., 1.], [2., 2., 2.], [3., 3., 3.]]);
    assert_eq!(violated(&report(&line)), ["positive_tets"]);
}

#[test]
fn an_expectation_names_the_first_difference() {
    let loops = |mesh: &Mesh, expected: &[i64]| {
        let found = report(&Mesh { expected_loops: Some(expected.to_vec()), ..mesh.clone() });
        first(&found, "loops").to_vec()
    };
    assert_eq!(loops(&torus(), &[0]), ["expected 0, found 1"]);
    let mut both = cuboid([1, 1, 1]);
    add(&mut both, &torus(), [20.0, 0.0, 0.0]);
    for expected in [[0, 1], [1, 0]] {
        assert_eq!(loops(&both, &expected), [""; 0]);
    }
    assert_eq!(loops(&both, &[0, 2]), ["expected 2, found 1"]);
    assert_eq!(loops(&both, &[0, 1, 1]), ["expected 3, found 2"]);
    assert_eq!(
        first(&report(&Mesh { expected_loops: Some(vec![0]), ..both.clone() }), "components"),
        ["expected 1, found 2"]
    );
    assert_eq!(report(&both).figures.genus, 1);
    // A cavity in the second of two components.
    let mut shell = cuboid([1, 1, 1]);
    add(&mut shell, &lattice([3, 3, 3], false, &|p| p.map(f64::from), &|p| p != [1, 1, 1]), [5.0; 3]);
    assert_eq!(loops(&shell, &[0, 0]), ["component 1 has 2 boundary surfaces"]);
}

#[test]
fn a_surface_inside_another_is_named_by_its_first_face() {
    let mut nested = cube(4.0, 0.0);
    add(&mut nested, &cube(1.0, 1.0), [0.0; 3]);
    let found = report(&nested);
    assert_eq!(
        (violated(&found), first(&found, "no_nesting")),
        (vec!["no_nesting"], &["surface of face 9 11 15".to_owned()][..])
    );
    // A part within the box of another, but outside it.
    let mut corner = lattice([2, 2, 2], false, &|p| p.map(f64::from), &|p| p != [1, 1, 1]);
    add(&mut corner, &cube(0.5, 1.25), [0.0; 3]);
    assert!(report(&corner).is_valid(), "{}", report(&corner));
}

#[test]
fn intersections_name_both_faces() {
    let mut mesh = single([[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [0., 0., 4.]]);
    add(&mut mesh, &single([[1., 1., -3.], [1.1, 1., -3.], [1., 1.1, -3.], [1., 1., 1.]]), [0.0; 3]);
    let found = report(&mesh);
    assert_eq!(first(&found, "no_self_intersection"), ["0 2 1 and 5 6 7", "0 2 1 and 4 7 6", "0 2 1 and 4 5 7"]);
}

#[test]
fn a_report_lists_three_violations_of_a_condition() {
    let found = changed(|m| m.points.extend([[7.; 3], [8.; 3], [9.; 3]]));
    assert_eq!(found.to_string(), "NOT valid: no_unused_points: unused points: 3 (68, 69, 70)");
    let found = changed(|m| {
        m.points.extend([[6.; 3], [7.; 3], [8.; 3], [9.; 3]]);
        m.expected_terminals = Some(vec![0]);
    });
    let text = "NOT valid: no_unused_points: unused points: 4 (68, 69, 70, …); \
                cap_per_terminal: terminals without one cap: 1 (node 1)";
    assert_eq!(found.to_string(), text);
    let json = found.to_json();
    assert_eq!((&json["valid"], &json["points"], &json["tets"]), (&false.into(), &72.into(), &144.into()));
    assert_eq!((&json["boundary_faces"], &json["components"], &json["genus"]), (&128.into(), &1.into(), &0.into()));
    let unused = json["conditions"].as_array().and_then(|list| list.iter().find(|c| c["name"] == "no_unused_points"));
    assert_eq!(
        unused.map(ToString::to_string).as_deref(),
        Some(r#"{"first":["68","69","70"],"name":"no_unused_points","violations":4}"#)
    );
    assert_eq!(report(&tube()).to_json()["valid"], true);
}

#[test]
fn labels_without_names_are_only_compared_with_the_boundary() {
    let mut mesh = cuboid([1, 1, 1]);
    label(&mut mesh, &|_| 3);
    let names: Vec<&str> = report(&mesh).outcomes.iter().map(|outcome| outcome.condition.name()).collect();
    assert!(names.ends_with(&["no_nesting", "labels_match_boundary"]), "{names:?}");
}
