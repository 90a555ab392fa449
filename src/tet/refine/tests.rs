use super::*;
use crate::geometry::Point3;
use crate::mesh::TriMesh;
use crate::mesh::shapes::sphere_surface;

/// A sphere whose points are drawn towards the north pole, so that triangles are fine there.
fn drawn_sphere(level: usize) -> TriMesh {
    let mut s = sphere_surface(level);
    for p in &mut s.points {
        let z = 1.0 - (1.0 - p.z) * (1.0 - p.z) / 2.0;
        let r = (1.0 - z * z).max(0.0).sqrt() / (p.x * p.x + p.y * p.y).sqrt().max(1e-9);
        *p = Point3::new(p.x * r, p.y * r, z);
    }
    s
}

#[test]
fn an_even_surface_has_an_even_field_of_its_size() {
    let s = sphere_surface(3);
    let sizes = vertex_sizes(&s);
    let tree = SizeTree::new(&s, &sizes, &[], &TreeOptions::default()).unwrap();
    let h = super::super::lattice::mean_edge(&s);
    assert!(tree.is_uniform());
    assert!((tree.size_at(&Point3::origin()) / h - 1.0).abs() < 1e-12);
    let points = graded_points(&s, &sizes, &tree, 0.4);
    let volume_per_point = 4.0 / 3.0 * std::f64::consts::PI / points.len() as f64;
    assert!(points.iter().all(|p| p.coords.norm() < 1.0 - 0.3 * h));
    assert!((1.0..3.0).contains(&(volume_per_point / (tree.side(0).powi(3) / 2.0))), "{}", points.len());
}

#[test]
fn sizes_follow_the_surface_and_neighbours_differ_little() {
    let s = drawn_sphere(4);
    let sizes = vertex_sizes(&s);
    let tree = SizeTree::new(&s, &sizes, &[], &TreeOptions { coarsen: true, ..TreeOptions::default() }).unwrap();
    assert!(!tree.is_uniform());
    assert!(tree.size_at(&Point3::new(0.0, 0.0, 1.0)) < 0.5 * tree.size_at(&Point3::new(0.0, 0.0, -0.5)));
    for (p, h) in s.points.iter().zip(&sizes) {
        assert!(tree.size_at(p) <= 1.87 / 1.4 * h * 1.000_001);
    }
    // Along a line sizes never jump by more than a factor of two.
    let at = |i: i32| tree.size_at(&Point3::new(0.01, 0.02, f64::from(i) * 1e-3));
    for i in -999..1000 {
        let ratio = at(i) / at(i - 1);
        assert!((0.4..2.5).contains(&ratio), "{ratio}");
    }
}

#[test]
fn limits_are_obeyed_together() {
    let s = sphere_surface(2);
    let sizes = vertex_sizes(&s);
    let ball = |p: &Point3| if p.coords.norm() < 0.2 { 0.02 } else { 1.0 };
    let limits = [SizeLimit::Constant(0.2), SizeLimit::Function(&ball)];
    let tree = SizeTree::new(&s, &sizes, &limits, &TreeOptions::default()).unwrap();
    assert!(tree.size_at(&Point3::origin()) <= 0.02 * 1.87 / 1.4);
    assert!(tree.size_at(&Point3::new(0.0, 0.0, 0.9)) <= 0.2 * 1.87 / 1.4);
    assert!(tree.size_at(&Point3::new(0.0, 0.0, 0.9)) > 0.05);
    let fine = vec![0.05; s.points.len()];
    let tree = SizeTree::new(&s, &sizes, &[SizeLimit::PerVertex(&fine)], &TreeOptions::default()).unwrap();
    assert!(s.points.iter().all(|p| tree.size_at(p) <= 0.05 * 1.87 / 1.4));
}

#[test]
fn the_same_surface_gives_the_same_points() {
    let s = drawn_sphere(3);
    let sizes = vertex_sizes(&s);
    let run = || {
        let tree = SizeTree::new(&s, &sizes, &[], &TreeOptions::default()).unwrap();
        graded_points(&s, &sizes, &tree, 0.4)
    };
    let points = run();
    assert!(points.len() > 100);
    assert_eq!(points, run());
}
