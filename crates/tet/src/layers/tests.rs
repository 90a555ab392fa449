use crate::layer::Layers;
use crate::{Boundary, LayersConflict, Plc, TetError, Tetrahedralization, Tetrahedralizer};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::shapes::sphere_surface;

pub(super) const THREE: Layers = Layers { count: 3, growth: 1.5, thickness: 0.3 };

fn layered(surface: &TriMesh, layers: Layers) -> Tetrahedralization {
    let made = Tetrahedralizer::new().layers(Some(layers)).run(&Plc::from(surface)).expect("certified");
    assert_eq!(made.mesh.points[..surface.points.len()], surface.points);
    made
}

/// A box with one corner at `from` and outward faces.
pub(super) fn cuboid(from: Point3, size: Vec3) -> TriMesh {
    let corner = |i: usize| from + Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64).component_mul(&size);
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { points: (0..8).map(corner).collect(), triangles }
}

pub(super) fn joined(parts: &[TriMesh]) -> TriMesh {
    let mut all = TriMesh::default();
    for part in parts {
        let first = all.points.len() as u32;
        all.points.extend_from_slice(&part.points);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

#[test]
fn depths_grow_by_the_factor_and_end_at_the_whole() {
    for (count, growth) in [(1, 1.0), (3, 2.0), (7, 0.7), (30, 1.1)] {
        let depths = Layers { count, growth, thickness: 0.3 }.depths();
        assert_eq!((depths.len(), depths[depths.len() - 1]), (count as usize, 1.0));
        let sizes: Vec<f64> = std::iter::once(0.0).chain(depths.iter().copied()).collect();
        let sizes: Vec<f64> = sizes.windows(2).map(|pair| pair[1] - pair[0]).collect();
        for pair in sizes.windows(2) {
            assert!((pair[1] / pair[0] - growth).abs() < 1e-9, "{sizes:?}");
        }
    }
}

#[test]
fn what_cannot_be_is_refused_with_the_limits() {
    let bad = [
        (Layers { count: 0, ..THREE }, "1 to 30"),
        (Layers { count: 31, ..THREE }, "1 to 30"),
        (Layers { growth: 0.0, ..THREE }, "0.2 to 5"),
        (Layers { growth: f64::NAN, ..THREE }, "0.2 to 5"),
        (Layers { thickness: 1.0, ..THREE }, "0.001 to 0.8"),
        (Layers { thickness: 0.0, ..THREE }, "0.001 to 0.8"),
        (Layers { count: 20, growth: 2.0, ..THREE }, "give fewer or thicker layers"),
    ];
    for (layers, limits) in bad {
        let error = layers.check().expect_err("refused").to_string();
        assert!(error.contains(limits), "{error}");
        let plc = Plc::from(sphere_surface(1));
        assert!(matches!(Tetrahedralizer::new().layers(Some(layers)).run(&plc), Err(TetError::Layers(_))));
    }
}

#[test]
fn layers_need_a_boundary_that_stays() {
    let made = Tetrahedralizer::new().layers(Some(THREE)).boundary(Boundary::Split).run(&Plc::from(sphere_surface(1)));
    assert!(matches!(made, Err(TetError::LayersAlong(LayersConflict::SplitBoundary))), "{made:?}");
}

#[test]
fn a_sphere_has_all_its_layers_as_thick_as_asked() {
    let sphere = sphere_surface(3);
    let made = layered(&sphere, THREE);
    let summary = made.summary.layers.expect("a summary");
    assert_eq!(summary.tets, 9 * sphere.triangles.len());
    assert_eq!((summary.thin, summary.without.len()), (0, 0));
    // Radii of the copies of the first vertex. The half width of a sphere is its radius.
    let depths = THREE.depths();
    let n = sphere.points.len();
    for (copy, depth) in made.mesh.points[n..n + 3].iter().zip(depths) {
        assert!((copy.coords.norm() - (1.0 - 0.3 * depth)).abs() < 0.01, "{copy} {depth}");
    }
}

#[test]
fn a_box_of_twelve_triangles_has_layers() {
    let made = layered(&cuboid(Point3::origin(), Vec3::new(1.0, 2.0, 3.0)), THREE);
    assert_eq!(made.summary.layers.expect("a summary").tets, 9 * 12);
}

#[test]
fn plates_are_as_thin_as_can_be_and_keep_their_layers() {
    for thickness in [1e-3, 1e-6, 1e-9, 1e-12] {
        let made = layered(&cuboid(Point3::origin(), Vec3::new(1.0, 1.0, thickness)), THREE);
        let summary = made.summary.layers.expect("a summary");
        assert_eq!((summary.tets, summary.without.len()), (9 * 12, 0), "{thickness}");
    }
}

#[test]
fn shells_within_shells_have_layers_on_both_sides_whatever_way_they_are_turned() {
    let hollow = |turned: bool| {
        let mut inner = cuboid(Point3::new(1.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 1.0));
        if turned {
            inner.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        joined(&[cuboid(Point3::origin(), Vec3::new(3.0, 3.0, 3.0)), inner])
    };
    for turned in [false, true] {
        let made = layered(&hollow(turned), THREE);
        assert_eq!(made.summary.layers.expect("a summary").tets, 9 * 24);
        assert_eq!(made.summary.reversed, if turned { 0 } else { 12 });
    }
}

#[test]
fn lumps_apart_are_regions_still() {
    let two = joined(&[0.0, 5.0].map(|x| cuboid(Point3::new(x, 0.0, 0.0), Vec3::new(1.0, 1.0, 1.0))));
    let plain = Tetrahedralizer::new().run(&Plc::from(&two)).expect("certified");
    let made = layered(&two, THREE);
    assert_eq!(made.summary.regions, plain.summary.regions);
    for (tet, region) in made.mesh.tets.iter().zip(&made.regions) {
        assert_eq!(made.mesh.points[tet[0] as usize].x > 3.0, *region != made.regions[0], "{tet:?}");
    }
}

/// Two pyramids with a common apex, point 0.
fn pyramids() -> TriMesh {
    let square = |z: f64| [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Point3::new(x, y, z));
    let mut surface = TriMesh { points: vec![Point3::origin()], triangles: Vec::new() };
    surface.points.extend(square(1.0).into_iter().chain(square(-1.0)));
    for i in 0..4_u32 {
        let (a, b) = (1 + i, 1 + (i + 1) % 4);
        surface.triangles.extend([[0, b, a], [0, a + 4, b + 4]]);
    }
    surface.triangles.extend([[1, 2, 3], [1, 3, 4], [5, 7, 6], [5, 8, 7]]);
    surface
}

#[test]
fn regions_with_a_common_vertex_have_layers_there() {
    let made = layered(&pyramids(), THREE);
    let summary = made.summary.layers.expect("a summary");
    assert_eq!((summary.tets, summary.regions, summary.without), (9 * 12, 2, Vec::new()));
}

#[test]
fn a_vertex_from_which_nothing_leads_in_has_no_layer_and_is_named() {
    // Around the pyramids, each direction from the apex leads into one of them or runs along it.
    let around = joined(&[pyramids(), cuboid(Point3::new(-3.0, -3.0, -3.0), Vec3::new(6.0, 6.0, 6.0))]);
    assert_eq!(layered(&around, THREE).summary.layers.expect("a summary").without, [0]);
}

#[test]
fn bounds_are_for_what_is_inside_of_the_layers() {
    let inside = |refinement| {
        let plc = Plc::from(sphere_surface(2));
        let made = Tetrahedralizer::new().layers(Some(THREE)).refine(refinement).run(&plc).expect("certified");
        let layers = made.summary.layers.expect("a summary").tets;
        assert_eq!(layers, 9 * plc.surface.triangles.len());
        made.mesh.tets.len() - layers
    };
    let fine = crate::Refinement::default().max_volume(2e-4);
    assert!(inside(Some(fine)) > 2 * inside(None));
}

/// Tube along z with walls (marker 1) and flat ends (markers 2 and 3), each with a vertex in the middle.
pub(super) fn capped_tube() -> Plc {
    let (around, rings) = (16_u32, 7_u32);
    let on_ring = |ring: u32, i: u32| {
        let turn = std::f64::consts::TAU * f64::from(i) / f64::from(around);
        Point3::new(libm::cos(turn), libm::sin(turn), 0.5 * f64::from(ring))
    };
    let mut points: Vec<Point3> = (0..rings).flat_map(|ring| (0..around).map(move |i| on_ring(ring, i))).collect();
    points.extend([0, rings - 1].map(|ring| Point3::new(0.1, 0.0, 0.5 * f64::from(ring))));
    let at = |ring: u32, i: u32| ring * around + i % around;
    let (mut triangles, mut markers) = (Vec::new(), Vec::new());
    for ring in 0..rings - 1 {
        for i in 0..around {
            let [a, b, c, d] = [at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)];
            triangles.extend([[a, b, c], [a, c, d]]);
            markers.extend([1, 1]);
        }
    }
    for i in 0..around {
        triangles.extend([
            [at(0, i + 1), at(0, i), rings * around],
            [at(rings - 1, i), at(rings - 1, i + 1), rings * around + 1],
        ]);
        markers.extend([2, 3]);
    }
    Plc::new(points, triangles).markers(markers)
}

fn area(made: &Tetrahedralization, marker: i32) -> f64 {
    let chosen = made.faces.iter().zip(&made.face_markers).filter(|(_, m)| **m == marker);
    let doubled = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|v| made.mesh.points[v as usize]);
        (b - a).cross(&(c - a)).norm()
    };
    chosen.map(|(face, _)| 0.5 * doubled(face)).sum()
}

#[test]
fn layers_on_a_marker_end_in_rings_on_flat_ends() {
    let plc = capped_tube();
    let plain = Tetrahedralizer::new().run(&plc).expect("certified");
    let made = Tetrahedralizer::new().layers(THREE).layers_on(vec![1]).run(&plc).expect("certified");
    let summary = made.summary.layers.as_ref().expect("a summary");
    let wall = plc.markers.iter().filter(|m| **m == 1).count();
    assert_eq!((summary.tets, summary.shrunk_caps, summary.kept_caps), (9 * wall, 2, 0));
    assert!(summary.without.is_empty() && summary.thin == 0, "{summary:?}");
    // Each of the 16 edges of a rim has three quadrilaterals.
    assert_eq!(made.faces.len(), plc.surface.triangles.len() + 2 * 16 * 3 * 2);
    assert_eq!((made.origins.len(), made.face_markers.len()), (made.faces.len(), made.faces.len()));
    for marker in [1, 2, 3] {
        assert!((area(&made, marker) - area(&plain, marker)).abs() < 1e-12);
    }
    // No wall triangle changes.
    assert!(plc.surface.triangles.iter().zip(&plc.markers).all(|(t, m)| *m != 1 || made.faces.contains(t)));
    // Each layer tetrahedron is beside the wall, so the core reaches both ends.
    let centre = |tet: &[u32; 4]| tet.iter().map(|&v| made.mesh.points[v as usize].coords).sum::<Vec3>() / 4.0;
    assert!(made.mesh.tets[..summary.tets].iter().map(centre).all(|p| p.xy().norm() > 0.6));
    assert!(made.mesh.tets[summary.tets..].iter().map(centre).any(|p| p.z < 0.2));
    let unknown = Tetrahedralizer::new().layers(THREE).layers_on(vec![1, 7]).run(&plc);
    assert!(matches!(unknown, Err(TetError::LayersAlong(_))), "{unknown:?}");
}

#[test]
fn layers_vanish_towards_curved_parts_without_layers() {
    let sphere = sphere_surface(3);
    let is_upper = |t: &[u32; 3]| t.iter().all(|&v| sphere.points[v as usize].z > -1e-9);
    let markers: Vec<i32> = sphere.triangles.iter().map(|t| if is_upper(t) { 2 } else { 1 }).collect();
    let plc = Plc::from(&sphere).markers(markers);
    let made = Tetrahedralizer::new().layers(THREE).layers_on(vec![1]).run(&plc).expect("certified");
    let summary = made.summary.layers.expect("a summary");
    assert_eq!((summary.shrunk_caps, summary.kept_caps), (0, 1));
    assert!(!summary.without.is_empty() && summary.without.iter().all(|&v| sphere.points[v as usize].z > -0.2));
    assert_eq!(made.mesh.points[..sphere.points.len()], sphere.points);
    assert_eq!(made.faces.len(), sphere.triangles.len());
    assert!(summary.tets > 3 * sphere.triangles.len() && summary.tets < 5 * sphere.triangles.len());
}

#[test]
fn each_tetrahedron_has_its_layer() {
    let sphere = sphere_surface(2);
    let made = layered(&sphere, THREE);
    let count = |layer: i32| made.layers.iter().filter(|&&l| l == layer).count();
    assert_eq!([1, 2, 3].map(count), [3 * sphere.triangles.len(); 3]);
    assert_eq!(made.layers.len(), made.mesh.tets.len());
    // A tetrahedron of the first layer has a vertex of the surface, one of the core has none.
    let is_outer = |tet: &[u32; 4]| tet.iter().any(|&v| (v as usize) < sphere.points.len());
    let expected = made.mesh.tets.iter().map(is_outer);
    assert!(made.layers.iter().zip(expected).all(|(&layer, outer)| (layer == 1) == outer));
    assert!(Tetrahedralizer::new().run(&sphere).expect("certified").layers.is_empty());
}
