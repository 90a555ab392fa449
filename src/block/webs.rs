//! Webs: narrow gaps between vessels of a cluster that touch beyond a bifurcation. Such a gap is a tunnel through the
//! wall, which then has a handle that no loop of the vessels explains. A tube in the gap closes it.

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
const FAR: f64 = 6.0;
/// Maximum width of a gap, in radii of the wider vessel beside it.
const WIDEST: f64 = 1.0;
/// Overlap of a web with the vessels on both sides, and distance of its points, in radii of the thinner vessel.
const OVERLAP: f64 = 0.35;
const STEP: f64 = 0.5;
/// Maximum number of points of a web.
const MOST_ROWS: usize = 64;
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

/// Webs in the narrow gaps between vessels of a cluster whose wall does not part them.
///
/// # Errors
/// [`Stop`] if the watch stops it.
pub(super) fn webs(wall: &TriMesh, cluster: &Cluster, watch: &Watch) -> Result<Webs, Stop> {
    let graph = Graph::of(&cluster.tubes);
    let mut walls = WallSearch::new(wall);
    let mut found = Vec::new();
    for (pair, points, radii) in touching(&cluster.tubes).into_iter().take(MOST_PAIRS) {
        watch.spend(cluster.tubes.len())?;
        found.extend(graph.course(pair, points, FAR * radii).and_then(|course| Web::between(&course, &mut walls)));
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
    /// Smaller and larger radius.
    thinner: f64,
    wider: f64,
}

impl Row {
    fn at(course: &Course, along: f64) -> Self {
        let ((p, rp), (q, rq)) = (course.at(along), course.at(course.length() - along));
        Self { ends: [p, q], gap: (q - p).norm() - rp - rq, thinner: rp.min(rq), wider: rp.max(rq) }
    }

    /// Point and radius of the web.
    fn web(&self) -> (Point3, f64) {
        let [p, q] = &self.ends;
        (nalgebra::center(p, q), 0.5 * self.gap.max(0.0) + OVERLAP * self.thinner)
    }
}

/// Tube in the middle of a gap: its points and radii.
struct Web {
    points: Vec<(Point3, f64)>,
    /// Largest width of the gap, in radii.
    width: f64,
}

impl Web {
    /// Web between both halves of a course along vessels, from one of two points that touch to the other. `None` if the wall
    /// parts these points, if it parts the halves nowhere, or if the gap is too wide.
    fn between(course: &Course, walls: &mut WallSearch) -> Option<Self> {
        let length = course.length();
        let step = STEP * course.points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        let count = ((0.5 * length / step).ceil() as usize).min(MOST_ROWS);
        let rows: Vec<Row> = (0..count).map(|i| Row::at(course, 0.5 * length * i as f64 / count as f64)).collect();
        let width = rows.iter().map(|row| row.gap / row.wider).fold(0.0, f64::max);
        if width > WIDEST {
            return None;
        }
        let open: Vec<bool> = rows.iter().map(|row| walls.is_parted(&row.ends[0], &row.ends[1])).collect();
        let (first, last) = (open.iter().position(|&o| o)?, open.iter().rposition(|&o| o)?);
        let points = || rows[first - 1..=(last + 1).min(count - 1)].iter().map(Row::web).collect();
        (first > 0).then(|| Self { points: points(), width })
    }

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

    fn wall(tubes: &[Tube]) -> TriMesh {
        let params = SurfaceParams { thin: 1.0, ..SurfaceParams::with_voxel(0.3) };
        vessel_wall(tubes, &params, &Finer::default(), &Watch::NOBODY).expect("a wall").mesh
    }

    #[test]
    fn a_narrow_gap_is_closed_and_a_wide_one_is_not() {
        for (height, is_closed) in [(1.4, true), (4.0, false)] {
            let cluster = eye(height);
            let open = wall(&cluster.tubes);
            assert_eq!(euler_characteristic(&open), 0, "height {height}");
            let webs = webs(&open, &cluster, &Watch::NOBODY).unwrap();
            assert_eq!(!webs.gaps.is_empty(), is_closed, "height {height}");
            if is_closed {
                let closed = wall(&[cluster.tubes, webs.tubes].concat());
                assert_eq!(euler_characteristic(&closed), 2);
            }
        }
    }
}
