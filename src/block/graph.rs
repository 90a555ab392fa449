//! Graph of a cluster's tubes, and shortest ways along them.

use anastomesh_mesh::geometry::{DisjointSets, Point3, Total, Tube, place_key, point_segment};
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Graph with tubes as edges.
pub(super) struct Graph<'a> {
    pub tubes: &'a [Tube],
    pub places: Vec<Point3>,
    /// End nodes of each tube.
    pub ends: Vec<[u32; 2]>,
    /// Tubes at each node.
    pub beside: Vec<Vec<u32>>,
    /// Tubes that close a loop, one for each independent loop.
    pub closing: Vec<u32>,
}

impl<'a> Graph<'a> {
    pub(super) fn of(tubes: &'a [Tube]) -> Self {
        let mut numbers: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        let mut sets = DisjointSets::new(0);
        let mut graph = Self { tubes, places: Vec::new(), ends: Vec::new(), beside: Vec::new(), closing: Vec::new() };
        for (tube, number) in tubes.iter().zip(0..) {
            let ends = [&tube.a, &tube.b].map(|p| {
                *numbers.entry(place_key(p)).or_insert_with(|| {
                    graph.places.push(*p);
                    graph.beside.push(Vec::new());
                    sets.push()
                })
            });
            graph.ends.push(ends);
            for end in ends {
                graph.beside[end as usize].push(number);
            }
            if sets.root(ends[0]) != sets.root(ends[1]) {
                sets.join(ends[0], ends[1]);
            } else if ends[0] != ends[1] {
                graph.closing.push(number);
            }
        }
        graph
    }

    /// Tubes of the shortest path between two nodes that avoids one tube (Dijkstra's algorithm).
    pub(super) fn way(&self, from: u32, to: u32, without: u32) -> Option<Vec<u32>> {
        let mut came_by: Vec<Option<u32>> = vec![None; self.places.len()];
        let mut heap = BinaryHeap::from([Reverse((Total(0.0), from, without))]);
        while let Some(Reverse((Total(distance), place, by))) = heap.pop() {
            if came_by[place as usize].is_some() {
                continue;
            }
            came_by[place as usize] = Some(by);
            if place == to {
                break;
            }
            for &tube in self.beside[place as usize].iter().filter(|&&tube| tube != without) {
                let length = self.tubes[tube as usize].length();
                heap.push(Reverse((Total(distance + length), self.other(tube, place), tube)));
            }
        }
        let (mut way, mut place) = (Vec::new(), to);
        while place != from {
            let tube = came_by[place as usize]?;
            way.push(tube);
            place = self.other(tube, place);
        }
        Some(way)
    }

    /// Shortest way along tubes from a point on one to a point on another. `None` if it is longer than `limit`.
    pub(super) fn course(&self, pair: [u32; 2], points: [Point3; 2], limit: f64) -> Option<Course> {
        let radius = |k: usize| {
            let tube = &self.tubes[pair[k] as usize];
            tube.radius(point_segment(&points[k], &tube.a, &tube.b).0)
        };
        let ends = pair.map(|tube| self.ends[tube as usize]);
        let between = |from: u32, to: u32| {
            let mut course = vec![(points[0], radius(0))];
            let mut place = to;
            let mut way = Vec::new();
            for tube in if from == to { Vec::new() } else { self.way(from, to, pair[0])? } {
                let Tube { a, b, ra, rb } = self.from(tube, place);
                way.extend([(a, ra), (b, rb)]);
                place = self.other(tube, place);
            }
            course.extend(way.into_iter().rev());
            course.push((points[1], radius(1)));
            Some(Course::new(course)).filter(|course| course.length() <= limit)
        };
        let all = ends[0].iter().flat_map(|&from| ends[1].map(|to| (from, to)));
        all.filter_map(|(from, to)| between(from, to)).min_by(|p, q| p.length().total_cmp(&q.length()))
    }

    /// Course from a point on one vessel of a node to a point on another. Both are as far from the node as the shorter vessel is
    /// long, at most by `limit`.
    pub(super) fn fork(&self, tubes: [u32; 2], node: u32, limit: f64) -> Course {
        let [first, second] = tubes.map(|tube| self.vessel(tube, node));
        let length = first.length().min(second.length()).min(limit);
        let mut points = first.until(length);
        points.reverse();
        points.extend(&second.until(length)[1..]);
        Course::new(points)
    }

    /// Vessel from a node up to the next node without exactly two tubes.
    fn vessel(&self, mut tube: u32, node: u32) -> Course {
        let mut place = node;
        let start = self.from(tube, node);
        let mut points = vec![(start.a, start.ra)];
        loop {
            let piece = self.from(tube, place);
            points.push((piece.b, piece.rb));
            place = self.other(tube, place);
            let beside = &self.beside[place as usize];
            // A ring ends where it began.
            if beside.len() != 2 || place == node {
                return Course::new(points);
            }
            tube = beside[usize::from(beside[0] == tube)];
        }
    }

    /// A tube, from one of its end nodes.
    pub(super) fn from(&self, tube: u32, node: u32) -> Tube {
        let Tube { a, b, ra, rb } = self.tubes[tube as usize];
        if self.ends[tube as usize][0] == node { Tube { a, b, ra, rb } } else { Tube { a: b, b: a, ra: rb, rb: ra } }
    }

    fn other(&self, tube: u32, place: u32) -> u32 {
        let [a, b] = self.ends[tube as usize];
        if a == place { b } else { a }
    }
}

/// Way along vessels: points with radii, and their distances from its start.
pub(super) struct Course {
    pub points: Vec<(Point3, f64)>,
    along: Vec<f64>,
}

impl Course {
    fn new(points: Vec<(Point3, f64)>) -> Self {
        let mut along = vec![0.0];
        for w in points.windows(2) {
            along.push(along[along.len() - 1] + (w[1].0 - w[0].0).norm());
        }
        Self { points, along }
    }

    pub(super) fn length(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    /// Points up to a distance from the start.
    fn until(&self, distance: f64) -> Vec<(Point3, f64)> {
        let inner = self.along.partition_point(|&a| a < distance).max(1);
        let mut points = self.points[..inner].to_vec();
        points.push(self.at(distance));
        points
    }

    /// Point and radius at a distance from the start.
    pub(super) fn at(&self, distance: f64) -> (Point3, f64) {
        let i = self.along.partition_point(|&a| a < distance).clamp(1, self.points.len() - 1);
        let span = self.along[i] - self.along[i - 1];
        let t = if span > 0.0 { ((distance - self.along[i - 1]) / span).clamp(0.0, 1.0) } else { 0.0 };
        let ((p, rp), (q, rq)) = (self.points[i - 1], self.points[i]);
        (p + (q - p) * t, rp + (rq - rp) * t)
    }
}
