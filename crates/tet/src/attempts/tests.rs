use super::*;
use crate::conform::box_corners;
use crate::input::validate;
use crate::optimize::Effort as Improvement;
use crate::options::{Interior, Sizing};
use crate::plc::InputKind;
use crate::progress::Watch;
use crate::survey::survey;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::shapes::sphere_surface;

/// Pipe along a tilted axis: `n` long strips outside and inside, with diagonals in the same direction all around.
fn pipe(n: u32) -> TriMesh {
    let mut s = TriMesh::default();
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, 0.7, 1.1);
    for (radius, z) in [(1.0, 0.0), (1.0, 30.0), (0.8, 0.0), (0.8, 30.0)] {
        s.points.extend((0..n).map(|i| {
            let w = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            turn * Point3::new(radius * libm::cos(w), radius * libm::sin(w), z)
        }));
    }
    let rings = [[0, 1], [3, 2], [1, 3], [2, 0]];
    for i in 0..n {
        let j = (i + 1) % n;
        for [below, above] in rings.map(|ring| ring.map(|r| r * n)) {
            s.triangles.extend([[below + i, below + j, above + j], [below + i, above + j, above + i]]);
        }
    }
    s
}

/// Calls `run` with a request for the whole of a surface.
fn with_request<T>(surface: &TriMesh, run: impl FnOnce(&Request) -> T) -> T {
    let edges = validate(surface, &[], InputKind::Closed).unwrap();
    run(&Request {
        surface,
        edges: &edges,
        segments: &[],
        kind: InputKind::Closed,
        baffles: 0,
        holes: &[],
        regions: &[],
        region: None,
        interior: &Interior::None,
        refinement: None,
        sizing: &Sizing::Surface,
        heights: &[],
        optimize: false,
        certify: true,
        spaced: false,
        sources: &[],
        spare_needles: true,
        effort: Improvement::default(),
        strict: true,
        max_tets: None,
        label: false,
        watch: &Watch::NOBODY,
    })
}

fn effort(left: u64) -> Effort {
    let last = TetError::NotRecovered { edges: Vec::new(), triangles: Vec::new() };
    Effort { left, last, fewest: usize::MAX, level_share: 1 }
}

#[test]
fn a_pipe_is_recovered_among_points_on_both_sides() {
    let surface = pipe(24);
    let mut points = surface.points.clone();
    points.extend(box_corners(&surface.points));
    with_request(&surface, |r| {
        let mut attempt = Attempt { filled: true, ..Attempt::fresh(None, &RecoveryStrategy::GIVEN) };
        let (mut c, _) = attempt.turn(r, &points, &mut effort(u64::MAX)).unwrap().unwrap();
        c.sanity_check().unwrap();
        assert_eq!(survey(&mut c, &surface, r.edges), (Vec::new(), Vec::new()));
    });
}

#[test]
fn the_scaffold_surrounds_the_surface_and_repeats_no_point() {
    let surface = sphere_surface(3);
    with_request(&surface, |r| {
        let first = sized::scaffold_points(r, &surface.points).unwrap();
        let radius = |p: &Point3| p.coords.norm();
        assert!(first.iter().any(|p| radius(p) < 0.9) && first.iter().any(|p| radius(p) > 1.05));
        assert_eq!(sized::scaffold_points(r, &first).unwrap(), Vec::new());
    });
}

#[test]
fn starts_take_turns_by_the_operations_spent() {
    with_request(&sphere_surface(1), |r| {
        let points = r.surface.points.clone();
        let once = operations(r, 1);
        let start = |spent, delay| {
            let complex = delaunay::delaunay_watched(&points, r.watch).unwrap();
            let missing = Missing { edges: &[], triangles: &[0] };
            Attempt { delay, spent, ..Attempt::given(r, points.len(), complex, missing, 0.0) }
        };
        // Few parts are left, so a quarter of the operations counts, with two strategies of the next turn.
        assert_eq!(start(6 * once, 5).claim(r, once), 5 + 2 * once);
        let fresh = Attempt { delay: 7, ..Attempt::fresh(None, &RecoveryStrategy::GIVEN) };
        assert_eq!(fresh.claim(r, once), 7 + once);
        // After a second failure the start is repeated with the same budget.
        let failed = Attempt { turns: 2, ..start(0, 0) };
        assert!(failed.repeats_start() && failed.share() == GROWTH);
        let again = Attempt { restarts: MAX_RESTARTS, ..failed };
        assert!(!again.repeats_start() && again.share() == GROWTH * GROWTH);
    });
}

#[test]
fn a_start_with_many_missing_parts_takes_its_first_turn() {
    let surface = pipe(24);
    with_request(&surface, |r| {
        let mut complex = delaunay::delaunay_watched(&surface.points, r.watch).unwrap();
        let (edges, triangles) = survey(&mut complex, &surface, r.edges);
        let missing = Missing { edges: &edges, triangles: &triangles };
        let mut attempt = Attempt::given(r, surface.points.len(), complex, missing, 0.0);
        assert!(attempt.missing() > HOPELESS);
        let mut effort = Effort { fewest: 1, ..effort(u64::MAX) };
        assert!(attempt.turn(r, &surface.points, &mut effort).unwrap().is_some());
    });
}
