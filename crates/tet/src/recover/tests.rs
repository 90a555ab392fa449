//! Tests of the recovery by flips.

use super::exact::shapes::twisted_prism;
use super::*;
use crate::conform;
use crate::delaunay::delaunay;
use crate::input::validate;
use crate::plc::InputKind;
use crate::progress::Progress;
use crate::turned_tests::{Rng, plate, turned};
use anastomesh_mesh::geometry::Vec3;
use std::sync::Mutex;

/// The complex of a surface's points in a box, and its edges.
fn start(surface: &TriMesh) -> (Complex, SurfaceEdges) {
    let mut points = surface.points.clone();
    points.extend(conform::box_corners(&surface.points));
    (delaunay(&points).unwrap(), validate(surface, &[], InputKind::Closed).unwrap())
}

#[test]
fn counts_of_parts_are_added() {
    let counts = |[missing_edges, missing_triangles, steiner_points]: [usize; 3]| RecoverySummary {
        missing_edges,
        missing_triangles,
        steiner_points,
    };
    let mut sum = counts([1, 2, 3]);
    sum.add(&counts([10, 20, 40]));
    assert_eq!(sum, counts([11, 22, 43]));
}

#[test]
fn only_parts_of_the_surface_are_obstacles() {
    let surface = twisted_prism(4, 0.3, 1.0);
    let (mut c, edges) = start(&surface);
    survey(&mut c, &surface, &edges);
    let halves = 4 * c.slots() as u32;
    let frozen = (0..halves).find(|&half| c.is_frozen(half)).unwrap();
    let other = (0..halves).find(|&half| c.is_alive(half >> 2) && !c.is_frozen(half)).unwrap();
    let face = c.face(frozen);
    let r = Recovery::new(&mut c, &surface, (&edges, Rule::Positive), &Watch::NOBODY);
    assert_eq!(r.obstacle(Crossing::Face(frozen)), Some(Obstacle::Triangle(face)));
    assert_eq!(r.obstacle(Crossing::Face(other)), None);
    assert_eq!(r.obstacle(Crossing::Edge(0, 0, 1)), Some(Obstacle::Edge([0, 1])));
    assert_eq!(r.obstacle(Crossing::Edge(0, 0, 6)), None);
    assert_eq!([0, 7, 8].map(|v| r.obstacle(Crossing::Vertex(v)).is_some()), [true, true, false]);
    assert_eq!([r.obstacle(Crossing::Exists), r.obstacle(Crossing::Nothing)], [None; 2]);
}

#[test]
fn recovered_parts_are_reported_as_progress() {
    #[derive(Default)]
    struct Reports(Mutex<Vec<(u64, u64)>>);
    impl Progress for Reports {
        fn at(&self, _: Stage, done: u64, total: u64) {
            self.0.lock().unwrap().push((done, total));
        }
    }
    let mut rng = Rng(7);
    let surface = plate(240, 0.2, &mut rng);
    let surface = turned(surface, &mut rng);
    let (mut c, edges) = start(&surface);
    let (lost_edges, lost_triangles) = survey(&mut c, &surface, &edges);
    let all = (lost_edges.len() + lost_triangles.len()) as u64;
    let mut left = lost_edges.clone();
    Recovery::new(&mut c.clone(), &surface, (&edges, Rule::Positive), &Watch::NOBODY).recover_edges(&mut left);
    let done = (lost_edges.len() - left.len()) as u64;
    assert!(done > 300 && !left.is_empty());
    let reports = Reports::default();
    recover(&mut c, &surface, &edges, Rule::Positive, &Watch::of(&reports)).unwrap_or_default();
    let reports = reports.0.into_inner().unwrap();
    assert_eq!(reports[..2], [(0, all), (done, all)]);
    assert!(reports.is_sorted() && reports.iter().all(|&(done, total)| done <= total && total == all));
}

#[test]
fn flips_that_leave_much_are_followed_by_no_points() {
    let adds_points = |surface: &TriMesh| {
        let (mut c, edges) = start(surface);
        let before = c.points.len();
        // The points need not suffice.
        recover(&mut c, surface, &edges, Rule::Positive, &Watch::NOBODY).ok();
        c.points.len() > before
    };
    // Prisms in a row, of which none is a union of tetrahedra without further points: flips leave half of the missing parts.
    let prisms = |count: u32| {
        let mut surface = TriMesh::default();
        for k in 0..count {
            let TriMesh { points, triangles } = twisted_prism(3, -0.5, 1.0);
            let first = surface.points.len() as u32;
            surface.points.extend(points.iter().map(|p| p + Vec3::new(5.0 * f64::from(k), 0.0, 0.0)));
            surface.triangles.extend(triangles.iter().map(|t| t.map(|v| v + first)));
        }
        surface
    };
    assert_eq!([4, 120].map(|count| adds_points(&prisms(count))), [true, false]);
    // Flips leave 166 of 1172.
    assert!(adds_points(&plate(240, 0.2, &mut Rng(7))));
}

#[test]
fn flips_are_abandoned_where_rounding_has_turned_planes() {
    let tried = |surface: &TriMesh, rule: Rule| {
        let (mut c, edges) = start(surface);
        let (mut lost, _) = survey(&mut c, surface, &edges);
        assert!(lost.len() > 3 * MANY);
        let mut r = Recovery::new(&mut c, surface, (&edges, rule), &Watch::NOBODY);
        let is_turned = r.is_turned(&lost);
        (is_turned, r.recover_edges(&mut lost), lost.len() < 10)
    };
    let mut rng = Rng(7);
    let flat = plate(240, 0.2, &mut rng);
    let steep = turned(flat.clone(), &mut rng);
    let thick = Rule::Thick(flat_height(&steep.points));
    assert_eq!(tried(&steep, thick), (true, true, false));
    assert_eq!(tried(&steep, Rule::Positive), (true, false, true));
    assert_eq!(tried(&flat, thick), (false, false, false));
}
