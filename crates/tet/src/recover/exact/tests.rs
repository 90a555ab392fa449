use super::shapes::{chazelle, dangling, fan, scatter, sheet, twisted_prism};
use super::*;
use crate::delaunay::delaunay;
use crate::error::{Obstacle, Stuck};
use crate::input::validate;
use crate::plc::InputKind;
use crate::recover::flat_height;
use crate::survey::survey;
use crate::{carve, certify, conform};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::budget::Budget;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::Vec3;
use proptest::prelude::*;

/// Recovers a whole surface by exact recovery alone, then carves and certifies.
fn fills(surface: &TriMesh, segments: &[[u32; 2]], kind: InputKind) -> Result<ExactSummary, TetError> {
    let edges = validate(surface, segments, kind)?;
    let mut points = surface.points.clone();
    points.extend(conform::box_corners(&surface.points));
    let mut c = delaunay(&points)?;
    let (lost_edges, lost_triangles) = survey(&mut c, surface, &edges);
    let missing = Missing { edges: &lost_edges, triangles: &lost_triangles };
    let mut recovery = ExactRecovery::new(c, (surface, &edges), missing, flat_height(&surface.points));
    let mut result = Err(TetError::NotRecovered { edges: Vec::new(), triangles: Vec::new() });
    for way in RecoveryStrategy::GIVEN {
        result = recovery.attempt(way, 100, &Watch::NOBODY);
        if !matches!(result, Err(TetError::Stuck { .. })) {
            break;
        }
    }
    let (c, summary) = result?;
    c.sanity_check()?;
    let mut c = c;
    assert_eq!(survey(&mut c, surface, &edges), (Vec::new(), Vec::new()));
    if kind == InputKind::Closed {
        let sides = carve::Sides::find(&c, surface, kind, &[])?;
        let mesh = carve::carve(&c, surface, &sides).into_compact_mesh(surface.points.len());
        certify::certify(&mesh, surface)?;
    }
    Ok(summary)
}

fn fills_all(surface: &TriMesh) -> ExactSummary {
    fills(surface, &[], InputKind::Closed).unwrap_or_else(|e| panic!("{e}"))
}

/// Delaunay tetrahedralization of the points of a surface and of a box around it.
fn in_a_box(surface: &TriMesh) -> Complex {
    let mut points = surface.points.clone();
    points.extend(conform::box_corners(&surface.points));
    delaunay(&points).unwrap()
}

#[test]
fn twisted_prisms_are_filled() {
    // Three sides make Schönhardt's polyhedron; more sides have only concave triangles, too.
    for n in 3..9 {
        for turn in [-0.5, -0.1, 0.3] {
            for height in [0.3, 1.0, 20.0] {
                fills_all(&twisted_prism(n, turn * 6.0 / f64::from(n), height));
            }
        }
    }
    assert!(fills_all(&twisted_prism(3, -0.5, 1.0)).on_segments > 0);
}

#[test]
fn thin_sheets_with_unlike_sides_are_filled() {
    for (n, thickness) in [(1, 0.1), (4, 0.1), (4, 1e-3), (6, 1e-6), (3, 1e-9)] {
        for salt in 0..3 {
            fills_all(&sheet(n, thickness, 0.0, salt));
        }
    }
    fills_all(&sheet(4, 1e-3, 1e6, 1));
}

/// Copies of a surface in a row.
fn row(of: &TriMesh, count: u32) -> TriMesh {
    let mut s = TriMesh::default();
    for k in 0..count {
        let first = s.points.len() as u32;
        s.points.extend(of.points.iter().map(|p| p + Vec3::new(5.0 * f64::from(k), 0.0, 0.0)));
        s.triangles.extend(of.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    s
}

#[test]
fn what_is_recovered_before_a_budget_ends_is_kept() {
    let surface = row(&twisted_prism(3, -0.5, 1.0), 12);
    let edges = validate(&surface, &[], InputKind::Closed).unwrap();
    let mut c = in_a_box(&surface);
    let (lost_edges, lost_triangles) = survey(&mut c, &surface, &edges);
    let start = |c: Complex| {
        let missing = Missing { edges: &lost_edges, triangles: &lost_triangles };
        ExactRecovery::new(c, (&surface, &edges), missing, flat_height(&surface.points))
    };
    let way = RecoveryStrategy::GIVEN[0];
    let whole = Budget::new(u64::MAX);
    let mut recovery = start(c.clone());
    let before = recovery.missing();
    recovery.attempt(way, 100, &Watch::NOBODY.within(&whole)).unwrap();
    let mut missing = Vec::new();
    for share in [0.0, 0.3, 0.7] {
        let budget = Budget::new((share * whole.spent() as f64) as u64);
        let mut recovery = start(c.clone());
        let error = recovery.attempt(way, 100, &Watch::NOBODY.within(&budget)).unwrap_err();
        assert!(matches!(error, TetError::OverBudget { .. }), "{error}");
        missing.push(recovery.missing());
        let (mut complex, ..) = recovery.into_complex();
        complex.sanity_check().unwrap();
        let (edges, triangles) = survey(&mut complex, &surface, &edges);
        assert_eq!(missing.last(), Some(&(edges.len() + triangles.len())));
    }
    assert_eq!(missing[0], before);
    assert!(missing[1] < before * 9 / 10 && missing[2] < before / 2 && missing[2] > 0, "{missing:?} of {before}");
}

#[test]
fn an_attempt_that_recovered_nothing_is_not_repeated() {
    let surface = twisted_prism(5, 0.3, 1.0);
    let edges = validate(&surface, &[], InputKind::Closed).unwrap();
    let mut c = in_a_box(&surface);
    let (lost_edges, lost_triangles) = survey(&mut c, &surface, &edges);
    let missing = Missing { edges: &lost_edges, triangles: &lost_triangles };
    let mut recovery = ExactRecovery::new(c, (&surface, &edges), missing, flat_height(&surface.points));
    let way = RecoveryStrategy::GIVEN[0];
    let mut spent = |share: u64, limit: u64| {
        let budget = Budget::new(limit);
        recovery.attempt(way, share, &Watch::NOBODY.within(&budget)).unwrap_err();
        budget.spent()
    };
    assert!(spent(4, 100) > 0);
    assert_eq!((spent(4, 100), spent(1, 100)), (0, 0));
    assert!(spent(16, 100) > 0);
}

#[test]
fn a_recovery_in_planes_that_took_too_long_is_repeated_with_more_or_for_fewer_parts() {
    let surface = twisted_prism(5, 0.3, 1.0);
    let edges = validate(&surface, &[], InputKind::Closed).unwrap();
    let start = |missing: Missing, last: Option<TooLong>| {
        let c = delaunay(&surface.points).unwrap();
        ExactRecovery::new(c, (&surface, &edges), missing, 0.0).after(last)
    };
    let too_long = |edges: &[[u32; 2]], triangles: &[u32], last| {
        let recovery = start(Missing { edges, triangles }, last);
        assert_eq!(recovery.missing(), edges.len() + triangles.len());
        [3, 4, 5].map(|share| recovery.is_too_long(share))
    };
    let last = Some(TooLong { share: 4, missing: 8 });
    assert_eq!(too_long(&[[0, 6]; 3], &[0, 1], last), [true, true, false]);
    assert_eq!(too_long(&[[0, 6]; 3], &[0], last), [false; 3]);
    assert_eq!(too_long(&[[0, 6]; 3], &[0, 1], None), [false; 3]);
}

#[test]
fn strategies_that_differ_in_edges_alone_fail_alike_without_edges() {
    let surface = twisted_prism(5, 0.3, 1.0);
    let edges = validate(&surface, &[], InputKind::Closed).unwrap();
    let [first, second, ..] = RecoveryStrategy::GIVEN;
    let futile = |edges_missing: &[[u32; 2]]| {
        let missing = Missing { edges: edges_missing, triangles: &[0] };
        let c = delaunay(&surface.points).unwrap();
        let mut recovery = ExactRecovery::new(c, (&surface, &edges), missing, 0.0);
        assert!(!recovery.is_futile(first, 1));
        recovery.futile = vec![(first, 2)];
        [(first, 1), (first, 2), (first, 3), (second, 1), (second, 3)]
            .map(|(way, share)| recovery.is_futile(way, share))
    };
    assert_eq!(futile(&[[0, 6]]), [true, true, false, false, false]);
    assert_eq!(futile(&[]), [true, true, false, true, false]);
}

/// Recovery of a prism, with its first strategy.
fn with_recovery<R>(of: impl FnOnce(ExactRecovery, RecoveryStrategy) -> R) -> R {
    let surface = twisted_prism(3, -0.5, 1.0);
    let edges = validate(&surface, &[], InputKind::Closed).unwrap();
    let mut c = in_a_box(&surface);
    let (lost_edges, lost_triangles) = survey(&mut c, &surface, &edges);
    let missing = Missing { edges: &lost_edges, triangles: &lost_triangles };
    of(ExactRecovery::new(c, (&surface, &edges), missing, 0.0), RecoveryStrategy::GIVEN[0])
}

#[test]
fn a_strategy_whose_parts_took_too_long_is_repeated_with_more_operations() {
    with_recovery(|mut recovery, way| {
        let error = recovery.attempt(way, 0, &Watch::NOBODY).unwrap_err();
        assert!(matches!(error, TetError::Stuck { reason: Stuck::Budget, .. }), "{error}");
        assert!(recovery.attempt(way, 100, &Watch::NOBODY).is_ok());
    });
}

#[test]
fn a_recovered_complex_keeps_no_record_of_its_changes() {
    with_recovery(|mut recovery, way| {
        let (mut c, summary) = recovery.attempt(way, 100, &Watch::NOBODY).unwrap();
        assert!(summary.on_segments > 0);
        assert_eq!(c.keep_changes(), 0);
    });
}

/// Missing parts of prisms in a row, and the error if no part may take any operation.
fn starved(count: u32) -> (usize, Vec<[u32; 2]>, TetError) {
    let surface = row(&twisted_prism(3, -0.5, 1.0), count);
    let edges = validate(&surface, &[], InputKind::Closed).unwrap();
    let mut c = in_a_box(&surface);
    let (lost_edges, lost_triangles) = survey(&mut c, &surface, &edges);
    let missing = Missing { edges: &lost_edges, triangles: &lost_triangles };
    let parts = parts::parts(&surface.triangles, missing);
    let mut recovery = ExactRecovery::new(c, (&surface, &edges), missing, 0.0);
    let error = recovery.attempt(RecoveryStrategy::GIVEN[0], 0, &Watch::NOBODY).unwrap_err();
    assert_eq!(recovery.missing(), lost_edges.len() + lost_triangles.len());
    (parts.len(), parts.iter().map(|part| part.edges[0]).collect(), error)
}

#[test]
fn a_strategy_ends_once_many_parts_wait() {
    let (parts, edges, error) = starved(40);
    assert!(parts > 60);
    assert_eq!(error, TetError::Stuck { part: Obstacle::Edge(edges[16 + parts / 2]), reason: Stuck::Budget });
}

#[test]
fn a_strategy_ends_after_some_rounds() {
    let (parts, edges, error) = starved(4);
    assert!((4..32).contains(&parts));
    assert_eq!(error, TetError::Stuck { part: Obstacle::Edge(edges[parts - 1]), reason: Stuck::Budget });
}

#[test]
fn a_strategy_ends_once_it_has_too_many_vertices() {
    let surface = row(&twisted_prism(3, -0.5, 1.0), 4);
    let edges = validate(&surface, &[], InputKind::Closed).unwrap();
    let mut c = in_a_box(&surface);
    let (lost_edges, lost_triangles) = survey(&mut c, &surface, &edges);
    let missing = Missing { edges: &lost_edges, triangles: &lost_triangles };
    let first = parts::parts(&surface.triangles, missing).swap_remove(0);
    let segments = Segments::new(&edges, surface.points.len());
    let push = Push::new(Space::new(c, 0.0), segments, surface.triangles.clone());
    let way = (RecoveryStrategy::GIVEN[0], 0, 100);
    let Err(Failed { error, rest, .. }) = Queue::new(push, (&surface, &edges), way, &Watch::NOBODY).run(missing) else {
        panic!("the whole surface without a vertex");
    };
    let TetError::Stuck { part, reason: Stuck::Budget } = error else { panic!("{error}") };
    let known = first.triangles.iter().map(|&t| Obstacle::Triangle(surface.triangles[t as usize]));
    assert!(first.edges.iter().map(|&edge| Obstacle::Edge(edge)).chain(known).any(|known| known == part), "{part}");
    assert_eq!(rest.edges.len() + rest.triangles.len(), lost_edges.len() + lost_triangles.len());
}

#[test]
fn wider_cavities_fill_as_well() {
    push::WIDER_FIRST.set(true);
    fills_all(&twisted_prism(5, 0.3, 1.0));
    fills_all(&chazelle(2, 0.1));
    let wide = fills_all(&sheet(6, 1e-3, 0.0, 1));
    push::WIDER_FIRST.set(false);
    let narrow = fills_all(&sheet(6, 1e-3, 0.0, 1));
    assert!(wide.steiner_points < narrow.steiner_points, "{wide:?} {narrow:?}");
}

#[test]
fn notched_boxes_are_filled() {
    for (n, gap) in [(1, 0.5), (2, 0.1), (3, 0.01)] {
        fills_all(&chazelle(n, gap));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn spheres_of_random_points_are_filled(
        raw in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, 0.2..1.0f64), 12..60), flat in 0.01..1.0f64
    ) {
        // Convex hull of random points on a sphere, moved along their rays: star-shaped, with long thin triangles.
        let points: Vec<Point3> = raw
            .iter()
            .map(|&(x, y, z, _)| Point3::from(Vec3::new(x, y, z).normalize()))
            .collect();
        prop_assume!(points.iter().all(|p| p.x.is_finite()));
        let c = delaunay(&points).unwrap();
        let ghosts = (0..c.slots() as u32).filter(|&t| c.is_alive(t) && c.is_ghost(t));
        let triangles: Vec<[u32; 3]> = ghosts.map(|t| c.face(c.mate(4 * t + 3))).collect();
        let inside = triangles.iter().all(|t| {
            let [p, q, r] = t.map(|v| points[v as usize]);
            anastomesh_mesh::geometry::predicates::orient3d(&Point3::origin(), &p, &q, &r) > 0.0
        });
        prop_assume!(inside);
        let moved = points.iter().zip(&raw).map(|(p, r)| {
            let p = p.coords * r.3;
            Point3::new(p.x, p.y, p.z * flat)
        });
        let used: Vec<Point3> = moved.collect();
        fills_all(&TriMesh { points: used, triangles });
    }
}

#[test]
fn fans_of_thin_triangles_are_filled() {
    for (n, length) in [(10, 3.0), (60, 20.0), (150, 5.0)] {
        fills_all(&fan(n, length));
    }
}

#[test]
fn facets_that_edges_pierce_are_recovered() {
    // Pairs of points above and below a triangle, closer to each other than to its corners.
    let mut points: Vec<Point3> =
        [(-9.0, -5.0), (9.0, -5.5), (0.5, 9.0)].map(|(x, y)| Point3::new(x, y, 0.01 * x)).into();
    for p in scatter(12) {
        points.push(Point3::new(p.x - 0.5, p.y - 0.5, 0.3 + p.z));
        points.push(Point3::new(p.y - 0.5, p.x - 0.5, -0.3 - p.z));
    }
    let surface = TriMesh { points, triangles: vec![[0, 1, 2]] };
    let summary = fills(&surface, &[], InputKind::Plc).unwrap();
    assert!(summary.on_facets > 3, "{summary:?}");
}

#[test]
fn segments_and_facets_that_dangle_are_recovered() {
    let (surface, segments) = dangling(300, 5, 0.15);
    let summary = fills(&surface, &segments, InputKind::Plc).unwrap();
    assert!(summary.on_segments > 20 && summary.on_facets > 20, "{summary:?}");
}

#[test]
fn points_on_segments_are_named() {
    for direction in [Vec3::x(), -Vec3::y(), Vec3::new(1.0, -1.0, 0.0), Vec3::new(-0.5, 1.0, 0.25)] {
        for count in [0, 60] {
            let mut points = scatter(count);
            let n = points.len() as u32;
            points.extend([[7.0, 0.0, 9.0], [8.0, 0.0, 9.0], [8.0, 1.0, 9.0]].map(Point3::from));
            points.extend([-0.5, 0.0, 0.25].map(|share| Point3::new(0.5, 0.5, 0.5) + direction * share));
            let surface = TriMesh { points, triangles: vec![[n, n + 1, n + 2]] };
            let met = fills(&surface, &[[n + 3, n + 5]], InputKind::Plc).unwrap_err();
            assert_eq!(met, TetError::EdgeMeets { edge: [n + 3, n + 5], obstacle: Obstacle::Point(n + 4) });
        }
    }
}

#[test]
fn parts_that_meet_are_named() {
    let mut points = scatter(60);
    let n = points.len() as u32;
    for p in [[0.1, 0.1, 0.5], [0.9, 0.1, 0.5], [0.5, 0.9, 0.5], [0.5, 0.4, -0.1], [0.5, 0.4, 1.1]] {
        points.push(Point3::from(p));
    }
    let surface = TriMesh { points, triangles: vec![[n, n + 1, n + 2]] };
    let met = fills(&surface, &[[n + 3, n + 4]], InputKind::Plc).unwrap_err();
    let expected = TetError::EdgeMeets { edge: [n + 3, n + 4], obstacle: Obstacle::Triangle([n, n + 1, n + 2]) };
    assert_eq!(met, expected);
}
