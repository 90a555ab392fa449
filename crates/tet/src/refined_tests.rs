//! Tests of sizes, refinement and split surfaces through the public interface.

use super::tests::tube;
use super::*;
use anastomesh_mesh::REGULAR_DIHEDRAL;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::TetQuality;
use anastomesh_mesh::shapes::sphere_surface;
use std::sync::Arc;

fn longest_near(mesh: &TetMesh, here: impl Fn(&Point3) -> bool) -> f64 {
    let mut longest = 0.0_f64;
    for v in &mesh.tets {
        let p = v.map(|x| mesh.points[x as usize]);
        if p.iter().all(&here) {
            longest = (0..4)
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| (p[i] - p[j]).norm())
                .fold(longest, f64::max);
        }
    }
    longest
}

#[test]
fn a_function_of_the_place_sizes_the_inside() {
    let s = sphere_surface(3);
    let size = |p: &Point3| if p.coords.norm() < 0.4 { 0.05 } else { 1.0 };
    let t = Tetrahedralizer::new().sizing(Sizing::Function(Arc::new(size))).run(&Plc::from(&s)).unwrap();
    let longest = longest_near(&t.mesh, |p| p.coords.norm() < 0.35);
    assert!(longest < 0.12, "{longest}");
    let even = Tetrahedralizer::new().run(&Plc::from(&s)).unwrap();
    assert!(t.mesh.tets.len() > 2 * even.mesh.tets.len());
    assert_eq!(t.faces, s.triangles);
    let q = TetQuality::of(&t.mesh);
    assert!(q.mean > 0.8 && q.min > 0.1, "{q:?}");
}

/// Unattainable goals are approached as far as the boundary allows.
#[test]
fn any_angle_of_a_tetrahedron_may_be_asked_for() {
    let s = sphere_surface(2);
    let bounds = Refinement::default().min_dihedral(65.0);
    let t = Tetrahedralizer::new().refine(Some(bounds)).run(&Plc::from(&s)).unwrap();
    assert_eq!(t.faces, s.triangles);
}

#[test]
fn volumes_are_bounded_and_what_is_not_a_number_is_refused() {
    let s = sphere_surface(2);
    let bounds = Refinement::default().max_volume(2e-3);
    let t = Tetrahedralizer::new().refine(Some(bounds)).interior(Interior::None).run(&Plc::from(&s)).unwrap();
    assert!(t.summary.refine.is_some_and(|r| r.points > 0));
    assert_eq!(t.faces, s.triangles);
    let angle = |degrees| Refinement::default().min_dihedral(degrees);
    let bounds = [Refinement::default().max_volume(-1.0), Refinement::default().max_radius_edge(f64::NAN)];
    for bad in bounds.into_iter().chain([angle(-1.0), angle(REGULAR_DIHEDRAL), angle(f64::NAN)]) {
        let error = Tetrahedralizer::new().refine(Some(bad)).run(&Plc::from(&s)).unwrap_err();
        assert!(matches!(error, TetError::BadBound { .. }), "{error}");
    }
    let few = Tetrahedralizer::new().sizing(Sizing::PerVertex(vec![0.1])).run(&Plc::from(&s));
    assert!(matches!(few, Err(TetError::WrongLength { array: InputArray::Sizes, .. })));
}

#[test]
fn a_surface_that_may_be_split_is_split_to_size_with_a_map_of_its_pieces() {
    let s = sphere_surface(1);
    let mut plc = Plc::from(&s);
    plc.markers = (0..s.triangles.len() as i32).collect();
    let t = Tetrahedralizer::new().boundary(Boundary::Split).sizing(Sizing::Constant(0.15)).run(&plc).unwrap();
    assert!(t.faces.len() > 5 * s.triangles.len());
    assert_eq!((t.origins.len(), t.face_markers.len()), (t.faces.len(), t.faces.len()));
    assert!(t.origins.iter().zip(&t.face_markers).all(|(&o, &m)| o as i32 == m));
    assert_eq!(t.mesh.points[..s.points.len()], s.points);
    // The pieces of a triangle sum up to its area.
    let area = |points: &[Point3], t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| points[v as usize]);
        (b - a).cross(&(c - a)).norm()
    };
    let mut sums = vec![0.0; s.triangles.len()];
    for (f, &o) in t.faces.iter().zip(&t.origins) {
        sums[o as usize] += area(&t.mesh.points, f);
    }
    for (sum, tri) in sums.iter().zip(&s.triangles) {
        assert!((sum - area(&s.points, tri)).abs() < 1e-12);
    }
    assert!(longest_near(&t.mesh, |_| true) < 0.4);
    let again = Tetrahedralizer::new().boundary(Boundary::Split).sizing(Sizing::Constant(0.15)).run(&plc).unwrap();
    assert_eq!(t, again);
}

#[test]
fn the_pieces_of_a_long_tube_are_better_than_the_tube() {
    let s = tube(6, 3, 8.0, true, Vec3::z());
    let goals = Refinement::default().min_dihedral(25.0);
    let run = |b| Tetrahedralizer::new().refine(Some(goals)).boundary(b).run(&Plc::from(&s)).unwrap();
    let (kept, split) = (TetQuality::of(&run(Boundary::Keep).mesh), TetQuality::of(&run(Boundary::Split).mesh));
    assert!(split.dihedral_min > kept.dihedral_min && split.mean > kept.mean, "{kept:?} {split:?}");
}

#[test]
fn a_bound_on_volume_makes_the_lattice_fit_and_leaves_few_beyond() {
    let s = sphere_surface(3);
    let bound = 5e-4;
    let plain = Tetrahedralizer::new().run(&Plc::from(&s)).unwrap();
    let t = Tetrahedralizer::new().refine(Some(Refinement::default().max_volume(bound))).run(&Plc::from(&s)).unwrap();
    let volume = |v: &[u32; 4]| {
        let [a, b, c, d] = v.map(|x| t.mesh.points[x as usize]);
        (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0
    };
    let beyond = t.mesh.tets.iter().filter(|v| volume(v) > bound).count();
    assert!(t.mesh.tets.len() > plain.mesh.tets.len() && beyond * 100 <= t.mesh.tets.len(), "{beyond}");
    let q = TetQuality::of(&t.mesh);
    assert!(q.mean > 0.8 && q.dihedral_min > 10.0, "{q:?}");
    assert_eq!(t.faces, s.triangles);
}

#[test]
fn bounds_on_shape_leave_fewer_beyond_them() {
    let s = sphere_surface(3);
    let ratio = |mesh: &TetMesh, v: &[u32; 4]| {
        let [a, b, c, d] = v.map(|x| mesh.points[x as usize]);
        let (u, v, w) = (b - a, c - a, d - a);
        let (vw, wu, uv) = (v.cross(&w), w.cross(&u), u.cross(&v));
        let center = (vw * u.norm_squared() + wu * v.norm_squared() + uv * w.norm_squared()) / (2.0 * uv.dot(&w));
        let edges = [u, v, w, v - u, w - u, w - v].map(|e| e.norm());
        center.norm() / edges.into_iter().fold(f64::INFINITY, f64::min)
    };
    let beyond = |mesh: &TetMesh| mesh.tets.iter().filter(|v| ratio(mesh, v) > 1.2).count();
    let run = |r| Tetrahedralizer::new().interior(Interior::None).refine(r).run(&Plc::from(&s)).unwrap().mesh;
    let (plain, bounded) = (run(None), run(Some(Refinement::default().max_radius_edge(1.2))));
    let (before, after) = (beyond(&plain) * bounded.tets.len(), beyond(&bounded) * plain.tets.len());
    assert!(
        10 * after < before,
        "{} of {}, {} of {}",
        beyond(&plain),
        plain.tets.len(),
        beyond(&bounded),
        bounded.tets.len()
    );
    let angled = run(Some(Refinement::default().min_dihedral(15.0)));
    assert!(TetQuality::of(&angled).dihedral_min > 15.0 && TetQuality::of(&plain).dihedral_min < 15.0);
}

/// A fine sphere of radius 1 in a box of twelve triangles with sides of length `side`.
fn sphere_in_box(level: usize, side: f64) -> Plc {
    let sphere = sphere_surface(level);
    let mut surface = cube_surface(side);
    let first = surface.points.len() as u32;
    surface.points.extend(&sphere.points);
    surface.triangles.extend(sphere.triangles.iter().map(|t| t.map(|v| v + first)));
    Plc::from(surface)
}

fn cube_surface(side: f64) -> TriMesh {
    let corner = |i: usize| Point3::new((i & 1) as f64, ((i >> 1) & 1) as f64, (i >> 2) as f64);
    let points = (0..8).map(|i| Point3::from((corner(i).coords.add_scalar(-0.5)) * side)).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    TriMesh { points, triangles: sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect() }
}

#[test]
fn a_fine_part_in_a_coarse_box_does_not_fill_the_box() {
    let plc = sphere_in_box(4, 20.0);
    let run = |t: Tetrahedralizer| t.kind(InputKind::Plc).run(&plc);
    let made = run(Tetrahedralizer::new()).unwrap();
    let triangles = plc.surface.triangles.len();
    // A uniform lattice would have 12 million.
    assert!(made.mesh.tets.len() < 12 * triangles, "{} {triangles}", made.mesh.tets.len());
    assert_eq!(made.summary.regions, 2);
    let q = TetQuality::of(&made.mesh);
    assert!(q.mean > 0.75 && q.percentile_1 > 0.4, "{q:?}");
    let slower = run(Tetrahedralizer::new().interior(Interior::Growing { growth: 1.3 })).unwrap();
    assert!(slower.mesh.tets.len() > made.mesh.tets.len() * 3 / 2, "{}", slower.mesh.tets.len());
    let uniform = run(Tetrahedralizer::new().interior(Interior::UNIFORM).max_tets(1_000_000));
    assert!(matches!(uniform, Err(TetError::TooMany { estimate, .. }) if estimate > 5_000_000), "{uniform:?}");
}

#[test]
fn a_limit_on_tetrahedra_refuses_before_the_work_and_in_the_refinement() {
    let s = sphere_surface(3);
    let tetrahedralizer = Tetrahedralizer::new().max_tets(20_000);
    assert!(tetrahedralizer.run(&s).unwrap().mesh.tets.len() < 20_000);
    let fine = tetrahedralizer.clone().sizing(Sizing::Constant(0.01)).run(&s).unwrap_err();
    assert!(matches!(fine, TetError::TooMany { estimate, limit: 20_000 } if estimate > 10_000_000), "{fine}");
    // So short that the size field has no cubes.
    for interior in [Interior::default(), Interior::Growing { growth: 1.3 }] {
        let finest = Tetrahedralizer::new().interior(interior).sizing(Sizing::Constant(1e-7)).run(&s).unwrap_err();
        assert!(matches!(finest, TetError::TooMany { .. }), "{finest}");
    }
    let bound = Refinement::default().max_volume(1e-5);
    let refined = tetrahedralizer.interior(Interior::None).refine(bound).run(&s).unwrap_err();
    assert!(matches!(refined, TetError::TooMany { .. }), "{refined}");
}

#[test]
fn regions_have_sizes_and_growths_of_their_own() {
    let plc = sphere_in_box(2, 6.0);
    let inner = |region: Region| {
        let plc = plc.clone().regions(vec![region]);
        let made = Tetrahedralizer::new().kind(InputKind::Plc).run(&plc).unwrap();
        let count = made.regions.iter().filter(|&&id| id == 7).count();
        (count, made.mesh.tets.len() - count)
    };
    let seed = Point3::new(2.0, 2.0, 2.0);
    let plain = inner(Region::new(seed, 7));
    let sized = inner(Region::new(seed, 7).size(0.3));
    let slow = inner(Region::new(seed, 7).growth(1.25));
    assert!(sized.0 > 3 * plain.0 && sized.1 < 2 * plain.1, "{plain:?} {sized:?}");
    assert!(slow.0 > plain.0 * 5 / 4 && slow.1 < 2 * plain.1, "{plain:?} {slow:?}");
    for bad in [Region::new(seed, 7).size(0.0), Region::new(seed, 7).growth(1.0)] {
        let plc = plc.clone().regions(vec![bad]);
        let error = Tetrahedralizer::new().kind(InputKind::Plc).run(&plc).unwrap_err();
        assert!(matches!(error, TetError::BadSize { .. } | TetError::BadGrowth { .. }), "{error}");
    }
}
