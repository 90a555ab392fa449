//! Webs: narrow gaps between vessels of a cluster that touch beyond a bifurcation. Such a gap is a tunnel through the
//! wall, which then has a handle that no loop of the vessels explains. A tube in the gap closes it.
//!
//! In the crotch of a narrow bifurcation, the vessels separate slowly. Where the gap is about as wide as a voxel, the wall may
//! part, join and part again.

use super::faithful::WallSearch;
use super::graph::{Course, Graph};
use crate::partition::Cluster;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, point_tube, tube_tube};
use anastomesh_tet::parts::Watch;

/// Maximum distance of vessels that touch, in sums of their radii: their walls may blend.
const NEAR: f64 = 1.3;
/// Maximum length along the vessels between the two points that touch, in sums of the radii.
const FAR: f64 = 10.0;
/// Maximum width of a gap, in radii of the wider vessel beside it.
const WIDEST: f64 = 1.0;
/// Maximum length of a crotch, in radii at its bifurcation.
const CROTCH_LENGTH: f64 = 60.0;
/// Minimum cosine of the angle of a crotch.
const CROTCH_COSINE: f64 = 0.8;
/// Overlap of a web with the vessels on both sides, and distance of its points, in radii of the thinner vessel.
const OVERLAP: f64 = 0.35;
const STEP: f64 = 0.1;
/// Number of points of a web beyond the gap, on both sides.
const BEYOND: usize = 5;
/// Number of points of a web where the wall begins to part two vessels.
const AT_END: usize = 15;
/// Maximum number of points of a web.
const MOST_ROWS: usize = 1024;
/// Maximum number of pairs of vessels examined in a cluster.
const MOST_PAIRS: usize = 4096;
/// Maximum number of pairs of close vessels tested in a cluster.
const MOST_TESTED: usize = 1 << 20;

/// Tubes that close narrow gaps, and the place of each gap.
#[derive(Debug, Default)]
pub(super) struct Webs {
    pub tubes: Vec<Tube>,
    pub gaps: Vec<Point3>,
}

/// Gaps to close.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Gaps {
    /// Those that the wall encloses.
    Enclosed,
    /// Those that the wall encloses, without the outermost gap of each pair of vessels, which may belong to a loop of the vessels.
    Inner,
    /// The narrow ends of crotches, where the wall begins to part the vessels.
    Ends,
}

/// Webs in the narrow gaps between vessels of a cluster.
///
/// # Errors
/// [`Stop`] if the watch stops it.
pub(super) fn webs(wall: &TriMesh, cluster: &Cluster, gaps: Gaps, watch: &Watch) -> Result<Webs, Stop> {
    let graph = Graph::of(&cluster.tubes);
    let mut walls = WallSearch::new(wall);
    let spare = gaps == Gaps::Inner;
    let mut found = Vec::new();
    let pairs = if gaps == Gaps::Ends { Vec::new() } else { touching(&cluster.tubes) };
    for (pair, points, radii) in pairs.into_iter().take(MOST_PAIRS) {
        watch.spend(cluster.tubes.len())?;
        let course = graph.course(pair, points, FAR * radii);
        found.extend(course.and_then(|course| Slit::along(&course, &mut walls).web(spare)));
    }
    let mut ends = Vec::new();
    for course in crotches(&graph) {
        watch.spend(MOST_ROWS)?;
        let slit = Slit::along(&course, &mut walls);
        found.extend(slit.web(spare).filter(|_| gaps != Gaps::Ends));
        ends.extend(slit.end());
    }
    if found.is_empty() {
        // The wall joins at less than a step, or beside the middle.
        found = ends;
    }
    found.sort_by(|a, b| a.width.total_cmp(&b.width));
    let mut webs = Webs::default();
    for web in found {
        if !web.is_within(&webs.tubes) {
            webs.gaps.push(web.points[web.points.len() / 2].0);
            webs.tubes.extend(web.tubes());
        }
    }
    Ok(webs)
}

/// Courses through bifurcations: equal lengths of two vessels that leave a node at a small angle.
fn crotches(graph: &Graph) -> Vec<Course> {
    let mut found = Vec::new();
    for (node, beside) in graph.beside.iter().enumerate().filter(|(_, beside)| beside.len() > 2) {
        for (i, &e) in beside.iter().enumerate() {
            for &f in &beside[..i] {
                let tubes = [f, e].map(|tube| graph.from(tube, node as u32));
                let [u, v] = tubes.each_ref().map(|tube| tube.b - tube.a);
                if u.dot(&v) > CROTCH_COSINE * u.norm() * v.norm() {
                    let limit = CROTCH_LENGTH * tubes[0].ra.max(tubes[1].ra);
                    found.push(graph.fork([f, e], node as u32, limit));
                }
            }
        }
    }
    found
}

/// Pairs of tubes that touch and share no end, with the closest points on their axes and the sum of the radii there. Pairs
/// that are closer, relative to their radii, come first.
fn touching(tubes: &[Tube]) -> Vec<([u32; 2], [Point3; 2], f64)> {
    let boxes = tubes.iter().map(|tube| {
        let reach = NEAR * tube.max_radius();
        Aabb::of_points([&tube.a, &tube.b]).grown(reach)
    });
    let (mut found, mut tested) = (Vec::new(), 0);
    Bvh::of(boxes.collect::<Vec<Aabb>>()).self_pairs(|i, j| {
        tested += 1;
        if tested > MOST_TESTED {
            return;
        }
        let [first, second] = [i, j].map(|k| &tubes[k as usize]);
        if [first.a, first.b].iter().any(|p| [second.a, second.b].contains(p)) {
            return;
        }
        let near = tube_tube(first, second);
        let points = [first.point(near.s), second.point(near.t)];
        let radii = first.radius(near.s) + second.radius(near.t);
        let distance = (points[1] - points[0]).norm();
        if distance < NEAR * radii {
            found.push((
                [i.min(j), i.max(j)],
                if i < j { points } else { [points[1], points[0]] },
                radii,
                distance / radii,
            ));
        }
    });
    found.sort_unstable_by(|p, q| p.3.total_cmp(&q.3).then(p.0.cmp(&q.0)));
    found.into_iter().map(|(pair, points, radii, _)| (pair, points, radii)).collect()
}

/// Two points at equal distances from both ends of a course.
struct Row {
    ends: [Point3; 2],
    /// Distance between the tubes at the two points; negative if they overlap.
    gap: f64,
    /// Radii at the two points.
    radii: [f64; 2],
}

impl Row {
    fn at(course: &Course, along: f64) -> Self {
        let ((p, rp), (q, rq)) = (course.at(along), course.at(course.length() - along));
        Self { ends: [p, q], gap: (q - p).norm() - rp - rq, radii: [rp, rq] }
    }

    /// Width of the gap in radii of the wider vessel.
    fn width(&self) -> f64 {
        self.gap / self.radii[0].max(self.radii[1])
    }

    /// Point and radius of the web, in the middle of the gap.
    fn web(&self) -> (Point3, f64) {
        let [p, q] = &self.ends;
        let [rp, rq] = self.radii;
        let across = (q - p).try_normalize(0.0).unwrap_or_default();
        let middle = nalgebra::center(&(p + rp * across), &(q - rq * across));
        (middle, 0.5 * self.gap.max(0.0) + OVERLAP * rp.min(rq))
    }
}

/// Both halves of a course along vessels, from a point on one vessel to a point on another, where they are close.
struct Slit {
    rows: Vec<Row>,
    /// True where the wall parts them.
    open: Vec<bool>,
}

impl Slit {
    fn along(course: &Course, walls: &mut WallSearch) -> Self {
        let length = course.length();
        let step = STEP * course.points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        let count = ((0.5 * length / step).ceil() as usize).min(MOST_ROWS);
        let rows = (0..count).map(|i| Row::at(course, 0.5 * length * i as f64 / count as f64));
        // Where the vessels are further apart at first, they are separate.
        let rows: Vec<Row> = rows.skip_while(|row| row.width() > WIDEST).collect();
        let open = rows.iter().map(|row| walls.is_parted(&row.ends[0], &row.ends[1])).collect();
        Self { rows, open }
    }

    /// Web that covers the places where the wall parts the halves, from the first place on where it does not. With `spare`, from
    /// the second such place on, after the outermost gap. `None` without such places, or if the gap is too wide between them.
    fn web(&self, spare: bool) -> Option<Web> {
        let next = |from: usize, is_open: bool| Some(from + self.open[from..].iter().position(|&o| o == is_open)?);
        let first = next(next(0, false)?, true)?;
        let first = if spare { next(next(first, false)?, true)? } else { first };
        self.covered(first, self.last()?)
    }

    /// Web at the place where the wall begins to part the halves.
    fn end(&self) -> Option<Web> {
        let last = self.last()?;
        self.covered(last.saturating_sub(AT_END), last)
    }

    /// Last place at which the wall parts the halves.
    fn last(&self) -> Option<usize> {
        self.open.iter().rposition(|&is_open| is_open)
    }

    fn covered(&self, first: usize, last: usize) -> Option<Web> {
        let covered = &self.rows[first.saturating_sub(BEYOND)..(last + BEYOND).min(self.rows.len())];
        let width = covered.iter().map(Row::width).fold(0.0, f64::max);
        let points = || covered.iter().map(Row::web).collect();
        (width <= WIDEST).then(|| Web { points: points(), width })
    }
}

/// Tube in the middle of a gap: its points and radii.
struct Web {
    points: Vec<(Point3, f64)>,
    /// Largest width of the gap, in radii.
    width: f64,
}

impl Web {
    /// True if other webs cover its points.
    fn is_within(&self, others: &[Tube]) -> bool {
        let is_covered = |p: &Point3| others.iter().any(|tube| point_tube(p, tube).1 < 0.0);
        self.points.iter().all(|(p, _)| is_covered(p))
    }

    fn tubes(&self) -> impl Iterator<Item = Tube> + '_ {
        self.points.windows(2).map(|w| Tube { a: w[0].0, b: w[1].0, ra: w[0].1, rb: w[1].1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Finer, SurfaceParams, euler_characteristic, vessel_wall};

    /// Two branches of radius 1 that leave a bifurcation, part by a gap, and touch again.
    fn eye(height: f64) -> Cluster {
        let tube = |a: [f64; 2], b: [f64; 2]| Tube {
            a: Point3::new(a[0], a[1], 0.0),
            b: Point3::new(b[0], b[1], 0.0),
            ra: 1.0,
            rb: 1.0,
        };
        let mut tubes = vec![tube([-8.0, 0.0], [0.0, 0.0])];
        for side in [-1.0, 1.0] {
            let course = [[0.0, 0.0], [2.5, side * height], [5.0, side * 0.8], [7.0, side * 4.0], [12.0, side * 9.0]];
            tubes.extend(course.windows(2).map(|w| tube(w[0], w[1])));
        }
        Cluster { tubes, ..Cluster::default() }
    }

    fn wall(tubes: &[Tube], voxel: f64) -> TriMesh {
        let params = SurfaceParams { thin: 1.0, ..SurfaceParams::with_voxel(voxel) };
        vessel_wall(tubes, &params, &Finer::default(), &Watch::NOBODY).expect("a wall").mesh
    }

    #[test]
    fn a_narrow_gap_is_closed_and_a_wide_one_is_not() {
        for (height, is_closed) in [(1.4, true), (4.0, false)] {
            let cluster = eye(height);
            let open = wall(&cluster.tubes, 0.3);
            assert_eq!(euler_characteristic(&open), 0, "height {height}");
            let webs = webs(&open, &cluster, Gaps::Enclosed, &Watch::NOBODY).unwrap();
            assert_eq!(!webs.gaps.is_empty(), is_closed, "height {height}");
            if is_closed {
                let closed = wall(&[cluster.tubes, webs.tubes].concat(), 0.3);
                assert_eq!(euler_characteristic(&closed), 2);
            }
        }
    }

    /// Two branches of radii 1 and 1.2 that leave a trunk at 7 degrees. The trunk comes from a direction in degrees.
    fn narrow_fork(direction: f64) -> Cluster {
        let tube = |angle: f64, length: f64, radius: f64| {
            let (y, x) = libm::sincos((direction + angle).to_radians());
            Tube { a: Point3::origin(), b: Point3::new(length * x, length * y, 0.0), ra: radius, rb: radius }
        };
        Cluster {
            tubes: vec![tube(0.0, 9.0, 1.4), tube(177.0, 40.0, 1.0), tube(184.0, 40.0, 1.2)],
            ..Cluster::default()
        }
    }

    /// Some of these walls part, join and part again.
    #[test]
    fn crotches_of_narrow_bifurcations_are_closed() {
        let mut with_handles = 0;
        for direction in (0..36).map(|i| 5.0 * f64::from(i)) {
            let cluster = narrow_fork(direction);
            let open = wall(&cluster.tubes, 0.67);
            let webs = webs(&open, &cluster, Gaps::Enclosed, &Watch::NOBODY).unwrap();
            let has_handle = euler_characteristic(&open) < 2;
            with_handles += usize::from(has_handle);
            let closed = wall(&[cluster.tubes, webs.tubes].concat(), 0.67);
            assert_eq!(euler_characteristic(&closed), 2, "{direction}°");
        }
        assert!(with_handles > 0);
    }

    /// A loop of two long vessels and a short one: its hole must stay, but not the further ones in its narrow end.
    #[test]
    fn the_hole_of_a_narrow_loop_stays() {
        let mut with_handles = 0;
        for direction in (0..36).map(|i| 5.0 * f64::from(i)) {
            let place = |angle: f64, length: f64| {
                let (y, x) = libm::sincos((direction + angle).to_radians());
                Point3::new(length * x, length * y, 0.0)
            };
            let [apex, left, right] = [Point3::origin(), place(-5.0, 24.0), place(5.0, 24.0)];
            let ends =
                [(apex, left), (apex, right), (left, right), (apex, place(180.0, 9.0)), (left, place(-9.0, 40.0))];
            let tubes = ends.iter().map(|&(a, b)| Tube { a, b, ra: 1.0, rb: 1.0 }).collect();
            let cluster = Cluster { tubes, ..Cluster::default() };
            let open = wall(&cluster.tubes, 0.67);
            if euler_characteristic(&open) == 0 {
                continue;
            }
            with_handles += 1;
            let webs = webs(&open, &cluster, Gaps::Inner, &Watch::NOBODY).unwrap();
            let closed = wall(&[cluster.tubes, webs.tubes].concat(), 0.67);
            assert_eq!(euler_characteristic(&closed), 0, "{direction}°");
        }
        assert!(with_handles > 0);
    }
}
