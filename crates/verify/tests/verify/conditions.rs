//! Every condition is found, and named, on a mesh that is broken in one way.

use super::common::{add, cuboid, label, lattice, torus, tube};
use anastomesh_verify::{Demands, Mesh, Report, read_network, verify};

fn report(mesh: &Mesh) -> Report {
    verify(mesh, &Demands::default())
}

fn violated(mesh: &Mesh) -> Vec<&'static str> {
    report(mesh).violated().map(|outcome| outcome.condition.name()).collect()
}

/// Violated conditions of the tube after a change.
fn broken(change: impl FnOnce(&mut Mesh)) -> Vec<&'static str> {
    let mut mesh = tube();
    change(&mut mesh);
    violated(&mesh)
}

/// Position of a boundary face of the tube's wall.
fn wall(mesh: &Mesh) -> usize {
    mesh.labels.iter().position(|&label| label == 1).expect("a wall")
}

#[test]
fn sound_meshes_are_valid() {
    for (name, mesh, genus) in [("cuboid", cuboid([3, 2, 2]), 0), ("torus", torus(), 1), ("tube", tube(), 0)] {
        let report = report(&mesh);
        assert!(report.is_valid(), "{name}: {report}");
        assert_eq!((report.figures.genus, report.figures.components), (genus, 1), "{name}");
    }
    assert!((report(&cuboid([3, 2, 2])).figures.volume - 12.0).abs() < 1e-12);
    assert_eq!(report(&tube()).outcomes.len(), 25);
}

#[test]
fn a_cavity_is_sound_but_unexpected_in_a_network() {
    let mut shell = lattice([3, 3, 3], false, &|p| p.map(f64::from), &|p| p != [1, 1, 1]);
    assert!(report(&shell).is_valid());
    shell.expected_loops = Some(vec![0]);
    assert_eq!(violated(&shell), ["loops"]);
    // A cube that fills the cavity without its vertices, and a small one inside that.
    let mut filled = shell.clone();
    filled.expected_loops = None;
    add(&mut filled, &cuboid([1, 1, 1]), [1.0; 3]);
    assert!(violated(&filled).contains(&"no_self_intersection"));
    let mut small = lattice([1, 1, 1], false, &|p| p.map(|x| 1.25 + 0.5 * f64::from(x)), &|_| true);
    shell.expected_loops = None;
    add(&mut shell, &small, [0.0; 3]);
    assert!(report(&shell).is_valid());
    add(&mut small, &lattice([1, 1, 1], false, &|p| p.map(|x| 1.4 + 0.1 * f64::from(x)), &|_| true), [0.0; 3]);
    assert_eq!(violated(&small), ["no_nesting"]);
}

#[test]
fn broken_arrays_are_named() {
    assert_eq!(broken(|m| m.tets.clear()), ["not_empty"]);
    assert_eq!(broken(|m| m.points[3][1] = f64::NAN), ["finite_points"]);
    assert_eq!(broken(|m| m.points[3][1] = f64::INFINITY), ["finite_points"]);
    assert_eq!(broken(|m| m.tets[5][2] = 1000), ["indices_in_range"]);
    assert_eq!(broken(|m| m.points.push([9.0; 3])), ["no_unused_points"]);
}

#[test]
fn broken_tetrahedra_are_named() {
    let names = broken(|m| m.tets[7].swap(1, 2));
    assert!(names.contains(&"positive_tets") && names.contains(&"opposite_sides"), "{names:?}");
    let names = broken(|m| m.tets[7][0] = m.tets[7][1]);
    assert!(names.contains(&"no_repeated_vertex") && names.contains(&"positive_tets"), "{names:?}");
    let names = broken(|m| m.tets.push(m.tets[7]));
    assert!(names.contains(&"no_duplicate_tets") && names.contains(&"faces_shared_by_two"), "{names:?}");
    // The axis is moved out through the wall: tetrahedra invert, faces stay.
    let names = broken(|m| m.points[17] = [1.5, 0.0, 1.0]);
    assert!(names.contains(&"positive_tets") && !names.contains(&"opposite_sides"), "{names:?}");
    // A flat tetrahedron is not positive.
    let mut flat = cuboid([1, 1, 1]);
    flat.points[7] = [2.0, 1.5, 0.0];
    assert!(violated(&flat).contains(&"positive_tets"));
}

#[test]
fn gaps_and_touching_parts_are_named() {
    let names = broken(|m| {
        m.tets.remove(20);
    });
    assert!(names.contains(&"labels_match_boundary"), "{names:?}");
    // Two cubes with a common edge, and with a common vertex.
    let edge = lattice([2, 2, 1], false, &|p| p.map(f64::from), &|p| p[0] == p[1]);
    assert_eq!(violated(&edge), ["boundary_edges"]);
    let vertex = lattice([2, 2, 2], false, &|p| p.map(f64::from), &|p| p[0] == p[1] && p[1] == p[2]);
    assert_eq!(violated(&vertex), ["boundary_fans"]);
    // Two parts that touch with vertices of their own: at a face, an edge, a vertex, and within a face.
    for shift in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]] {
        let mut touching = cuboid([1, 1, 1]);
        add(&mut touching, &cuboid([1, 1, 1]), shift);
        assert_eq!(violated(&touching), ["no_duplicate_points", "no_self_intersection"], "{shift:?}");
    }
    let mut touching = cuboid([1, 1, 1]);
    add(&mut touching, &cuboid([1, 1, 1]), [1.0, 0.3, 0.2]);
    assert_eq!(violated(&touching), ["no_self_intersection"]);
    let mut apart = cuboid([1, 1, 1]);
    add(&mut apart, &cuboid([1, 1, 1]), [1.0 + f64::EPSILON, 0.3, 0.2]);
    assert!(report(&apart).is_valid());
    // A chain of cells that winds through itself: every tetrahedron is sound.
    let mut crossing = cuboid([3, 1, 1]);
    add(&mut crossing, &cuboid([1, 3, 1]), [1.2, -1.1, 0.1]);
    assert_eq!(violated(&crossing), ["no_self_intersection"]);
}

#[test]
fn two_sheets_around_an_edge_are_named() {
    // Tetrahedra that wind twice around the axis of a ring of cells. Faces agree, and the boundary overlaps itself.
    let position = |[i, j, k]: [i32; 3]| {
        let (angle, radius) = (f64::from(i) * std::f64::consts::TAU / 8.0, 3.0 - f64::from(j));
        [radius * angle.cos(), radius * angle.sin(), f64::from(k)]
    };
    let twice = lattice([16, 1, 1], true, &position, &|_| true);
    let names = violated(&twice);
    assert!(names.contains(&"no_self_intersection"), "{names:?}");
    assert!(!names.contains(&"positive_tets") && !names.contains(&"opposite_sides"));
}

#[test]
fn expectations_are_compared() {
    assert_eq!(broken(|m| m.expected_loops = Some(vec![1])), ["loops"]);
    assert_eq!(broken(|m| m.expected_loops = Some(vec![0, 0])), ["components", "loops"]);
    let mut ring = torus();
    ring.expected_loops = Some(vec![1]);
    assert!(report(&ring).is_valid());
    ring.expected_loops = Some(vec![0]);
    assert_eq!(violated(&ring), ["loops"]);
    assert_eq!(broken(|m| m.expected_terminals = Some(vec![0, 2])), ["cap_per_terminal"]);
    assert_eq!(broken(|m| m.expected_terminals = Some(vec![0, 1, 1])), ["cap_per_terminal"]);
}

#[test]
fn labels_are_compared_with_the_boundary() {
    let wrong = ["labels_match_boundary"];
    assert_eq!(
        broken(|m| {
            let i = wall(m);
            m.triangles.remove(i);
            m.labels.remove(i);
        }),
        wrong
    );
    assert_eq!(
        broken(|m| {
            let i = wall(m);
            m.triangles[i].swap(0, 1);
        }),
        wrong
    );
    assert_eq!(
        broken(|m| {
            let i = wall(m);
            m.triangles.push(m.triangles[i]);
            m.labels.push(1);
        }),
        wrong
    );
    assert_eq!(
        broken(|m| {
            let i = wall(m);
            m.triangles[i][0] = 5000;
        }),
        wrong
    );
    // Only TetGen's faces have no direction.
    let reversed = broken(|m| {
        m.is_undirected = true;
        let i = wall(m);
        m.triangles[i].swap(0, 1);
    });
    assert!(reversed.is_empty());
    let inside = |m: &mut Mesh| {
        m.triangles.push([0, 1, 18]);
        m.labels.push(1);
    };
    assert_eq!(broken(inside), wrong);
    // Without an expectation, labelled interior faces are allowed.
    assert!(
        broken(|m| {
            inside(m);
            m.expected_loops = None;
        })
        .is_empty()
    );
}

#[test]
fn patches_and_caps_are_compared() {
    assert_eq!(broken(|m| m.patches[2].1 = "inlet".into()), ["own_patch"]);
    assert_eq!(broken(|m| m.caps[1].patch = 2)[0], "own_patch");
    assert_eq!(
        broken(|m| {
            let i = wall(m);
            m.labels[i] = 9;
        }),
        ["wall_or_cap"]
    );
    assert_eq!(
        broken(|m| {
            let i = wall(m);
            m.labels[i] = 9;
            m.patches.push((9, "plaque".into()));
        }),
        ["wall_or_cap"]
    );
    // The wall as a cap: connected, but with two rims.
    let names = broken(|m| m.labels.iter_mut().for_each(|label| *label = [0, 3, 2, 1][*label as usize]));
    assert!(names.contains(&"cap_disc"), "{names:?}");
    let cap = |m: &Mesh| m.labels.iter().position(|&label| label == 3).expect("a cap");
    // A face of the wall beside the cap, labelled as the cap: bent.
    let names = broken(|m| {
        let high = |face: &[u32; 3]| face.iter().filter(|&&v| m.points[v as usize][2] == 3.0).count() == 2;
        let i = (0..m.triangles.len()).find(|&i| m.labels[i] == 1 && high(&m.triangles[i])).expect("a face at the rim");
        m.labels[i] = 3;
    });
    assert!(names.contains(&"cap_flat") && names.contains(&"cap_normal"), "{names:?}");
    let names = broken(|m| {
        let i = wall(m);
        m.labels[i] = 3;
    });
    assert!(names.contains(&"cap_disc"), "{names:?}");
    assert_eq!(
        broken(|m| {
            let i = cap(m);
            m.labels[i] = 1;
        }),
        ["cap_area"]
    );
    assert_eq!(broken(|m| m.caps[1].center[0] = 0.11), ["cap_centred"]);
    assert_eq!(broken(|m| m.caps[1].radius = 1.1), ["cap_area"]);
    assert_eq!(broken(|m| m.caps[1].radius = -1.0), ["cap_area"]);
    assert_eq!(broken(|m| m.caps[1].center[2] = f64::NAN)[..2], ["cap_flat", "cap_centred"]);
    assert_eq!(broken(|m| m.patches.clear())[0], "own_patch");
    assert_eq!(broken(|m| m.caps[1].normal = [0.0, 0.0, -1.0]), ["cap_normal"]);
    // The end of the axis is moved by more than a billionth of the radius, then by less.
    let moved = |by: f64| move |m: &mut Mesh| m.points[3 * 17][2] += by;
    assert_eq!(broken(moved(1e-8)), ["cap_flat"]);
    assert!(broken(moved(1e-10)).is_empty());
    // Caps without data are found by name.
    let named = |by: f64| {
        move |m: &mut Mesh| {
            m.caps.clear();
            m.expected_terminals = None;
            m.points[3 * 17][2] += by;
        }
    };
    assert_eq!(broken(named(1e-8)), ["cap_flat"]);
    assert!(broken(named(0.0)).is_empty());
}

/// Units of length do not matter, far beyond those that the mesher accepts.
#[test]
fn tiny_and_huge_meshes_are_valid() {
    for scale in [1e-290, 1e-160, 1e-60, 1e60, 1e160, 1e290] {
        let mut mesh = tube();
        mesh.points.iter_mut().for_each(|p| *p = p.map(|x| x * scale));
        for cap in &mut mesh.caps {
            cap.center = cap.center.map(|x| x * scale);
            cap.radius *= scale;
        }
        assert_eq!(violated(&mesh), [""; 0], "{scale}");
        mesh.tets[3].swap(0, 1);
        assert_eq!(violated(&mesh)[0], "positive_tets", "{scale}");
    }
}

#[test]
fn coordinates_of_32_bits_may_be_rounded() {
    let mut mesh = tube();
    let (sin, cos) = 0.3_f64.sin_cos();
    let turn = |[x, y, z]: [f64; 3]| [x, cos * y - sin * z, sin * y + cos * z];
    mesh.points.iter_mut().for_each(|p| *p = turn(*p));
    for cap in &mut mesh.caps {
        (cap.center, cap.normal) = (turn(cap.center), turn(cap.normal));
    }
    assert!(report(&mesh).is_valid());
    mesh.points.iter_mut().for_each(|p| *p = p.map(|x| f64::from(x as f32)));
    assert!(report(&mesh).is_valid());
    mesh.points[1][0] += 1e-12;
    assert_eq!(violated(&mesh), ["cap_flat"]);
}

#[test]
fn surfaces_and_networks_are_compared() {
    let mut mesh = cuboid([2, 1, 1]);
    label(&mut mesh, &|_| 1);
    let surface: Vec<[[f64; 3]; 3]> = mesh.triangles.iter().map(|f| f.map(|v| mesh.points[v as usize])).collect();
    let with = |surface: Vec<[[f64; 3]; 3]>| verify(&mesh, &Demands { surface: Some(surface), network: None });
    assert!(with(surface.clone()).is_valid());
    let mut other = surface;
    other[4][1][0] += f64::EPSILON;
    let report = with(other);
    assert_eq!(report.to_string(), "NOT valid: surface_kept: triangles of the surface missing in the mesh: 1 (4)");
}

/// Vertices within the caps of a mesh without labels are not on the wall.
#[test]
fn caps_without_labels_are_not_compared_with_the_vessels() {
    let mut mesh = tube();
    (mesh.triangles, mesh.labels) = Default::default();
    (mesh.expected_loops, mesh.expected_terminals) = Default::default();
    mesh.patches.clear();
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("net.swc");
    std::fs::write(&file, "1 1 0 0 0 1 -1\n2 1 0 0 3 1 1\n").expect("a file");
    let far = |mesh: &Mesh| {
        let vessels = read_network(&file).expect("a network");
        let report = verify(mesh, &Demands { surface: None, network: Some((vessels, 1e-9)) });
        report.violated().find(|outcome| outcome.condition.name() == "wall_distance").map(|outcome| outcome.count)
    };
    assert_eq!(far(&mesh), None);
    mesh.caps.pop();
    assert_eq!(far(&mesh), Some(1));
}
