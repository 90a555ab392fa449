//! Second-order meshes of tubes, balls, channels and torn meshes.

use super::{QuadraticMesh, SecondOrder, check_jacobians, jacobian};
use crate::adjacency::boundary_faces;
use crate::geometry::{Point3, Vec3};
use crate::progress::{Cancelled, StopsAfter};
use crate::shapes::{cube_lattice, perturb, sphere_surface, tube_lattice, walled_channel};
use crate::{Cap, Patch, TetMesh, VolumeMesh, WALL};
use proptest::prelude::*;

/// Mesh with a wall and, where `cap` holds for the corners of a face, caps without further data.
fn labelled(mesh: TetMesh, cap: impl Fn(&[Point3; 3]) -> bool) -> VolumeMesh {
    let boundary = boundary_faces(&mesh);
    let patch = |f: &[u32; 3]| if cap(&f.map(|v| mesh.points[v as usize])) { 2 } else { WALL };
    let disc = Cap { node: 0, center: Point3::origin(), normal: Vec3::z(), radius: 1.0 };
    let patches = vec![
        Patch { id: WALL, name: "wall".into(), cap: None },
        Patch { id: 2, name: "inlet".into(), cap: Some(disc) },
    ];
    let boundary_patch = boundary.iter().map(patch).collect();
    VolumeMesh { mesh, boundary, boundary_patch, patches, ..VolumeMesh::default() }
}

/// Tube of radius 1 along z whose ends are caps.
fn tube(rings: u32, layers: u32, step: f64) -> VolumeMesh {
    labelled(tube_lattice(rings, layers, step), |corners| corners.iter().all(|p| p.z == corners[0].z))
}

/// Tube of this radius with a layer of prisms of this thickness at its wall, each cut into three tetrahedra.
fn tube_with_layer(radius: f64, thickness: f64) -> VolumeMesh {
    let mut mesh = tube_lattice(2, 6, 0.5);
    let boundary = boundary_faces(&mesh);
    let is_outer = |p: &Point3| p.coords.xy().norm() > 0.99;
    let outer: Vec<u32> = (0..).zip(&mesh.points).filter(|(_, p)| is_outer(p)).map(|(v, _)| v).collect();
    let first = mesh.points.len() as u32;
    let copy = |v: u32| outer.binary_search(&v).map(|i| first + i as u32);
    let of_radius = |p: Point3, radius: f64| Point3::new(p.x * radius, p.y * radius, p.z);
    let copies: Vec<Point3> = outer.iter().map(|&v| of_radius(mesh.points[v as usize], radius)).collect();
    mesh.points.iter_mut().for_each(|p| *p = of_radius(*p, radius - thickness));
    mesh.points.extend(copies);
    for mut face in boundary {
        face.sort_unstable();
        let ([a, b, c], [Ok(x), Ok(y), Ok(z)]) = (face, face.map(copy)) else { continue };
        // Faces of caps have no thickness.
        if mesh.points[a as usize].z == mesh.points[b as usize].z
            && mesh.points[b as usize].z == mesh.points[c as usize].z
        {
            continue;
        }
        for mut tet in [[a, b, c, z], [a, b, y, z], [a, x, y, z]] {
            let [p, q, r, s] = tet.map(|v| mesh.points[v as usize]);
            if (q - p).cross(&(r - p)).dot(&(s - p)) < 0.0 {
                tet.swap(0, 1);
            }
            mesh.tets.push(tet);
        }
    }
    labelled(mesh, |corners| corners.iter().all(|p| p.z == corners[0].z))
}

/// Ball of radius 1: tetrahedra from the centre over the triangles of a sphere.
fn ball(level: usize) -> VolumeMesh {
    let sphere = sphere_surface(level);
    let centre = sphere.points.len() as u32;
    let mut points = sphere.points;
    points.push(Point3::origin());
    let tets = sphere.triangles.iter().map(|&[a, b, c]| [centre, a, b, c]).collect();
    labelled(TetMesh { points, tets }, |_| false)
}

/// Volume of a second-order mesh: the integral of the determinant is a sixth of the mean of its coefficients.
fn volume(mesh: &TetMesh, second: &SecondOrder) -> f64 {
    let of_tet =
        |&tet: &[u32; 4]| jacobian::coefficients(&second.nodes(&mesh.points, tet)).0.iter().sum::<f64>() / 120.0;
    mesh.tets.iter().map(of_tet).sum()
}

#[test]
fn midpoints_of_a_tube_lie_on_its_circles() {
    let volume_mesh = tube(2, 6, 0.5);
    let (second, curving) = SecondOrder::curved(&volume_mesh);
    assert_eq!((curving.pulled, curving.straightened), (0, 0));
    assert!(curving.least_scaled > 0.5);
    let points = &volume_mesh.mesh.points;
    let is_outer = |v: u32| (points[v as usize].coords.xy().norm() - 1.0).abs() < 1e-9;
    let mut curved = 0;
    for face in volume_mesh.boundary.iter().filter(|face| face.iter().all(|&v| is_outer(v))) {
        for node in &second.face_nodes(*face)[3..] {
            let p = second.middles()[*node as usize - points.len()];
            assert!((p.coords.xy().norm() - 1.0).abs() < 1e-12, "{p}");
            curved += 1;
        }
    }
    assert!(curved > 100);
    // Caps stay flat.
    for (face, _) in volume_mesh.boundary.iter().zip(&volume_mesh.boundary_patch).filter(|(_, patch)| **patch == 2) {
        for node in &second.face_nodes(*face)[3..] {
            assert_eq!(second.middles()[*node as usize - points.len()].z, points[face[0] as usize].z);
        }
    }
}

#[test]
fn balanced_vertices_enclose_the_volume_of_flat_faces() {
    // Twelve points around, outside of the unit circle, so that the polygon has the area π.
    let mut given = tube(2, 6, 0.5);
    let step = std::f64::consts::PI / 6.0;
    let radius = (step / libm::sin(step)).sqrt();
    for p in &mut given.mesh.points {
        (p.x, p.y) = (p.x * radius, p.y * radius);
    }
    let before = volume(&given.mesh, &SecondOrder::straight(&given));
    let through = SecondOrder::curved(&given).0;
    assert!(volume(&given.mesh, &through) > 1.045 * before);
    let mut moved = given.clone();
    moved.mesh.points = SecondOrder::balanced_points(&given, &|_| Vec3::zeros());
    let (second, curving) = SecondOrder::curved(&moved);
    assert_eq!(curving.pulled, 0);
    assert!((volume(&moved.mesh, &second) / before - 1.0).abs() < 5e-4);
    for (p, q) in given.mesh.points.iter().zip(&moved.mesh.points) {
        let is_outer = p.coords.xy().norm() > 1.0;
        assert!((q.coords.xy().norm() - 1.0).abs() < 2e-4 || (!is_outer && (p - q).norm() < 0.002), "{p} {q}");
        assert!((p.z - q.z).abs() < 1e-9, "{p} {q}");
    }
    let flat = labelled(cube_lattice(3), |_| false);
    assert_eq!(SecondOrder::balanced_points(&flat, &|_| Vec3::zeros()), flat.mesh.points);
}

#[test]
fn thin_layers_follow_their_wall() {
    // The layer is thinner than the arcs of the wall are high, and than its vertices move.
    let step = std::f64::consts::PI / 6.0;
    let given = tube_with_layer((step / libm::sin(step)).sqrt(), 0.01);
    let mut moved = given.clone();
    moved.mesh.points = SecondOrder::balanced_points(&given, &|_| Vec3::zeros());
    let (second, curving) = SecondOrder::curved(&moved);
    assert_eq!(curving.pulled, 0, "{curving:?}");
    let wall = moved.boundary.iter().zip(&moved.boundary_patch).filter(|(_, patch)| **patch == WALL);
    for node in wall.flat_map(|(face, _)| second.face_nodes(*face)) {
        let p = match (node as usize).checked_sub(moved.mesh.points.len()) {
            None => moved.mesh.points[node as usize],
            Some(middle) => second.middles()[middle],
        };
        assert!((p.coords.xy().norm() - 1.0).abs() < 5e-4, "{p}");
    }
    assert!((volume(&moved.mesh, &second) / (std::f64::consts::PI * 3.0) - 1.0).abs() < 5e-4);
}

#[test]
fn the_volume_of_a_tube_converges_with_the_fourth_power() {
    let error = |rings: u32| {
        let tube = tube(rings, 4, 0.5);
        let (second, _) = SecondOrder::curved(&tube);
        (volume(&tube.mesh, &second) / (std::f64::consts::PI * 2.0) - 1.0).abs()
    };
    assert!((volume(&tube(2, 4, 0.5).mesh, &SecondOrder::straight(&tube(2, 4, 0.5))) - 6.0).abs() < 1e-12);
    let (coarse, fine) = (error(2), error(4));
    assert!(coarse < 1e-3 && fine < coarse / 14.0, "{coarse} {fine}");
}

#[test]
fn midpoints_of_a_ball_lie_on_the_sphere() {
    let ball = ball(2);
    let (second, curving) = SecondOrder::curved(&ball);
    assert_eq!((curving.curved, curving.pulled), (480, 0));
    for face in &ball.boundary {
        for node in &second.face_nodes(*face)[3..] {
            let p = second.middles()[*node as usize - ball.mesh.points.len()];
            assert!((p.coords.norm() - 1.0).abs() < 1e-12);
        }
    }
    let exact = 4.0 / 3.0 * std::f64::consts::PI;
    assert!((volume(&ball.mesh, &second) / exact - 1.0).abs() < 2e-4);
    assert!(check_jacobians(&ball.mesh, &second).is_valid());
}

#[test]
fn cubes_and_square_channels_stay_straight() {
    for volume in [labelled(cube_lattice(3), |_| false), walled_channel(1).0] {
        let (second, curving) = SecondOrder::curved(&volume);
        assert_eq!((curving.curved, curving.pulled, curving.least_scaled), (0, 0, 1.0));
        assert_eq!(second, SecondOrder::straight(&volume));
    }
}

#[test]
fn an_interface_between_regions_is_curved_once() {
    // The inner tube of radius 1/2 is a region of its own.
    let mut volume = tube(4, 4, 0.4);
    let mesh = &volume.mesh;
    let radius = |t: &[u32; 4]| t.iter().map(|&v| mesh.points[v as usize].coords.xy().norm()).fold(0.0, f64::max);
    volume.tet_block = mesh.tets.iter().map(|t| 1 + i32::from(radius(t) > 0.51)).collect();
    let faces = crate::region::region_faces(mesh, &volume.tet_block);
    let is_end = |f: &[u32; 3]| f.iter().all(|&v| mesh.points[v as usize].z == mesh.points[f[0] as usize].z);
    volume.boundary = faces.iter().map(|face| face.vertices).collect();
    let patch = |face: &crate::region::RegionFace| match (face.beyond, is_end(&face.vertices)) {
        (Some(_), _) => 3,
        (None, true) => 4 + face.region,
        (None, false) => WALL,
    };
    volume.boundary_patch = faces.iter().map(patch).collect();
    volume.patches.clear();
    let (second, curving) = SecondOrder::curved(&volume);
    assert_eq!(curving.pulled, 0);
    for (face, _) in volume.boundary.iter().zip(&volume.boundary_patch).filter(|(_, patch)| **patch == 3) {
        for node in &second.face_nodes(*face)[3..] {
            let p = second.middles()[*node as usize - volume.mesh.points.len()];
            assert!((p.coords.xy().norm() - 0.5).abs() < 1e-12, "{p}");
        }
    }
    assert!(check_jacobians(&volume.mesh, &second).is_valid());
}

#[test]
fn midpoints_before_a_straight_wall_are_pulled_back() {
    // A thin ring between a round interface and a wall without labels, which stays straight.
    let mut volume = tube(4, 3, 0.3);
    for p in &mut volume.mesh.points {
        let radius = p.coords.xy().norm();
        if (radius - 0.75).abs() < 0.01 {
            (p.x, p.y) = (p.x * 0.99 / radius, p.y * 0.99 / radius);
        }
    }
    assert_eq!(crate::check::check_tets(&volume.mesh, None).failed().count(), 0);
    let mesh = &volume.mesh;
    let radius = |t: &[u32; 4]| t.iter().map(|&v| mesh.points[v as usize].coords.xy().norm()).fold(1.0, f64::min);
    volume.tet_block = mesh.tets.iter().map(|t| 1 + i32::from(radius(t) > 0.9)).collect();
    let faces = crate::region::region_faces(mesh, &volume.tet_block);
    volume.boundary = faces.iter().filter(|face| face.beyond.is_some()).map(|face| face.vertices).collect();
    volume.boundary_patch = vec![3; volume.boundary.len()];
    let (second, curving) = SecondOrder::curved(&volume);
    assert!(curving.pulled > 0 && curving.straightened < curving.pulled, "{curving:?}");
    let checked = check_jacobians(&volume.mesh, &second);
    assert!(checked.is_valid() && curving.least_scaled >= 0.1 && checked.least_scaled >= 0.1 - 1e-9, "{checked:?}");
}

#[test]
fn threads_do_not_change_the_result() {
    let mut volume = tube(4, 10, 0.2);
    let movable = vec![true; volume.mesh.points.len()];
    perturb(&mut volume.mesh.points, &movable, 0.02, 7);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| SecondOrder::curved(&volume))
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn separated_cells_give_the_same_mesh() {
    let volume = tube(3, 3, 0.4);
    let (second, _) = SecondOrder::curved(&volume);
    let mut quadratic = QuadraticMesh {
        points: volume.mesh.points.iter().chain(second.middles()).copied().collect(),
        tets: volume.mesh.tets.iter().map(|&tet| second.tet_nodes(tet)).collect(),
        faces: volume.boundary.iter().map(|&face| second.face_nodes(face)).collect(),
    };
    let parts = quadratic.parts().unwrap();
    assert_eq!((&parts.points, &parts.tets), (&volume.mesh.points, &volume.mesh.tets));
    assert_eq!((&parts.faces, &parts.second), (&volume.boundary, &second));
    // A face with a midpoint of its own does not fit its element.
    quadratic.points.push(Point3::origin());
    quadratic.faces[0][4] = quadratic.points.len() as u32 - 1;
    assert_eq!(quadratic.parts().unwrap().second.split_edges().len(), 1);
    quadratic.tets[3][9] = u32::MAX;
    assert_eq!(quadratic.parts(), None);
}

#[test]
fn a_negative_jacobian_is_found() {
    let ball = ball(0);
    let (mut second, _) = SecondOrder::curved(&ball);
    let edge = second.edge_between(0, 11).unwrap() as usize;
    second.middles[edge] = Point3::origin();
    let found = check_jacobians(&ball.mesh, &second);
    assert_eq!(found.invalid.len(), 2);
    assert!(!found.is_valid());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn rough_walls_give_valid_elements(seed in any::<u64>(), size in 0.0..0.12) {
        let mut volume = tube(3, 5, 0.35);
        let movable = vec![true; volume.mesh.points.len()];
        perturb(&mut volume.mesh.points, &movable, size, seed);
        prop_assume!(crate::check::check_tets(&volume.mesh, None).failed().next().is_none());
        let (second, curving) = SecondOrder::curved(&volume);
        let checked = check_jacobians(&volume.mesh, &second);
        prop_assert!(checked.is_valid() && checked.least_scaled >= 0.099 && curving.least_scaled >= 0.1);
    }
}

#[test]
fn curving_stops_when_asked() {
    let volume = tube(2, 4, 0.4);
    let mut times = 0;
    let second = loop {
        match SecondOrder::curved_watched(&volume, &StopsAfter::new(times)) {
            Ok((second, _)) => break second,
            Err(error) => assert!(Cancelled::is_in(&error), "{error}"),
        }
        times += 1;
    };
    assert!(times > 4, "{times}");
    assert_eq!(second, SecondOrder::curved(&volume).0);
}
