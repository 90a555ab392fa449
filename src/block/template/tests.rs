use super::*;
use crate::block::end_surface::EndSurface;
use crate::block::topology::Topology;
use crate::block::{ConnectorMesh, EndStyle, Finished, mesh_free_connector, shared_ends};
use crate::partition::{Cut, CutId};
use anastomesh_mesh::geometry::Vec3;
use anastomesh_mesh::quality::{TetQuality, volume6};
use anastomesh_skeleton::BranchId;
use std::f64::consts::PI;

fn section(z: f64, radius: f64) -> Section {
    Section::new(Point3::new(1.0, 2.0, z), Vec3::z(), radius)
}

/// Sections along a circular arc with radius `bend`, from angle 0 to `angle`, in a plane in which frames do not rotate.
fn arc(bend: f64, angle: f64) -> Vec<Section> {
    let at = |i: u32| angle * f64::from(i) / 12.0;
    let place = |t: f64| {
        let origin = Point3::new(0.0, bend * libm::sin(t), bend * (1.0 - libm::cos(t)));
        Section::new(origin, Vec3::new(0.0, libm::cos(t), libm::sin(t)), 1.0)
    };
    (0..=12).map(at).map(place).collect()
}

fn discs(path: &[Section], rho: f64) -> [SharedDisc; 2] {
    [path[0], path[path.len() - 1]].map(|section| SharedDisc::new(&section, rho).expect("a disc"))
}

fn along(path: &[Section], params: &BlockParams) -> Option<FilledTube> {
    tube(path, &discs(path, params.rho), [false; 2], params)
}

/// Block of a connector along a path, with its certificate.
fn block(path: Vec<Section>, params: &BlockParams) -> Finished {
    let cut = Cut { branch: BranchId(0), sides: Cut::NOWHERE, path, size: None };
    let mesh: ConnectorMesh = mesh_free_connector(CutId(0), &cut, params).expect("a connector");
    let ends: [EndSurface; 2] = shared_ends(CutId(0), &cut, params).expect("its ends");
    Finished::of_connector(mesh, ends.each_ref()).expect("its ends are on its boundary")
}

fn volume(mesh: &TetMesh) -> f64 {
    let of = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| &mesh.points[v as usize]);
        volume6(a, b, c, d) / 6.0
    };
    mesh.tets.iter().map(of).sum()
}

#[test]
fn tubes_of_all_lengths_and_resolutions_are_sound_and_round() {
    for rho in [2.5, 3.0, 4.0, 6.0] {
        for length in [0.6, 1.0, 2.3, 7.0, 11.9, 12.1, 40.0] {
            let params = BlockParams::with_rho(rho);
            let path = vec![section(0.0, 2.0), section(2.0 * length, 2.0)];
            let found = along(&path, &params).expect("a tube");
            let quality = TetQuality::of(&found.mesh);
            assert!(quality.min > 0.3 && quality.mean > 0.75, "{rho} {length}: {quality:?}");
            assert!(block(path, &params).certificate.is_sound(), "{rho} {length}");
        }
    }
}

#[test]
fn discs_are_taken_over_bit_for_bit_and_the_lumen_is_that_of_the_vessel() {
    let path = vec![section(0.0, 1.0), section(15.0, 1.4)];
    let [first, second] = discs(&path, 3.0);
    let tube = along(&path, &BlockParams::default()).expect("a tube");
    let points = first.points.iter().chain(&second.points);
    assert!(points.eq(&tube.mesh.points[..2 * tube.disc as usize]));
    let cone = PI * 15.0 * (1.0 + 1.4 + 1.96) / 3.0;
    let volume = volume(&tube.mesh);
    assert!((volume / cone - 1.0).abs() < 0.01, "{volume} {cone}");
}

#[test]
fn discs_may_be_rotated_by_any_angle() {
    for length in [2.2, 3.0, 6.0, 30.0] {
        for degrees in (0..360).step_by(25) {
            let mut path = vec![section(0.0, 2.0), section(2.0 * length, 2.0)];
            let (y, x) = libm::sincos(f64::from(degrees).to_radians());
            path[1].up = Some(anastomesh_mesh::geometry::Vec3::new(x, y, 0.0));
            let made = along(&path, &BlockParams::default()).expect("a tube");
            let quality = TetQuality::of(&made.mesh);
            assert!(quality.min > 0.3 && quality.mean > 0.8, "{length} {degrees}: {quality:?}");
            let topology = Topology::of(&made.mesh, made.ends.iter().map(Vec::as_slice));
            let Topology { discs, wall, .. } = topology.expect("its discs are on its boundary");
            assert_eq!((&made.topology.discs, &made.topology.wall), (&discs, &wall), "{length} {degrees}");
            // Several templates have a certificate without their images.
            assert!(
                made.topology.adjacency.is_some() || made.topology.certificate.get().is_some(),
                "{length} {degrees}"
            );
            assert!(block(path, &BlockParams::default()).certificate.is_sound(), "{length} {degrees}");
        }
    }
}

#[test]
fn bends_are_followed_until_they_spoil_a_tetrahedron() {
    let wide = arc(6.0, 1.0);
    assert!(along(&wide, &BlockParams::default()).is_some());
    assert!(block(wide, &BlockParams::default()).certificate.is_sound());
    assert!(along(&arc(1.15, 1.5), &BlockParams::default()).is_none());
}

#[test]
fn steep_tapers_have_no_image() {
    let path = vec![section(0.0, 1.0), section(1.0, 4.0)];
    assert!(along(&path, &BlockParams::default()).is_none());
}

#[test]
fn tubes_with_long_edges_are_images_whatever_is_asked_of_their_axis() {
    for (rho, stretch, core) in [(3.0, 12.0, 3.0), (5.0, 12.0, 2.0_f64.sqrt()), (3.5, 16.0, 2.0), (6.0, 16.0, 2.0)] {
        for length in [3.0, 20.0, 60.0, 150.0, 200.0] {
            let path = vec![section(0.0, 1.0), section(length, 1.0)];
            let found = along(&path, &BlockParams { stretch, core, ..BlockParams::with_rho(rho) });
            assert!(found.is_some(), "{rho} {stretch} {core} {length}");
        }
    }
}

#[test]
fn stretched_tubes_have_fewer_tetrahedra_and_the_same_discs() {
    let path = vec![section(0.0, 1.0), section(30.0, 1.0)];
    let of = |stretch| {
        let params = BlockParams { stretch, ..BlockParams::default() };
        assert!(block(path.clone(), &params).certificate.is_sound());
        along(&path, &params).expect("a tube")
    };
    let [plain, stretched] = [1.0, 4.0].map(of);
    let [n, m] = [&plain, &stretched].map(|tube| tube.mesh.tets.len());
    assert!(m * 7 < n * 2, "{n} {m}");
    let shared = 2 * plain.disc as usize;
    assert_eq!(plain.mesh.points[..shared], stretched.mesh.points[..shared]);
}

#[test]
fn hulls_are_the_boundary() {
    let path = vec![section(0.0, 1.0), section(30.0, 1.0)];
    let params = BlockParams { hollow: true, ..BlockParams::default() };
    let hollow = block(path.clone(), &params);
    assert!(hollow.mesh.tets.is_empty() && hollow.certificate.is_sound());
    let filled = block(path, &BlockParams::default());
    let enclosed: f64 = hollow
        .hull
        .iter()
        .map(|t| t.map(|v| hollow.mesh.points[v as usize].coords))
        .map(|[a, b, c]| a.cross(&b).dot(&c) / 6.0)
        .sum();
    assert!((enclosed / volume(&filled.mesh) - 1.0).abs() < 1e-12);
}

#[test]
fn layers_are_rings_of_the_discs_and_as_thick_as_asked() {
    let layers = anastomesh_tet::Layers::default();
    let path = vec![section(0.0, 2.0), section(30.0, 2.0)];
    for stretch in [1.0, 4.0] {
        let params = BlockParams { layers: Some(layers), stretch, ends: EndStyle::Shared, ..BlockParams::default() };
        let plain = along(&path, &BlockParams { stretch, ..BlockParams::default() }).expect("a tube");
        let made = block(path.clone(), &params);
        assert!(made.certificate.is_sound());
        assert_eq!(made.wall.len(), plain.wall.len());
        let rim = SharedDisc::new(&path[0], params.rho).expect("a disc").rim.len();
        let vertices = &made.joints[0].vertices;
        assert_eq!(vertices.len(), plain.disc as usize + rim * layers.count as usize);
        // First rim vertex and its copies, by distance from the axis.
        let radius = |v: u32| (made.mesh.points[v as usize] - path[0].origin).norm();
        let copies = &vertices[plain.disc as usize..plain.disc as usize + layers.count as usize];
        for (&copy, depth) in copies.iter().zip(layers.depths()) {
            let expected = radius(vertices[0]) * (1.0 - layers.thickness * depth);
            assert!((radius(copy) - expected).abs() < 1e-12, "{stretch}");
        }
    }
}
