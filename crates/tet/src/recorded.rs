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
