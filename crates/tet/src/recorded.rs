//! Recorded meshes: a change of any result shows in their counts and hashes, in `snapshots/`. The other tests say what is right; this
//! one says what has changed.

use std::fmt::Write;

use super::delaunay::hash;
use super::recover::exact::shapes::{chazelle, dangling, fan, sheet, twisted_prism};
use super::tests::{cube, joined, tube};
use super::turned_tests::{Rng, plate, rows, split, turned};
use super::*;
use anastomesh_mesh::geometry::Vec3;
use anastomesh_mesh::shapes::{sphere_surface, torus_surface};

/// Hash of all points and tetrahedra, bit for bit.
fn hash_of(mesh: &TetMesh) -> u64 {
    let points = mesh.points.iter().flat_map(|p| p.iter().map(|x| x.to_bits()));
    let tets = mesh.tets.as_flattened().iter().map(|&v| u64::from(v));
    points.chain(tets).fold(0, |sum, x| hash(sum.rotate_left(7) ^ x))
}

fn result(plc: &Plc, tetrahedralizer: &Tetrahedralizer) -> String {
    match tetrahedralizer.run(plc) {
        Ok(made) => {
            let (points, tets) = (made.mesh.points.len(), made.mesh.tets.len());
            format!("{points} points, {tets} tetrahedra, {:016x}, {:?}", hash_of(&made.mesh), made.summary)
        }
        Err(error) => error.to_string(),
    }
}

/// Surfaces that need flips, Steiner points or exact recovery.
fn surfaces() -> Vec<(&'static str, TriMesh)> {
    let mut rng = Rng(7);
    let inner = sphere_surface(1);
    let mut hollow = sphere_surface(3);
    let first = hollow.points.len() as u32;
    hollow.points.extend(inner.points.iter().map(|p| p * 0.4));
    hollow.triangles.extend(inner.triangles.iter().map(|&[a, b, c]| [first + a, first + c, first + b]));
    vec![
        ("sphere", sphere_surface(3)),
        ("hollow sphere", hollow),
        ("two spheres", joined(sphere_surface(2), &sphere_surface(3), 0.7, Vec3::new(3.0, 0.1, 0.0))),
        ("torus", torus_surface(40, 14, 0.35)),
        ("tube", tube(23, 9, 7.0, false, Vec3::new(0.3, 0.2, 1.0))),
        ("tube with centres", tube(16, 5, 0.8, true, Vec3::new(1.0, 0.2, 0.4))),
        ("cube", cube(5)),
        ("turned cube", turned(cube(4), &mut rng)),
        ("turned plate", {
            let plate = plate(31, 1e-2, &mut rng);
            turned(plate, &mut rng)
        }),
        ("turned needles", {
            let plate = plate(240, 0.2, &mut rng);
            turned(plate, &mut rng)
        }),
        ("thin turned plate", {
            let plate = plate(19, 1e-13, &mut rng);
            turned(plate, &mut rng)
        }),
        ("split plate", {
            let plate = split(&plate(60, 0.2, &mut rng));
            turned(plate, &mut rng)
        }),
        ("turned rows", turned(rows([0.3, 0.7, 1.0], 3), &mut rng)),
        ("twisted prism", twisted_prism(8, 0.35, 1.0)),
        ("sheet", sheet(9, 0.02, 0.3, 11)),
        ("notches", chazelle(3, 0.1)),
        ("fan", fan(60, 20.0)),
    ]
}

/// Facets and segments among scattered points in a box.
fn complex() -> Plc {
    let (facets, segments) = dangling(200, 4, 0.2);
    let mut plc = Plc::from(&joined(facets, &cube(2), 1.5, Vec3::repeat(-1.0)));
    plc.segments = segments;
    plc
}

/// Name and size of a family, and its members by a number.
pub(super) type Family = (&'static str, u32, fn(u32) -> Plc);

/// Families of small surfaces and complexes.
pub(super) fn families() -> [Family; 9] {
    /// Power of ten from 1 to 1e-12.
    fn small(k: u32) -> f64 {
        libm::pow(10.0, -f64::from(k % 13))
    }
    fn rotated(surface: TriMesh, k: u32) -> Plc {
        Plc::from(&turned(surface, &mut Rng(u64::from(k) + 1)))
    }
    [
        ("plates", 52, |k| rotated(plate(7 + k, 0.3 * small(k), &mut Rng(u64::from(k))), k)),
        ("split plates", 13, |k| rotated(split(&plate(5 + 2 * k, 0.3 * small(k), &mut Rng(u64::from(k)))), k)),
        ("sheets", 24, |k| Plc::from(&sheet(2 + k / 4, 0.3 * small(k % 5), f64::from(k) / 7.0, u64::from(k)))),
        ("notches", 9, |k| Plc::from(&chazelle(1 + k / 3, small(k % 3)))),
        ("prisms", 24, |k| Plc::from(&twisted_prism(3 + k, 0.5 / f64::from(1 + k % 7), 0.3 + f64::from(k % 3)))),
        ("fans", 8, |k| Plc::from(&fan(4 + 5 * k, 1.0 + 9.0 * f64::from(k)))),
        ("tubes", 12, |k| {
            let direction = Vec3::new(0.1 * f64::from(k), 0.3, 1.0);
            Plc::from(&tube(5 + k, 2 + k % 4, 0.5 + f64::from(k % 5), k % 2 == 0, direction))
        }),
        ("rows", 12, |k| rotated(rows([0.2 + f64::from(k % 4), 0.7, 1.0], 1 + k % 3), k)),
        ("complexes", 20, |k| {
            let (facets, segments) = dangling(u64::from(20 + 15 * k), 1 + k % 6, 0.03 * f64::from(1 + k % 5));
            let mut plc = Plc::from(&joined(facets, &cube(1 + k % 3), 1.5, Vec3::repeat(-1.0)));
            plc.segments = segments;
            plc
        }),
    ]
}

#[test]
fn families_are_filled_as_recorded() {
    let mut all = String::new();
    let bare = Tetrahedralizer::new().interior(Interior::None).optimize(false);
    let open = bare.clone().kind(InputKind::Plc);
    for (name, count, make) in families() {
        let (mut counts, mut sum, mut refused) = ([0; 3], 0, 0);
        for k in 0..count {
            let plc = make(k);
            match (if plc.segments.is_empty() { &bare } else { &open }).run(&plc) {
                Ok(made) => {
                    let steiner = made.summary.recovery.steiner_points;
                    counts =
                        [counts[0] + made.mesh.points.len(), counts[1] + made.mesh.tets.len(), counts[2] + steiner];
                    sum = hash(sum ^ hash_of(&made.mesh));
                }
                Err(error) => {
                    refused += 1;
                    sum = error.to_string().bytes().fold(sum, |sum, b| hash(sum ^ u64::from(b)));
                }
            }
        }
        let [points, tets, steiner] = counts;
        writeln!(all, "{name}: {points} points, {steiner} Steiner, {tets} tetrahedra, {refused} refused, {sum:016x}")
            .expect("text");
    }
    insta::assert_snapshot!(all);
}

#[test]
fn surfaces_are_filled_as_recorded() {
    let mut all = String::new();
    let bare = Tetrahedralizer::new().interior(Interior::None).optimize(false);
    for (name, surface) in surfaces() {
        let plc = Plc::from(&surface);
        writeln!(all, "{name}: {}", result(&plc, &bare)).expect("text");
        writeln!(all, "{name}, improved: {}\n", result(&plc, &Tetrahedralizer::new())).expect("text");
    }
    let open = bare.kind(InputKind::Plc);
    writeln!(all, "complex: {}", result(&complex(), &open)).expect("text");
    insta::assert_snapshot!(all);
}
