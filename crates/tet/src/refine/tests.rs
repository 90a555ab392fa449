use super::*;
use crate::plc::InputKind;
use crate::progress::Watch;
use anastomesh_mesh::Bounds;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::shapes::sphere_surface;

/// A sphere with its points drawn towards the north pole, where triangles are fine.
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
    let h = s.mean_edge();
    assert!(tree.is_uniform());
    assert!((tree.size_at(&Point3::origin()) / h - 1.0).abs() < 1e-12);
    let points = graded_points(&tree, &Wall::new(&s, InputKind::Closed, 0.4), &Watch::NOBODY).unwrap();
    let volume_per_point = 4.0 / 3.0 * std::f64::consts::PI / points.len() as f64;
    assert!(points.iter().all(|p| p.coords.norm() < 1.0 - 0.3 * h));
    assert!((1.0..3.0).contains(&(volume_per_point / (tree.side(0).powi(3) / 2.0))), "{}", points.len());
}

#[test]
fn sizes_follow_the_surface_and_neighbours_differ_little() {
    let s = drawn_sphere(4);
    let sizes = vertex_sizes(&s);
    let tree = SizeTree::new(&s, &sizes, &[], &TreeOptions { doubling: Some(1.0), ..TreeOptions::default() }).unwrap();
    assert!(!tree.is_uniform());
    assert!(tree.size_at(&Point3::new(0.0, 0.0, 1.0)) < 0.5 * tree.size_at(&Point3::new(0.0, 0.0, -0.5)));
    for (p, h) in s.points.iter().zip(&sizes) {
        assert!(tree.size_at(p) <= 2.83 / 1.4 * h * 1.000_001);
    }
    // Along a line, sizes change by at most a factor of about 2.
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

/// A closed surface of two spheres, one inside the other.
fn nested(inner: f64) -> TriMesh {
    let mut s = sphere_surface(3);
    let count = s.points.len() as u32;
    let small = sphere_surface(3);
    s.points.extend(small.points.iter().map(|p| p * inner));
    s.triangles.extend(small.triangles.iter().map(|t| t.map(|v| v + count)));
    s
}

#[test]
fn sizes_grow_away_from_fine_parts_as_fast_as_asked() {
    let s = nested(0.02);
    let sizes = vertex_sizes(&s);
    let at = |growth: f64, r: f64| {
        let tree = SizeTree::new(&s, &sizes, &[], &TreeOptions::growing(growth)).unwrap();
        tree.size_at(&Point3::new(r, 0.01 * r, -0.02 * r))
    };
    let h = 0.02 * sphere_surface(3).mean_edge();
    for growth in [1.1, 1.3, 1.7] {
        // Sizes double within a number of layers that depends on the growth.
        let distance = 0.4;
        let linear = growth * h + distance * (growth - 1.0) / 0.75;
        let found = at(growth, 0.02 + distance);
        assert!(found < 2.0 * linear && found > 0.2 * linear, "{growth}: {found} {linear}");
    }
    assert!(at(1.1, 0.3) < 0.7 * at(1.7, 0.3));
}

#[test]
fn gaps_limit_sizes() {
    // A shell between two spheres of radii 1 and 0.9.
    let s = nested(0.9);
    let mut wall = Wall::new(&s, InputKind::Plc, 0.5);
    let before = wall.sizes.clone();
    limit_by_gaps(&mut wall);
    let h = s.mean_edge();
    assert!(h > 0.1);
    assert!(wall.sizes.iter().zip(&before).all(|(after, before)| (0.5..0.9).contains(&(after / before))));
    let s = sphere_surface(3);
    let mut wall = Wall::new(&s, InputKind::Closed, 0.5);
    limit_by_gaps(&mut wall);
    assert_eq!(wall.sizes, vertex_sizes(&s));
}

#[test]
fn estimates_agree_with_meshes() {
    let surface = sphere_surface(4);
    let fine = [SizeLimit::Constant(0.05)];
    let cases: [(f64, &[SizeLimit]); 3] = [(1.7, &[]), (1.2, &[]), (1.7, &fine)];
    for (growth, limits) in cases {
        let wall = Wall::new(&surface, InputKind::Closed, 0.5);
        let tree = SizeTree::new(&surface, &wall.sizes, limits, &TreeOptions::growing(growth)).unwrap();
        let sizing =
            limits.first().and_then(SizeLimit::constant).map_or(crate::Sizing::Surface, crate::Sizing::Constant);
        let interior = crate::Interior::Growing { growth };
        let made =
            crate::Tetrahedralizer::new().interior(interior).sizing(sizing).optimize(false).run(&surface).unwrap();
        let ratio = estimate_tets(&tree, &wall) / made.mesh.tets.len() as f64;
        assert!((0.6..1.6).contains(&ratio), "{growth}: {ratio}, {} tetrahedra", made.mesh.tets.len());
    }
    let wall = Wall::new(&surface, InputKind::Closed, 0.5);
    let uniform = crate::Tetrahedralizer::new().interior(crate::Interior::UNIFORM).run(&surface).unwrap();
    let ratio = estimate_uniform(1.4 * surface.mean_edge(), &wall) / uniform.mesh.tets.len() as f64;
    assert!((0.6..1.6).contains(&ratio), "{ratio}");
}

#[test]
fn estimates_of_selected_points_agree_with_meshes() {
    let surface = sphere_surface(2);
    let line: Vec<(Point3, f64)> = (-40..=40).map(|i| (Point3::new(0.0, 0.0, f64::from(i) / 100.0), 0.01)).collect();
    for growth in [1.3, 2.0] {
        let wall = Wall::new(&surface, InputKind::Closed, 0.6);
        let options = TreeOptions { is_fine: true, ..TreeOptions::growing(growth) };
        let tree = SizeTree::new(&surface, &wall.sizes, &[SizeLimit::Inside(&line)], &options).unwrap();
        let by = crate::Tetrahedralizer::new().interior(crate::Interior::Growing { growth }).optimize(false);
        let made = crate::parts::fill_around(&by, &surface, &line, &Watch::NOBODY).unwrap();
        let ratio = estimate_spaced(&tree, &wall, tree.grading().unwrap()) / made.mesh.tets.len() as f64;
        assert!((0.6..1.6).contains(&ratio), "{growth}: {ratio}, {} tetrahedra", made.mesh.tets.len());
        let alone = crate::parts::fill_spaced(&by, &surface, &Watch::NOBODY).unwrap();
        assert!(4 * alone.mesh.tets.len() < made.mesh.tets.len());
    }
}

#[test]
fn the_same_surface_gives_the_same_points() {
    let s = drawn_sphere(3);
    let sizes = vertex_sizes(&s);
    let run = || {
        let tree = SizeTree::new(&s, &sizes, &[], &TreeOptions::default()).unwrap();
        graded_points(&tree, &Wall::new(&s, InputKind::Closed, 0.4), &Watch::NOBODY).unwrap()
    };
    let points = run();
    assert!(points.len() > 100);
    assert_eq!(points, run());
}

mod insertion {
    use super::*;
    use crate::complex::Complex;
    use anastomesh_mesh::quality::TetQuality;
    use anastomesh_mesh::shapes::cube_lattice;

    fn cube() -> Complex {
        let mesh = cube_lattice(2);
        Complex::from_mesh(mesh.points, &mesh.tets).unwrap()
    }

    fn boundary(c: &Complex) -> Vec<[u32; 3]> {
        let halves = c.real_tets().flat_map(|t| 4 * t..4 * t + 4).filter(|&h| c.is_ghost(c.mate(h) >> 2));
        let mut faces: Vec<[u32; 3]> = halves.map(|h| crate::complex::face_key(c.face(h))).collect();
        faces.sort_unstable();
        faces
    }

    #[test]
    fn volumes_are_bounded_inside_and_the_boundary_stays() {
        let mut c = cube();
        let before = boundary(&c);
        let report = refine_complex(
            &mut c,
            &Goals { bounds: Bounds { max_volume: Some(0.01), ..Bounds::default() }, ..Goals::default() },
            Vec::new(),
            |_| true,
        );
        c.sanity_check().unwrap();
        assert!(report.points > 10, "{report:?}");
        assert_eq!(before, boundary(&c));
        let volume: f64 = c.real_tets().map(|t| c.orient(&c.verts(t))).sum();
        assert!((volume - 6.0).abs() < 1e-9);
    }

    #[test]
    fn sizes_are_followed_and_the_limit_of_points_holds() {
        let size = |p: &Point3| if p.x < 0.5 { 0.1 } else { 0.5 };
        let goals = Goals { size: Some(&size), ..Goals::default() };
        let mut c = cube();
        let report = refine_complex(&mut c, &goals, Vec::new(), |_| true);
        c.sanity_check().unwrap();
        let inner = |left: bool| c.points[27..].iter().filter(|p| (p.x < 0.5) == left).count();
        assert!(inner(true) > 3 * inner(false), "{report:?} {} {}", inner(true), inner(false));
        let mut c = cube();
        let goals = Goals { max_points: Some(7), ..goals };
        let report = refine_complex(&mut c, &goals, Vec::new(), |_| true);
        assert!(report.limit_reached && report.points == 7 && c.points.len() == 34);
        c.sanity_check().unwrap();
    }

    #[test]
    fn shape_is_bounded_where_the_boundary_allows_and_frozen_faces_stay() {
        let s = sphere_surface(3);
        let plain = crate::Tetrahedralizer::new().optimize(false).interior(crate::Interior::None);
        let mesh = plain.run(&s).unwrap().mesh;
        let mut c = Complex::from_mesh(mesh.points, &mesh.tets).unwrap();
        let before = TetQuality::of(&c.clone().into_mesh());
        let inner = c.real_tets().flat_map(|t| 4 * t..4 * t + 4).find(|&h| !c.is_ghost(c.mate(h) >> 2)).unwrap();
        let face = c.face(inner);
        c.freeze(inner);
        let report = refine_complex(
            &mut c,
            &Goals { bounds: Bounds { max_radius_edge: Some(1.4), ..Bounds::default() }, ..Goals::default() },
            Vec::new(),
            |_| true,
        );
        c.sanity_check().unwrap();
        assert!(crate::star::Star::default().find_face(&c, face).is_some_and(|h| c.is_frozen(h)));
        let after = TetQuality::of(&c.into_mesh());
        assert!(after.mean > before.mean + 0.2 && report.left * 20 < after.tets, "{before:?} {after:?} {report:?}");
    }

    #[test]
    fn bounds_of_regions_are_handed_on() {
        let mut c = cube();
        let left = |t: u32| c.is_real(t) && c.verts(t).iter().all(|&v| c.points[v as usize].x <= 0.5);
        let regions: Vec<u32> = (0..c.slots() as u32).map(|t| u32::from(left(t))).collect();
        // The wall between the halves is frozen, like one between regions.
        let wall: Vec<u32> = c
            .real_tets()
            .flat_map(|t| 4 * t..4 * t + 4)
            .filter(|&h| c.face(h).iter().all(|&v| c.points[v as usize].x == 0.5))
            .collect();
        for h in wall {
            c.freeze(h);
        }
        let goals = [RegionGoals::default(), RegionGoals { max_volume: Some(0.002), size: None }];
        let report = refine_complex(&mut c, &Goals { regions: &goals, ..Goals::default() }, regions, |_| true);
        assert!(report.points > 0 && c.points[27..].iter().all(|p| p.x < 0.5));
        c.sanity_check().unwrap();
    }
}
