use super::tests::{THREE, capped_tube, cuboid, joined};
use crate::{InputKind, LayersConflict, Plc, Region, TetError, Tetrahedralization, Tetrahedralizer};
use anastomesh_mesh::facets::triangulate;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::shapes::sphere_surface;
use anastomesh_mesh::{TriMesh, face_key};
use rustc_hash::FxHashMap;

fn with_layers() -> Tetrahedralizer {
    Tetrahedralizer::new().kind(InputKind::Plc).layers(THREE)
}

/// Sphere (marker 1, region 1) of this radius.
fn ball(radius: f64) -> TriMesh {
    let mut sphere = sphere_surface(2);
    sphere.points.iter_mut().for_each(|p| p.coords *= radius);
    sphere
}

/// Sphere (marker 1, region 5) in a box (marker 2, region 6).
fn ball_in_box() -> Plc {
    let sphere = ball(1.0);
    let markers = [vec![1; sphere.triangles.len()], vec![2; 12]].concat();
    let complex = joined(&[sphere, cuboid(Point3::new(-2.0, -2.0, -2.0), Vec3::new(4.0, 4.0, 4.0))]);
    let seeds = [(0.0, 5), (1.5, 6)].map(|(x, id)| Region::new(Point3::new(x, x, x), id));
    Plc::from(complex).markers(markers).regions(seeds.to_vec())
}

/// Number of layer tetrahedra at each side of each face.
fn layers_at_faces(made: &Tetrahedralization) -> Vec<usize> {
    let mut beside: FxHashMap<[u32; 3], usize> = FxHashMap::default();
    for (tet, _) in made.mesh.tets.iter().zip(&made.layers).filter(|(_, layer)| **layer == 1) {
        for i in 0..4 {
            let face: Vec<u32> = (0..4).filter(|&j| j != i).map(|j| tet[j]).collect();
            *beside.entry(face_key([face[0], face[1], face[2]])).or_default() += 1;
        }
    }
    made.faces.iter().map(|face| beside.get(&face_key(*face)).copied().unwrap_or(0)).collect()
}

/// Number of faces with a marker that have this many sides with layers.
fn count(made: &Tetrahedralization, marker: i32, sides: usize) -> usize {
    let at = layers_at_faces(made);
    at.iter().zip(&made.face_markers).filter(|(found, m)| **found == sides && **m == marker).count()
}

/// Volume of each region. Numbers of regions without a seed depend on the order of tetrahedra.
fn volumes(made: &Tetrahedralization) -> Vec<f64> {
    let mut volumes: FxHashMap<i32, f64> = FxHashMap::default();
    for (tet, region) in made.mesh.tets.iter().zip(&made.regions) {
        let [a, b, c, d] = tet.map(|v| made.mesh.points[v as usize]);
        *volumes.entry(*region).or_default() += (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0;
    }
    let mut volumes: Vec<f64> = volumes.into_values().collect();
    volumes.sort_unstable_by(f64::total_cmp);
    volumes
}

fn assert_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-9 * y), "{found:?} {expected:?}");
}

/// Checks that layers change no region, and keep points and faces.
fn assert_same(made: &Tetrahedralization, plc: &Plc) {
    let plain = Tetrahedralizer::new().kind(InputKind::Plc).run(plc).expect("certified");
    assert_close(&volumes(made), &volumes(&plain));
    assert_eq!((&made.faces, &made.face_markers), (&plain.faces, &plain.face_markers));
    assert_eq!(made.mesh.points[..plc.surface.points.len()], plc.surface.points);
    assert_eq!(made.summary.regions, plain.summary.regions);
    let tets = made.summary.layers.as_ref().expect("a summary").tets;
    assert!(made.layers.iter().enumerate().all(|(t, &layer)| (layer > 0) == (t < tets)));
}

#[test]
fn facets_have_layers_on_both_sides() {
    let plc = ball_in_box();
    let made = with_layers().run(&plc).expect("certified");
    let summary = made.summary.layers.as_ref().expect("a summary");
    let sphere = plc.surface.triangles.len() - 12;
    assert_eq!((summary.tets, summary.regions), (9 * (2 * sphere + 12), 2));
    assert_eq!((summary.thin, summary.without.len()), (0, 0));
    assert_eq!((count(&made, 1, 2), count(&made, 2, 1)), (sphere, 12));
    assert_same(&made, &plc);
}

#[test]
fn markers_and_regions_choose_the_sides() {
    let plc = ball_in_box();
    let sphere = plc.surface.triangles.len() - 12;
    for (on, within, sides) in [
        (vec![1], vec![], [2, 0]),
        (vec![2], vec![], [0, 1]),
        (vec![], vec![5], [1, 0]),
        (vec![1], vec![6], [1, 0]),
        (vec![], vec![6], [1, 1]),
    ] {
        let made = with_layers().layers_on(on.clone()).layers_in(within.clone()).run(&plc).expect("certified");
        let counts = (count(&made, 1, sides[0]), count(&made, 2, sides[1]));
        assert_eq!(counts, (sphere, 12), "{on:?} {within:?}");
        assert_same(&made, &plc);
    }
    let wrong = [
        (with_layers().layers_on(vec![3]).run(&plc), LayersConflict::Marker),
        (with_layers().layers_in(vec![7]).run(&plc), LayersConflict::Region),
        (with_layers().layers_on(vec![2]).layers_in(vec![5]).run(&plc), LayersConflict::Baffles),
    ];
    for (made, conflict) in wrong {
        assert_eq!(made, Err(TetError::LayersAlong(conflict)));
    }
}

/// Box of 2 × 1 × 1 with a partition (marker 2) in its middle, which a part (marker 3) of the halves' walls surrounds.
fn partitioned() -> Plc {
    let mut plc = Plc::default();
    for x in [0.0, 1.0, 2.0] {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        plc.surface.points.extend(corners.map(|(y, z)| Point3::new(x, y, z)));
    }
    let mut square = |a: u32, b: u32, c: u32, d: u32, marker: i32| {
        plc.surface.triangles.extend([[a, b, c], [a, c, d]]);
        plc.markers.extend([marker; 2]);
    };
    square(0, 3, 2, 1, 1);
    square(4, 5, 6, 7, 2);
    square(8, 9, 10, 11, 1);
    for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        square(i, j, j + 4, i + 4, 3);
        square(i + 4, j + 4, j + 8, i + 8, 3);
    }
    plc
}

#[test]
fn partitions_keep_their_triangles_beside_layers() {
    let plc = partitioned();
    let made = with_layers().run(&plc).expect("certified");
    assert_eq!(made.summary.layers.as_ref().expect("a summary").tets, 9 * (2 * 2 + 2 * 10));
    assert_eq!((count(&made, 2, 2), count(&made, 1, 1), count(&made, 3, 1)), (2, 4, 16));
    assert_same(&made, &plc);
    // The ends shrink, and the partition must not: it belongs to both halves.
    let made = with_layers().layers_on(vec![3]).run(&plc).expect("certified");
    let summary = made.summary.layers.as_ref().expect("a summary");
    assert_eq!((summary.shrunk_caps, summary.kept_caps, summary.regions), (2, 2, 2));
    let of_partition: Vec<&[u32; 3]> =
        made.faces.iter().zip(&made.face_markers).filter(|(_, m)| **m == 2).map(|(face, _)| face).collect();
    assert_eq!(of_partition, plc.surface.triangles[2..4].iter().collect::<Vec<_>>());
    assert_eq!(made.faces.len(), plc.surface.triangles.len() + 2 * 4 * 3 * 2);
    assert_eq!((made.origins.len(), made.face_markers.len()), (made.faces.len(), made.faces.len()));
    assert_close(&volumes(&made), &[1.0, 1.0]);
}

#[test]
fn nested_shells_around_a_hole_have_layers() {
    let parts = [ball(0.5), ball(1.0), cuboid(Point3::new(-2.0, -2.0, -2.0), Vec3::new(4.0, 4.0, 4.0))];
    let each = parts[0].triangles.len();
    let markers = [vec![1; each], vec![2; each], vec![3; 12]].concat();
    let plc = Plc::from(joined(&parts)).markers(markers).holes(vec![Point3::origin()]);
    let made = with_layers().run(&plc).expect("certified");
    assert_eq!((count(&made, 1, 1), count(&made, 2, 2), count(&made, 3, 1)), (each, each, 12));
    assert_same(&made, &plc);
    // A facet in the hole is left out.
    let mut outside = plc.clone();
    outside.surface.points.extend([(0.1, 0.0), (0.0, 0.1), (-0.1, -0.1)].map(|(x, y)| Point3::new(x, y, 0.2)));
    let first = plc.surface.points.len() as u32;
    outside.surface.triangles.insert(0, [first, first + 1, first + 2]);
    outside.markers.insert(0, 9);
    let made = with_layers().layers_on(vec![2]).run(&outside).expect("certified");
    assert_eq!((made.summary.left_out.triangles.as_slice(), made.faces.len()), (&[0][..], plc.markers.len()));
    assert_eq!((count(&made, 2, 2), made.origins[0]), (each, 1));
}

/// Tube (marker 1, its ends 2 and 3, region 8) through a box (marker 4, region 9) of the same length.
fn tube_in_tissue() -> Plc {
    let mut plc = capped_tube();
    let first = plc.surface.points.len() as u32;
    let corners = [(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)];
    for z in [0.0, 3.0] {
        plc.surface.points.extend(corners.map(|(x, y)| Point3::new(x, y, z)));
    }
    let at = |level: u32, i: u32| first + 4 * level + i % 4;
    let end = |level: u32| {
        let ring = (0..16).map(|i| 16 * 6 * level + i).collect();
        let polygons = [ring, (0..4).map(|i| at(level, i)).collect()];
        let hole = Point3::new(0.01, 0.02, 3.0 * f64::from(level));
        triangulate(&plc.surface.points, &polygons, &[hole]).expect("triangles").triangles
    };
    let ends = [0, 1].map(end).concat();
    plc.surface.triangles.extend(ends);
    for i in 0..4 {
        let [a, b, c, d] = [at(0, i), at(0, i + 1), at(1, i + 1), at(1, i)];
        plc.surface.triangles.extend([[a, b, c], [a, c, d]]);
    }
    plc.markers.resize(plc.surface.triangles.len(), 4);
    let seeds = [(0.0, 8), (2.5, 9)].map(|(x, id)| Region::new(Point3::new(x, 0.0, 1.5), id));
    plc.regions(seeds.to_vec())
}

#[test]
fn tubes_in_tissue_have_layers_in_the_fluid_and_in_the_tissue() {
    let plc = tube_in_tissue();
    let wall = plc.markers.iter().filter(|m| **m == 1).count();
    let expected = volumes(&Tetrahedralizer::new().kind(InputKind::Plc).run(&plc).expect("certified"));
    for (within, sides) in [(vec![], 2), (vec![8], 1), (vec![9], 1)] {
        let made = with_layers().layers_on(vec![1]).layers_in(within.clone()).run(&plc).expect("certified");
        assert_eq!(count(&made, 1, sides), wall, "{within:?}");
        let summary = made.summary.layers.as_ref().expect("a summary");
        assert!(summary.without.is_empty(), "{within:?} {summary:?}");
        assert_close(&volumes(&made), &expected);
    }
}

/// Box with a baffle (marker 2) from its floor, a segment from its ceiling, and a single point.
fn with_constraints() -> Plc {
    let size = Vec3::new(4.0, 4.0, 4.0);
    let mut surface = cuboid(Point3::origin(), size);
    // The floor is a fan around an edge.
    surface.triangles.drain(..2);
    surface.points.extend([[1.0, 2.0, 0.0], [3.0, 2.0, 0.0], [3.0, 2.0, 2.0], [1.0, 2.0, 2.0]].map(Point3::from));
    surface.triangles.extend([[0, 2, 8], [8, 2, 9], [9, 2, 3], [9, 3, 1], [8, 9, 1], [0, 8, 1]]);
    let mut markers = vec![1; surface.triangles.len()];
    surface.triangles.extend([[8, 9, 10], [8, 10, 11]]);
    markers.extend([2, 2]);
    surface.points.extend([[2.0, 3.0, 3.0], [0.4, 0.4, 1.0]].map(Point3::from));
    Plc::from(surface).markers(markers).segments(vec![[4, 12]])
}

#[test]
fn layers_leave_constraints_alone() {
    let plc = with_constraints();
    let made = with_layers().run(&plc).expect("certified");
    assert_same(&made, &plc);
    let summary = made.summary.layers.as_ref().expect("a summary");
    assert!(summary.without == [4, 8, 9] && summary.tets > 9 * 8, "{summary:?}");
    assert_eq!(count(&made, 2, 0), 2);
    let used = |v: u32| made.mesh.tets.iter().any(|tet| tet.contains(&v));
    assert!((0..14).all(used));
    let baffle = with_layers().layers_on(vec![2]).run(&plc);
    assert_eq!(baffle, Err(TetError::LayersAlong(LayersConflict::Baffles)));
}

#[test]
fn options_hold_in_each_region() {
    let mut plc = ball_in_box();
    let inside = |made: &Tetrahedralization, id: i32| {
        made.regions.iter().zip(&made.layers).filter(|(region, layer)| **region == id && **layer == 0).count()
    };
    let usual = with_layers().run(&plc).expect("certified");
    plc.regions[0] = plc.regions[0].size(0.1);
    // A seed in the layers counts, too.
    plc.regions[0].seed.x = 0.95;
    let fine = with_layers().run(&plc).expect("certified");
    assert!(inside(&fine, 5) > 2 * inside(&usual, 5), "{} {}", inside(&fine, 5), inside(&usual, 5));
    assert!(inside(&fine, 6) < 2 * inside(&usual, 6));
    let limited = with_layers().max_tets(usual.mesh.tets.len() / 2).run(&plc);
    assert!(
        matches!(limited, Err(TetError::TooMany { limit, .. }) if limit == usual.mesh.tets.len() / 2),
        "{limited:?}"
    );
    let outside = vec![Point3::new(9.0, 0.0, 0.0), Point3::new(0.1, 0.2, 0.3)];
    let given = with_layers().interior(crate::Interior::Points(outside.clone())).optimize(false).run(&plc);
    assert!(given.expect("certified").mesh.points.contains(&outside[1]));
    let twice = vec![Point3::new(1.5, 0.0, 0.0), Point3::new(0.1, 0.2, 0.3), Point3::new(0.1, 0.2, 0.3)];
    let twice = with_layers().interior(crate::Interior::Points(twice)).run(&plc);
    assert!(matches!(twice, Err(TetError::BadInteriorPoint { index: 2, .. })), "{twice:?}");
}

#[test]
fn threads_do_not_change_the_mesh() {
    let plc = tube_in_tissue();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| with_layers().layers_on(vec![1]).run(&plc).expect("certified"))
    };
    assert_eq!(run(1), run(4));
}

/// Mean ratio of the volumes of the two tetrahedra at faces between the last layer and the core of a region.
fn mean_step(made: &Tetrahedralization, id: i32) -> f64 {
    let last = made.layers.iter().copied().max().unwrap_or(0);
    let volume = |tet: &[u32; 4]| {
        let [a, b, c, d] = tet.map(|v| made.mesh.points[v as usize]);
        (b - a).cross(&(c - a)).dot(&(d - a))
    };
    let mut at_faces: FxHashMap<[u32; 3], [f64; 2]> = FxHashMap::default();
    let all = made.mesh.tets.iter().zip(&made.regions).zip(&made.layers);
    for ((tet, _), layer) in all.filter(|((_, region), layer)| **region == id && (**layer == 0 || **layer == last)) {
        for [a, b, c] in [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]] {
            at_faces.entry(face_key([tet[a], tet[b], tet[c]])).or_default()[usize::from(*layer == 0)] += volume(tet);
        }
    }
    let steps: Vec<f64> =
        at_faces.values().filter(|both| both.iter().all(|v| *v > 0.0)).map(|[layer, core]| core / layer).collect();
    steps.iter().sum::<f64>() / steps.len() as f64
}

#[test]
fn the_core_grades_from_the_last_layer() {
    let seeds = [(0.0, 5), (1.75, 6)].map(|(x, id)| Region::new(Point3::new(x, 0.0, 0.0), id));
    let plc = Plc::from(joined(&[ball(1.0), ball(2.5)])).regions(seeds.to_vec());
    let made = with_layers().run(&plc).expect("certified");
    // In the outer region, the edges of the surface are longer than the last layer is thick.
    let step = mean_step(&made, 5);
    assert!(step < 1.2 * THREE.growth, "{step}");
    let core = &made.mesh.tets[made.summary.layers.as_ref().expect("a summary").tets..];
    let quality = anastomesh_mesh::quality::TetQuality::of_tets(&made.mesh, core);
    assert!(quality.dihedral_min > 5.0, "{}", quality.dihedral_min);
}
