//! Meshes with regions: a channel within a wall.

use super::common::lattice;
use anastomesh_verify::{Cap, Demands, Mesh, verify};
use std::collections::BTreeMap;

const SIDES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Cells of a lattice along z, with the channel in the middle. Each region is a file's region, and labels are complete.
fn channel() -> Mesh {
    let mut mesh = lattice([3, 3, 4], false, &|p| p.map(f64::from), &|_| true);
    let centre = |t: &[u32], k: usize| t.iter().map(|&v| mesh.points[v as usize][k]).sum::<f64>() / t.len() as f64;
    let is_inside = |x: f64| (1.0..2.0).contains(&x);
    let region = |t: &[u32; 4]| if is_inside(centre(t, 0)) && is_inside(centre(t, 1)) { 1 } else { 2 };
    let regions: Vec<i64> = mesh.tets.iter().map(region).collect();
    let mut faces: BTreeMap<[u32; 3], Vec<(i64, [u32; 3])>> = BTreeMap::new();
    for (t, &region) in mesh.tets.iter().zip(&regions) {
        for face in SIDES.map(|side| side.map(|i| t[i])) {
            let mut key = face;
            key.sort_unstable();
            faces.entry(key).or_default().push((region, face));
        }
    }
    for sides in faces.into_values() {
        let label = match sides[..] {
            [(1, face)] => 1 + i64::from(centre(&face, 2) > 2.0) + 1,
            [(_, _)] => 5,
            [(a, _), (b, _)] if a != b => 4,
            _ => continue,
        };
        mesh.triangles.push(sides.iter().min().expect("a side").1);
        mesh.labels.push(label);
    }
    mesh.tet_regions = regions;
    mesh.regions = vec![(1, "lumen".into()), (2, "wall".into())];
    mesh.patches = [(2, "in"), (3, "out"), (4, "interface_lumen_wall"), (5, "wall_outer")]
        .map(|(id, name)| (id, name.into()))
        .to_vec();
    mesh
}

/// Violated conditions after a change.
fn broken(change: impl FnOnce(&mut Mesh)) -> Vec<&'static str> {
    let mut mesh = channel();
    change(&mut mesh);
    verify(&mesh, &Demands::default()).violated().map(|outcome| outcome.condition.name()).collect()
}

fn first(mesh: &Mesh, label: i64) -> usize {
    mesh.labels.iter().position(|&own| own == label).expect("a face")
}

#[test]
fn a_sound_mesh_is_valid() {
    let report = verify(&channel(), &Demands::default());
    assert!(report.is_valid(), "{report}");
    assert!(report.outcomes.iter().any(|outcome| outcome.condition.name() == "interfaces"));
}

#[test]
fn the_expectation_is_that_of_the_lumen() {
    // The lumen is a ball; the wall is a ring.
    assert_eq!(broken(|m| m.expected_loops = Some(vec![0])), [""; 0]);
    assert_eq!(broken(|m| m.expected_loops = Some(vec![1])), ["loops"]);
    assert_eq!(broken(|m| m.expected_loops = Some(vec![0, 0])), ["components", "loops"]);
    let names = broken(|m| {
        m.expected_loops = Some(vec![0]);
        m.regions.swap(0, 1);
        (m.regions[0].1, m.regions[1].1) = ("lumen".into(), "wall".into());
    });
    assert_eq!(names, ["loops"]);
}

/// Without the lumen, its caps bound the tissue, which is on their other side.
#[test]
fn caps_are_those_of_the_lumen() {
    let inwards = |m: &mut Mesh| {
        let (center, normal, radius) = ([1.5, 1.5, 0.0], [0.0, 0.0, 1.0], (1.0 / std::f64::consts::PI).sqrt());
        m.caps.push(Cap { patch: 2, node: 0, center, normal, radius });
    };
    assert_eq!(broken(inwards), ["cap_normal"]);
    let without_lumen = |m: &mut Mesh| {
        inwards(m);
        m.regions[0].1 = "tissue".into();
    };
    assert_eq!(broken(without_lumen), [""; 0]);
}

/// The channel as the mesh of a network, with both of its ends as terminals.
fn network(m: &mut Mesh) {
    // A square of 1 has the area of this disc.
    let radius = (1.0 / std::f64::consts::PI).sqrt();
    let cap = |patch, node, z, up| Cap { patch, node, center: [1.5, 1.5, z], normal: [0.0, 0.0, up], radius };
    m.caps = vec![cap(2, 0, 0.0, -1.0), cap(3, 1, 4.0, 1.0)];
    m.expected_loops = Some(vec![0]);
    m.expected_terminals = Some(vec![0, 1]);
}

#[test]
fn interfaces_without_a_cap_are_the_wall_of_a_network() {
    let changed = |change: &dyn Fn(&mut Mesh)| {
        broken(|m| {
            network(m);
            change(m);
        })
    };
    assert_eq!(changed(&|_| ()), [""; 0]);
    assert_eq!(changed(&|m| m.expected_terminals = Some(vec![0])), ["cap_per_terminal"]);
    assert_eq!(changed(&|m| m.caps[0].normal[2] = 1.0), ["cap_normal"]);
    // Only names of interfaces are the wall's.
    let plaque = |name: &'static str| {
        move |m: &mut Mesh| {
            let i = first(m, 4);
            m.labels[i] = 9;
            m.patches.push((9, name.into()));
        }
    };
    assert_eq!(changed(&plaque("plaque")), ["wall_or_cap"]);
    assert_eq!(changed(&plaque("interface_plaque")), [""; 0]);
    // A terminal may end inside another region: its cap is an interface, and not wall.
    let inner = |m: &mut Mesh| m.patches[1].1 = "interface_out".into();
    assert_eq!(changed(&inner), [""; 0]);
}

#[test]
fn names_of_interfaces_are_those_of_their_regions() {
    let named = |name: &'static str| broken(|m| m.patches[2].1 = name.into());
    assert_eq!(named("interface_wall_lumen"), [""; 0]);
    // Other regions than these are names without a meaning.
    assert_eq!(named("interface_lumen_tissue"), [""; 0]);
    assert_eq!(named("interface_lumenwall"), [""; 0]);
    assert_eq!(named("interface_lumen_lumen"), ["interfaces"]);
    assert_eq!(broken(|m| m.regions[0].1 = "lumen_wall".into()), [""; 0]);
    // Names of regions may contain the separator.
    let long = |m: &mut Mesh| {
        m.regions[0].1 = "a_b".into();
        m.regions[1].1 = "b_c".into();
        m.patches[2].1 = "interface_a_b_b_c".into();
    };
    assert_eq!(broken(long), [""; 0]);
    let outer = |m: &mut Mesh| {
        let i = first(m, 5);
        m.patches.push((9, "interface_wall_lumen".into()));
        m.labels[i] = 9;
    };
    assert_eq!(broken(outer), ["interfaces"]);
}

#[test]
fn violations_of_regions_are_named() {
    let text = |change: &mut dyn FnMut(&mut Mesh)| {
        let mut mesh = channel();
        change(&mut mesh);
        verify(&mesh, &Demands::default()).to_string()
    };
    let found = text(&mut |m| m.regions.push((3, "tissue".into())));
    assert_eq!(
        found,
        "NOT valid: regions_named: tetrahedra without a named region, or empty regions: 1 (region tissue is empty)"
    );
    let found = text(&mut |m| m.regions.truncate(1));
    let outside = channel().tet_regions.iter().filter(|&&region| region == 2).count();
    assert!(found.contains(&format!("regions: {outside} (tetrahedron 0, tetrahedron 1, tetrahedron 2, …)")), "{found}");
    let mut face = [0; 3];
    let found = text(&mut |m| {
        let i = first(m, 4);
        m.labels.remove(i);
        face = m.triangles.remove(i);
    });
    face.sort_unstable();
    let [a, b, c] = face;
    assert!(
        found.ends_with(&format!(
            "interfaces: labels that differ from the faces between regions: 1 ({a} {b} {c} without label)"
        )),
        "{found}"
    );
    // A violation of the whole mesh and of a region is counted for both.
    let found = text(&mut |m| {
        m.tets[0].swap(0, 1);
        m.tets.last_mut().expect("one").swap(0, 1);
    });
    let last = channel().tets.len() - 1;
    assert!(
        found.contains(&format!("positive_tets: inverted or flat tetrahedra: 4 (0, {last}, region wall: 0, …)")),
        "{found}"
    );
}

#[test]
fn a_labelled_face_within_a_region_is_no_interface() {
    let inside = |m: &mut Mesh| {
        // The diagonal face of the first cell.
        let [a, _, c, d] = m.tets[0];
        m.triangles.push([a, c, d]);
        m.labels.push(4);
    };
    assert_eq!(broken(inside), ["interfaces"]);
}

#[test]
fn interfaces_are_compared() {
    let interface = first(&channel(), 4);
    assert_eq!(broken(|m| m.triangles[interface].swap(0, 1)), ["interfaces"]);
    let names = broken(|m| {
        m.triangles.remove(interface);
        m.labels.remove(interface);
    });
    assert_eq!(names, ["interfaces"]);
    let outer = first(&channel(), 5);
    assert_eq!(broken(|m| m.labels[outer] = 4), ["interfaces"]);
    let names = broken(|m| {
        m.triangles.push(m.triangles[interface]);
        m.labels.push(4);
    });
    assert_eq!(names, ["interfaces"]);
    // Other programs do not label interfaces.
    let without = |m: &mut Mesh| {
        let keep: Vec<bool> = m.labels.iter().map(|&label| label != 4).collect();
        let (mut a, mut b) = (keep.iter(), keep.iter());
        m.triangles.retain(|_| a.next() == Some(&true));
        m.labels.retain(|_| b.next() == Some(&true));
    };
    assert_eq!(broken(without), [""; 0]);
}

/// Regions of a complex may touch themselves, those of a network may not.
#[test]
fn a_region_that_touches_itself_at_an_edge_is_sound_without_an_expectation() {
    let mut mesh = lattice([2, 2, 1], false, &|p| p.map(f64::from), &|[i, j, _]| i == j);
    mesh.tet_regions = vec![1; mesh.tets.len()];
    mesh.regions = vec![(1, "lumen".into())];
    let violated = |mesh: &Mesh| {
        verify(mesh, &Demands::default()).violated().map(|outcome| outcome.condition.name()).collect::<Vec<_>>()
    };
    assert!(violated(&mesh).is_empty(), "{:?}", violated(&mesh));
    mesh.expected_loops = Some(vec![0, 0]);
    assert!(violated(&mesh).contains(&"boundary_edges"), "{:?}", violated(&mesh));
}

#[test]
fn regions_are_named_and_sound() {
    assert_eq!(broken(|m| m.regions.push((3, "tissue".into()))), ["regions_named"]);
    assert!(broken(|m| m.tet_regions[0] = 7).contains(&"regions_named"));
    // A tetrahedron of the lumen at an edge of the wall's outside touches the rest nowhere.
    let names = broken(|m| {
        m.tet_regions[0] = 1;
        m.expected_loops = Some(vec![0]);
    });
    assert!(names.contains(&"components") && names.contains(&"interfaces"), "{names:?}");
    assert!(broken(|m| m.tets[3].swap(0, 1)).contains(&"positive_tets"));
}
