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
