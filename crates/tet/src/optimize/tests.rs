use super::strain::{ratio_of_strain, strain};
use super::*;
use anastomesh_mesh::adjacency::{boundary_faces, vertices_of};
use anastomesh_mesh::progress::StopsAfter;
use anastomesh_mesh::quality::TetQuality;
use anastomesh_mesh::shapes::{cube_lattice, perturb, tube_lattice};
use proptest::prelude::*;

/// A mesh with its inner points last and perturbed, and the number of its boundary points.
fn shaken(mut mesh: TetMesh, size: f64, seed: u64) -> (TetMesh, usize) {
    let on = vertices_of(&boundary_faces(&mesh), mesh.points.len());
    let mut order: Vec<u32> = (0..mesh.points.len() as u32).collect();
    order.sort_by_key(|&v| !on[v as usize]);
    let mut place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old as usize] = new as u32;
    }
    mesh.points = order.iter().map(|&v| mesh.points[v as usize]).collect();
    for v in mesh.tets.iter_mut().flatten() {
        *v = place[*v as usize];
    }
    let fixed = on.iter().filter(|on| **on).count();
    let inner: Vec<bool> = (0..order.len()).map(|v| v >= fixed).collect();
    // Halves each displacement until no tetrahedron is inverted.
    let rest = mesh.points.clone();
    perturb(&mut mesh.points, &inner, size, seed);
    for v in fixed..order.len() {
        let around: Vec<usize> = (0..mesh.tets.len()).filter(|&t| mesh.tets[t].contains(&(v as u32))).collect();
        let mut points = rest.clone();
        points[..v].copy_from_slice(&mesh.points[..v]);
        let goal = mesh.points[v];
        for share in [1.0, 0.5, 0.25, 0.0] {
            points[v] = rest[v] + (goal - rest[v]) * share;
            let whole = TetMesh { points: points.clone(), tets: around.iter().map(|&t| mesh.tets[t]).collect() };
            if Complex::from_mesh(whole.points, &whole.tets).is_ok() {
                break;
            }
        }
        mesh.points[v] = points[v];
    }
    (mesh, fixed)
}

fn sorted_boundary(mesh: &TetMesh) -> Vec<[u32; 3]> {
    let mut faces = boundary_faces(mesh);
    for f in &mut faces {
        let least = (0..3).min_by_key(|&i| f[i]).unwrap_or(0);
        f.rotate_left(least);
    }
    faces.sort_unstable();
    faces
}

fn improve_and_check(mesh: &TetMesh, fixed: usize) -> (TetMesh, OptimizeReport) {
    improve_with(mesh, fixed, Effort::Fast)
}

fn improve_with(mesh: &TetMesh, fixed: usize, effort: Effort) -> (TetMesh, OptimizeReport) {
    let mut improved = mesh.clone();
    let options = OptimizeOptions { fixed_points: fixed, ..OptimizeOptions::of(effort) };
    let report = optimize(&mut improved, &options).unwrap();
    // Fails unless the tetrahedra are positive and conforming.
    Complex::from_mesh(improved.points.clone(), &improved.tets).unwrap().sanity_check().unwrap();
    assert_eq!(improved.points[..fixed], mesh.points[..fixed]);
    assert_eq!(sorted_boundary(&improved), sorted_boundary(mesh));
    let (before, after) = (TetQuality::of(mesh), TetQuality::of(&improved));
    assert!(after.min >= before.min && (after.min - report.worst_after).abs() < 1e-12);
    (improved, report)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn the_surface_stays_nothing_inverts_the_worst_rises(size in 0.0..0.3_f64, seed in any::<u64>(), tube in any::<bool>()) {
        let mesh = if tube { tube_lattice(3, 6, 0.3) } else { cube_lattice(4) };
        let (mesh, fixed) = shaken(mesh, size, seed);
        improve_with(&mesh, fixed, Effort::Fast);
        improve_with(&mesh, fixed, Effort::Full);
    }
}

#[test]
fn a_shaken_tube_becomes_good() {
    let (mesh, fixed) = shaken(tube_lattice(4, 10, 0.25), 0.25, 5);
    let before = TetQuality::of(&mesh);
    let (improved, report) = improve_and_check(&mesh, fixed);
    let after = TetQuality::of(&improved);
    assert!(before.min < 0.02, "{before:?}");
    assert!(after.mean > 0.75 && after.min > 0.15 && after.dihedral_min > 10.0, "{after:?} {report:?}");
}

#[test]
fn full_effort_does_better() {
    let (mesh, fixed) = shaken(tube_lattice(4, 10, 0.25), 0.25, 7);
    let [fast, full] = [Effort::Fast, Effort::Full].map(|e| TetQuality::of(&improve_with(&mesh, fixed, e).0));
    assert!(full.mean > fast.mean && full.percentile_1 > fast.percentile_1, "{fast:?} {full:?}");
    assert!(full.mean > 0.77 && full.min > 0.3, "{full:?}");
}

#[test]
fn a_cavity_is_reconnected() {
    // Six tetrahedra around an edge that is far too short for its ring, two of them cut by a face flip. Neither edge
    // removal nor a face flip alone undoes that.
    let mut points = vec![[0.0, 0.0, -0.1], [0.0, 0.0, 0.1], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
    for i in 0..4 {
        let (sin, cos) = libm::sincos(std::f64::consts::FRAC_PI_2 * f64::from(i));
        points.push([cos, sin, 0.0]);
    }
    let mut tets = Vec::new();
    for i in 0..4 {
        let (p, q) = (4 + i, 4 + (i + 1) % 4);
        tets.extend([[0, 1, p, q], [2, 0, p, q], [1, 3, p, q]]);
    }
    let points: Vec<_> = points.into_iter().map(anastomesh_mesh::geometry::Point3::from).collect();
    let c = Complex::from_mesh(points, &tets).unwrap();
    let mut improver = Improver::new(c, &OptimizeOptions { fixed_points: 8, ..OptimizeOptions::full() });
    assert!(!improver.movable.iter().any(|&m| m));
    // The inner vertices may be left out.
    improver.movable[0] = true;
    improver.movable[1] = true;
    let before = improver.report.worst_before;
    assert!(improver.reconnect(0, 12, 1000));
    let (c, _) = improver.finish();
    c.sanity_check().unwrap();
    let after = TetQuality::of(&c.into_mesh());
    assert!(after.min > 2.0 * before, "{before} {after:?}");
}

/// A flat lid with the short edge 0-1 in its middle, between needles (0, 1, 2) and (0, 1, 5). Tetrahedron 1 lies under
/// the edge and has no needle.
fn short_edge_under_a_lid() -> TetMesh {
    let mut points = vec![[0.0, -0.005, 0.0], [0.0, 0.005, 0.0]];
    for i in 0..6 {
        let (sin, cos) = libm::sincos(std::f64::consts::FRAC_PI_3 * f64::from(i));
        points.push([cos, sin, 0.0]);
    }
    points.extend([[0.5, 0.0, -0.8], [-0.5, 0.0, -0.8], [0.0, 0.0, -2.0]]);
    let points: Vec<_> = points.into_iter().map(anastomesh_mesh::geometry::Point3::from).collect();
    let mut tets = vec![[0, 1, 2, 8], [0, 1, 8, 9], [0, 1, 9, 5]];
    tets.extend([[1, 2, 3, 8], [1, 3, 9, 8], [1, 3, 4, 9], [1, 4, 5, 9]]);
    tets.extend([[0, 2, 7, 8], [0, 7, 9, 8], [0, 7, 6, 9], [0, 6, 5, 9]]);
    // Tetrahedra below: from the outer faces of the former, except the lid, to one point.
    for [p, q, r] in [[2, 3, 8], [3, 9, 8], [3, 4, 9], [4, 5, 9], [2, 7, 8], [7, 9, 8], [7, 6, 9], [6, 5, 9]] {
        tets.push([p, q, r, 10]);
    }
    for t in &mut tets {
        let [p, q, r, s] = t.map(|v| &points[v as usize]);
        if anastomesh_mesh::geometry::predicates::orient3d(p, q, r, s) < 0.0 {
            t.swap(0, 1);
        }
    }
    TetMesh { points, tets }
}

/// Number of tetrahedra at edge 0-1, and the smallest dihedral angle of those off its needles.
fn at_short_edge(mesh: &TetMesh) -> (usize, f64) {
    let has = |t: &[u32; 4], f: &[u32]| f.iter().all(|v| t.contains(v));
    let others = mesh.tets.iter().filter(|&t| !has(t, &[0, 1, 2]) && !has(t, &[0, 1, 5]));
    let angle =
        |t: &[u32; 4]| anastomesh_mesh::quality::dihedral_range(t.map(|v| &mesh.points[v as usize])).0.to_degrees();
    (mesh.tets.iter().filter(|t| has(t, &[0, 1])).count(), others.map(angle).fold(180.0, f64::min))
}

#[test]
fn only_needles_keep_tetrahedra_at_a_short_edge_of_the_surface() {
    let mut mesh = short_edge_under_a_lid();
    mesh.tets.retain(|t| !t.contains(&10));
    mesh.points.pop();
    let (count, least) = at_short_edge(&mesh);
    assert!(count == 3 && least < 1.0, "{count} {least}");
    let c = Complex::from_mesh(mesh.points.clone(), &mesh.tets).unwrap();
    let mut improver = Improver::new(c, &OptimizeOptions { fixed_points: 10, ..OptimizeOptions::full() });
    assert!(!improver.insert_near(1), "those on needles are as bad");
    improver.allowance = allowance::Allowance::of(&improver.c);
    assert!(improver.insert_near(1));
    let (c, _) = improver.finish();
    c.sanity_check().unwrap();
    let after = c.into_mesh();
    let (count, least) = at_short_edge(&after);
    assert!(count == 2 && least > 10.0, "{count} {least}");
    assert_eq!(sorted_boundary(&mesh), sorted_boundary(&after));
    // The thorough improvement finds this result alone, and keeps the tetrahedra on the needles.
    let (whole, _) = improve_with(&mesh, 10, Effort::Full);
    let (count, least) = at_short_edge(&whole);
    assert!(count == 2 && least > 10.0, "{count} {least}");
    assert!(TetQuality::of(&whole).min > 0.5 * TetQuality::of(&mesh).min);
}

#[test]
fn one_vertex_takes_the_place_of_two_under_a_short_edge() {
    let mesh = short_edge_under_a_lid();
    let c = Complex::from_mesh(mesh.points.clone(), &mesh.tets).unwrap();
    let mut improver = Improver::new(c, &OptimizeOptions { fixed_points: 8, ..OptimizeOptions::full() });
    improver.allowance = allowance::Allowance::of(&improver.c);
    assert!(improver.insert_for_both(&mut improver::CavityBuffers::default(), [8, 9].into_iter(), 1));
    let (c, _) = improver.finish();
    c.sanity_check().unwrap();
    let after = c.into_mesh();
    assert!(!after.tets.iter().flatten().any(|v| [8, 9].contains(v)));
    let (count, least) = at_short_edge(&after);
    assert!(count == 2 && least > 10.0, "{count} {least}");
    assert_eq!(sorted_boundary(&mesh), sorted_boundary(&after));
}

#[test]
fn the_same_mesh_gives_the_same_mesh() {
    let (mesh, fixed) = shaken(cube_lattice(4), 0.2, 11);
    assert_eq!(improve_and_check(&mesh, fixed).0, improve_and_check(&mesh, fixed).0);
    let full = || improve_with(&mesh, fixed, Effort::Full).0;
    assert_eq!(full(), full());
}

#[test]
fn a_flat_sliver_under_the_surface_goes() {
    // Four corners of a square, two of them slightly higher: the upper diagonal is on the surface, the lower inside.
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 1e-9], [1.0, 1.0, 0.0], [0.0, 1.0, 1e-9], [0.5, 0.5, -1.0]];
    let points = points.map(anastomesh_mesh::geometry::Point3::from).to_vec();
    let mesh = TetMesh { points, tets: vec![[0, 1, 2, 3], [0, 2, 1, 4], [0, 3, 2, 4]] };
    assert!(TetQuality::of(&mesh).min < 1e-8);
    let (improved, _) = improve_and_check(&mesh, 5);
    assert!(TetQuality::of(&improved).min > 0.5);
}

#[test]
fn vertices_are_inserted_and_contracted_where_that_helps() {
    let (mesh, fixed) = shaken(cube_lattice(4), 0.25, 8);
    let mut improved = mesh.clone();
    let options = OptimizeOptions { fixed_points: fixed, rounds: 0, stubborn_below: 0.7, ..OptimizeOptions::default() };
    let report = optimize(&mut improved, &options).unwrap();
    assert!(report.inserted > 0 && report.contracted > 0, "{report:?}");
    Complex::from_mesh(improved.points.clone(), &improved.tets).unwrap().sanity_check().unwrap();
    assert_eq!(sorted_boundary(&improved), sorted_boundary(&mesh));
    assert!(TetQuality::of(&improved).min > TetQuality::of(&mesh).min);
}

#[test]
fn frozen_faces_inside_stay() {
    let (mesh, fixed) = shaken(cube_lattice(4), 0.2, 3);
    let mut complex = Complex::from_mesh(mesh.points.clone(), &mesh.tets).unwrap();
    let inner: Vec<u32> = complex
        .real_tets()
        .flat_map(|t| 4 * t..4 * t + 4)
        .filter(|&h| !complex.is_ghost(complex.mate(h) >> 2))
        .step_by(37)
        .collect();
    let kept: Vec<_> = inner.iter().map(|&h| complex.face(h).map(|v| complex.points[v as usize])).collect();
    for &h in &inner {
        complex.freeze(h);
    }
    let options = OptimizeOptions { fixed_points: fixed, ..OptimizeOptions::default() };
    optimize_complex(&mut complex, &options, &Watch::NOBODY);
    complex.sanity_check().unwrap();
    let faces: Vec<_> = complex
        .real_tets()
        .flat_map(|t| 4 * t..4 * t + 4)
        .map(|h| complex.face(h).map(|v| complex.points[v as usize]))
        .collect();
    for k in kept {
        assert!(faces.iter().any(|f| k.iter().all(|p| f.contains(p))));
    }
}

#[test]
fn an_exhausted_budget_ends_the_work() {
    let (mesh, fixed) = shaken(cube_lattice(4), 0.25, 1);
    let options = OptimizeOptions { fixed_points: fixed, attempts_per_tet: 0, ..OptimizeOptions::default() };
    let mut same = mesh.clone();
    let report = optimize(&mut same, &options).unwrap();
    assert!(report.budget_spent && report.flips + report.moved == 0);
    assert_eq!(same.points, mesh.points);
}

#[test]
fn what_is_not_a_mesh_is_refused_and_left_alone() {
    let mut mesh = cube_lattice(2);
    mesh.tets[5].swap(0, 1);
    let same = mesh.clone();
    assert!(optimize(&mut mesh, &OptimizeOptions::default()).is_err());
    assert_eq!(mesh, same);
}

#[test]
fn strain_falls_as_shape_improves_and_can_be_turned_back() {
    let mut last = f64::INFINITY;
    for q in [1e-6, 1e-3, 0.01, 0.1, 0.3, 0.49, 0.6, 1.0] {
        let s = strain(q);
        assert!(s < last && s >= 0.0);
        // More strain means a lower ratio.
        assert!(ratio_of_strain(s) <= q + 1e-12, "{q}");
        last = s;
    }
    // One tetrahedron of low quality weighs more than several mediocre ones.
    assert!(strain(0.013) > 2.0 * strain(0.08) + 2.0 * strain(0.2) && strain(0.01) > 6.0 * strain(0.2));
}

#[test]
fn an_improvement_that_is_stopped_tries_no_more() {
    let (mesh, fixed) = shaken(cube_lattice(8), 0.3, 3);
    let options = OptimizeOptions { fixed_points: fixed, ..OptimizeOptions::full() };
    let improved = |times: usize| {
        let mut complex = Complex::from_mesh(mesh.points.clone(), &mesh.tets).unwrap();
        let stops = StopsAfter::new(times);
        let report = optimize_complex(&mut complex, &options, &Watch::of(&stops));
        complex.sanity_check().unwrap();
        (report, stops.asked())
    };
    let (whole, asked) = improved(usize::MAX);
    assert!(asked > 4 && !whole.budget_spent);
    for times in [0, 2] {
        let (report, _) = improved(times);
        assert!(report.budget_spent && report.worst_after <= whole.worst_after);
    }
}
