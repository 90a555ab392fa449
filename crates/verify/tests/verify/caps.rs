//! Limits of the conditions on patches and caps.

use super::common::tube;
use anastomesh_verify::{Demands, Mesh, verify};

/// Violated conditions of the tube after a change.
fn broken(change: impl FnOnce(&mut Mesh)) -> Vec<&'static str> {
    let mut mesh = tube();
    change(&mut mesh);
    verify(&mesh, &Demands::default()).violated().map(|outcome| outcome.condition.name()).collect()
}

/// Vertex in the middle of the cap at z = 3.
const MIDDLE: usize = 3 * 17;

/// Changes all lengths by a factor.
fn scale(mesh: &mut Mesh, by: f64) {
    mesh.points.iter_mut().for_each(|p| *p = p.map(|x| x * by));
    for cap in &mut mesh.caps {
        cap.center = cap.center.map(|x| x * by);
        cap.radius *= by;
    }
}

#[test]
fn flatness_has_a_limit_in_radii() {
    // Half the extent along the normal is compared with a billionth of the radius.
    for by in [0.01, 1.0, 30.0] {
        let moved = |height: f64| {
            move |m: &mut Mesh| {
                scale(m, by);
                m.points[MIDDLE][2] += height * by;
            }
        };
        assert_eq!(broken(moved(1.95e-9)), [""; 0], "{by}");
        assert_eq!(broken(moved(2.05e-9)), ["cap_flat"], "{by}");
        // Without the data of a cap, the radius is that of a disc of the same area: 0.987.
        let named = |height: f64| {
            move |m: &mut Mesh| {
                moved(height)(m);
                m.caps.clear();
                m.expected_terminals = None;
            }
        };
        assert_eq!(broken(named(1.95e-9)), [""; 0], "{by}");
        assert_eq!(broken(named(2.0e-9)), ["cap_flat"], "{by}");
    }
}

#[test]
fn rounding_to_32_bits_explains_heights_in_any_unit() {
    let (sin, cos) = 0.3_f64.sin_cos();
    let turn = |[x, y, z]: [f64; 3]| [x, cos * y - sin * z, sin * y + cos * z];
    for exponent in [-10, 0, 10] {
        let by = 2.0_f64.powi(exponent);
        // The rim's vertex is moved along the axis, in radii, before all coordinates are rounded.
        let rounded = |height: f64| {
            move |m: &mut Mesh| {
                m.points[MIDDLE][2] += height;
                m.points.iter_mut().for_each(|p| *p = turn(*p));
                m.caps.iter_mut().for_each(|cap| (cap.center, cap.normal) = (turn(cap.center), turn(cap.normal)));
                scale(m, by);
                m.points.iter_mut().for_each(|p| *p = p.map(|x| f64::from(x as f32)));
            }
        };
        assert_eq!(broken(rounded(0.0)), [""; 0], "{by}");
        assert_eq!(broken(rounded(1e-6)), ["cap_flat"], "{by}");
    }
}

#[test]
fn centres_and_areas_have_limits() {
    // A described cap is compared in its own radii, from its own centre, along its own normal.
    for (from, to) in [(0.099, 0.101), (-0.099, -0.101)] {
        for k in 0..2 {
            assert_eq!(broken(|m| m.caps[1].center[k] = from), [""; 0], "{k}");
            assert_eq!(broken(|m| m.caps[1].center[k] = to), ["cap_centred"], "{k}");
        }
    }
    // The area is 3.0615, and that of the disc may be between 2.916 and 3.223.
    for (radius, names) in [(0.963, vec!["cap_area"]), (0.965, vec![]), (1.012, vec![]), (1.014, vec!["cap_area"])] {
        assert_eq!(broken(|m| m.caps[1].radius = radius), names, "{radius}");
    }
    assert!(broken(|m| m.caps[1].radius = 0.0).contains(&"cap_area"));
    // Normals need no length of 1.
    assert_eq!(broken(|m| m.caps[1].normal = [0.0, 0.0, 1e-3]), [""; 0]);
}

#[test]
fn a_cap_without_triangles_has_no_property() {
    let names = broken(|m| m.labels.iter_mut().filter(|label| **label == 3).for_each(|label| *label = 1));
    assert_eq!(names, ["cap_disc", "cap_flat", "cap_centred", "cap_area", "cap_normal"]);
}

#[test]
fn a_cap_that_is_folded_or_doubled_is_no_disc() {
    let cap = |m: &Mesh| m.labels.iter().position(|&label| label == 3).expect("a cap");
    let reversed = broken(|m| {
        let i = cap(m);
        m.triangles[i].swap(0, 1);
    });
    assert_eq!(reversed, ["labels_match_boundary", "cap_disc", "cap_normal"]);
    let doubled = broken(|m| {
        m.triangles.push(m.triangles[cap(m)]);
        m.labels.push(3);
    });
    assert_eq!(doubled, ["labels_match_boundary", "cap_disc"]);
    // Only one triangle of the cap.
    let names = broken(|m| {
        let i = cap(m);
        (0..m.labels.len())
            .filter(|&j| j != i && m.labels[j] == 3)
            .collect::<Vec<_>>()
            .iter()
            .for_each(|&j| m.labels[j] = 1);
    });
    assert_eq!(names, ["cap_centred", "cap_area"]);
    // A quarter on each side touch in the middle only.
    let names = broken(|m| {
        let middle = |t: &[u32; 3]| t.iter().map(|&v| m.points[v as usize][0]).sum::<f64>().abs() < 1.0;
        for i in 0..m.labels.len() {
            if m.labels[i] == 3 && middle(&m.triangles[i]) {
                m.labels[i] = 1;
            }
        }
    });
    assert_eq!(names, ["cap_disc", "cap_area"]);
}

/// Each change of one condition is named by the patch.
#[test]
fn violations_name_the_patch() {
    let mut mesh = tube();
    mesh.caps[1].normal = [0.0, 0.0, -1.0];
    mesh.points[0][2] -= 1e-3;
    let report = verify(&mesh, &Demands::default());
    let text =
        "NOT valid: cap_flat: caps that are not flat: 1 (patch 2); cap_normal: caps that face inwards: 1 (patch 3)";
    assert_eq!(report.to_string(), text);
    // Patches without data of a cap, one beside another that has them.
    mesh.expected_terminals = None;
    let [a, b, c] = mesh.labels.iter().position(|&label| label == 2).map(|i| mesh.triangles[i]).expect("a face");
    let not_flat = format!("NOT valid: cap_flat: caps that are not flat: 1 (patch 2 at face {a} {b} {c})");
    mesh.caps.remove(0);
    let report = verify(&mesh, &Demands::default()).to_string();
    assert_eq!(report, format!("{not_flat}; cap_normal: caps that face inwards: 1 (patch 3)"));
    mesh.caps.clear();
    assert_eq!(verify(&mesh, &Demands::default()).to_string(), not_flat);
}

/// Outlets that share a patch have no caps of their own: then all named patches are allowed.
#[test]
fn patches_without_caps_are_those_of_grouped_outlets() {
    let grouped = |terminals: Vec<i64>, names: [&'static str; 2]| {
        broken(move |m| {
            m.caps.clear();
            (m.patches[1].1, m.patches[2].1) = (names[0].into(), names[1].into());
            m.expected_terminals = Some(terminals);
        })
    };
    let caps = ["cap_per_terminal"];
    assert_eq!(grouped(vec![0, 1], ["inlet", "outlets"]), caps);
    assert_eq!(grouped(vec![0, 1], ["plaque", "missing_1"]), caps);
    assert_eq!(grouped(vec![0, 1], ["plaque", "stent"]), ["cap_per_terminal", "wall_or_cap"]);
    assert_eq!(grouped(vec![], ["inlet", "outlets"]), ["wall_or_cap"]);
    // A label without a name is never allowed, and a name is enough only with the beginning of a cap's.
    let unnamed = broken(|m| {
        m.caps.clear();
        m.patches.pop();
    });
    assert_eq!(unnamed, ["cap_per_terminal", "wall_or_cap"]);
}

#[test]
fn ids_and_names_of_patches_differ() {
    let own = ["own_patch"];
    assert_eq!(broken(|m| m.patches.push((2, "other".into()))), own);
    assert_eq!(broken(|m| m.patches.push((9, "wall".into()))), own);
    assert_eq!(broken(|m| m.patches.push((9, "other".into()))), [""; 0]);
    let mut mesh = tube();
    mesh.patches.extend([(2, "other".into()), (8, "wall".into())]);
    let report = verify(&mesh, &Demands::default());
    assert_eq!(report.to_string(), "NOT valid: own_patch: patches with equal ids or names: 2 (patch 2, patch 8)");
    // The wall is no cap.
    assert!(broken(|m| m.caps[1].patch = 1).contains(&"own_patch"));
}

/// Parts of a patch are discs each, also where they touch at a vertex.
#[test]
fn patches_of_several_discs_are_allowed_by_name() {
    let named = |change: &dyn Fn(&mut Mesh)| {
        broken(|m| {
            m.caps.clear();
            m.expected_terminals = None;
            m.patches.truncate(2);
            change(m);
        })
    };
    // Both ends as one patch.
    let both = |m: &mut Mesh| m.labels.iter_mut().filter(|label| **label == 3).for_each(|label| *label = 2);
    assert_eq!(named(&both), [""; 0]);
    // Two quarters of a disc that touch in the middle, then a disc without one triangle.
    let angle = |m: &Mesh, i: usize| {
        let [x, y] = [0, 1].map(|k| m.triangles[i].iter().map(|&v| m.points[v as usize][k]).sum::<f64>());
        (y.atan2(x) / std::f64::consts::TAU * 16.0).rem_euclid(16.0) as usize
    };
    let only = |keep: fn(usize) -> bool| {
        move |m: &mut Mesh| {
            for i in (0..m.labels.len()).filter(|&i| m.labels[i] == 2).collect::<Vec<_>>() {
                m.labels[i] = if keep(angle(m, i)) { 2 } else { 1 };
            }
            m.labels.iter_mut().filter(|label| **label == 3).for_each(|label| *label = 1);
        }
    };
    assert_eq!(named(&only(|i| i % 8 < 4)), [""; 0]);
    assert_eq!(named(&only(|i| i > 0)), [""; 0]);
    // The wall as an outlet is a ring.
    let ring = |m: &mut Mesh| m.labels.iter_mut().for_each(|label| *label = if *label == 1 { 2 } else { 1 });
    assert_eq!(named(&ring), ["cap_disc", "cap_flat"]);
}
