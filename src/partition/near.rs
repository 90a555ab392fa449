//! Obstacles for the ends of a cluster: its vessels and the overruns beyond their terminals.

use super::clearance::tip_middle;
use super::params::PartitionParams;
use anastomesh_mesh::geometry::{Aabb, Bvh, Tube};
use anastomesh_skeleton::course::{Course, Courses, Way};

/// Obstacle: an edge of a branch, or the overrun beyond its terminal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Obstacle {
    pub branch: u32,
    pub kind: ObstacleKind,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum ObstacleKind {
    /// Edge with this index in the branch.
    Edge(u32),
    /// Overrun at the branch's start or end.
    Overrun(Way),
}

/// Maximum number of obstacles that are searched without a tree.
const FEW: usize = 48;

/// Maximum length of the straight run before an end plane, in radii ([`Course::run_start`]).
const LONGEST_RUN: f64 = 1.25;

/// Courses of some branches and the obstacles that they form.
pub(super) struct Near {
    /// Courses in ascending order of branch.
    courses: Vec<(u32, Course)>,
    obstacles: Vec<Obstacle>,
    boxes: Vec<Aabb>,
    tree: Option<Bvh>,
}

impl Near {
    /// Collects the obstacles of the given branches, which are in ascending order.
    pub fn new(
        all: Courses,
        terminals: &[[bool; 2]],
        branches: &[u32],
        params: &PartitionParams,
        blending: f64,
    ) -> Self {
        let courses: Vec<(u32, Course)> = branches.iter().map(|&branch| (branch, all.get(branch))).collect();
        let (mut obstacles, mut boxes) = (Vec::new(), Vec::new());
        for (branch, course) in &courses {
            let mut add = |kind: ObstacleKind, tube: &Tube| {
                obstacles.push(Obstacle { branch: *branch, kind });
                let r = tube.max_radius();
                // A straight end deviates from its edges by at most its own length or that of its overrun.
                let aside = params.overruns().length(r, r).max(LONGEST_RUN * r);
                boxes.push(Aabb::of_points([&tube.a, &tube.b]).grown(blending * r + aside));
            };
            for (i, [ra, rb]) in course.radii.iter().enumerate() {
                let tube = Tube { a: course.points[i], b: course.points[i + 1], ra: *ra, rb: *rb };
                add(ObstacleKind::Edge(i as u32), &tube);
            }
            for (end, terminal) in Way::BOTH.into_iter().zip(terminals[*branch as usize]) {
                if terminal {
                    add(ObstacleKind::Overrun(end), &terminal_overrun(course, end, params));
                }
            }
        }
        let tree = (boxes.len() > FEW).then(|| Bvh::new(&boxes));
        Self { courses, obstacles, boxes, tree }
    }

    /// Returns the course of one of the branches.
    pub fn course(&self, branch: u32) -> &Course {
        &self.courses[self.courses.partition_point(|(b, _)| *b < branch)].1
    }

    /// Calls `found` for all obstacles whose box overlaps `aabb`.
    pub fn query(&self, aabb: &Aabb, mut found: impl FnMut(&Obstacle)) {
        if let Some(tree) = &self.tree {
            return tree.query(aabb, |i| found(&self.obstacles[i as usize]));
        }
        let near = self.obstacles.iter().zip(&self.boxes).filter(|(_, other)| other.overlaps(aabb));
        near.for_each(|(obstacle, _)| found(obstacle));
    }
}

/// Returns the axis of the tip beyond a terminal, with the longest overrun allowed.
pub(super) fn terminal_overrun(course: &Course, end: Way, params: &PartitionParams) -> Tube {
    let s = if end == Way::Onward { course.length() } else { 0.0 };
    let section = course.section(s, end);
    let r = section.radius;
    let length = tip_middle(r, params.overruns().length(r, r));
    Tube { a: section.origin, b: section.origin + section.axis * length, ra: r, rb: r }
}
