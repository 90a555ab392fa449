//! Loops of a cluster's vessels. A loop within its own lumen is filled and creates no handle.

use super::graph::Graph;
use crate::partition::Cluster;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Tube, point_segment};
use anastomesh_tet::parts::Watch;

/// Maximum distance from the vessels, in radii, of points that a filled loop spans. Further away there is a hole;
/// closer walls blend.
const WITHIN: f64 = 1.25;
/// Sampling step of the spanned area, in smallest radii of the loop.
const STEP: f64 = 0.5;
/// Maximum samples per triangle side.
const MOST: f64 = 64.0;
/// Maximum number of loops examined in one cluster.
const MOST_LOOPS: usize = 64;
/// Tubes tested in the time of an operation of the budget, as half of them are tested on average.
const TUBES_PER_OPERATION: usize = 16;

/// Independent loops in the graph of a cluster's tubes. Equal end points are one node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Loops {
    /// Number of all loops.
    pub all: i64,
    /// Expected handles of the wall: as many as it has, if only loops are missing that their own lumen may fill.
    pub expected: i64,
}

impl Loops {
    /// Loops of a cluster whose wall has this number of handles.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub fn of(cluster: &Cluster, handles: i64, watch: &Watch) -> Result<Self, Stop> {
        let graph = Graph::of(&cluster.tubes);
        let all = graph.closing.len() as i64;
        let missing = all - handles;
        // No other number of handles depends on what is filled.
        if !(1..=MOST_LOOPS as i64).contains(&missing) {
            return Ok(Self { all, expected: all });
        }
        let mut filled = 0;
        for &tube in graph.closing.iter().take(MOST_LOOPS) {
            filled += i64::from(graph.is_filled(tube, watch)?);
            if filled == missing {
                return Ok(Self { all, expected: handles });
            }
        }
        Ok(Self { all, expected: all })
    }
}

impl Graph<'_> {
    /// True if the shortest loop through a tube spans only lumen.
    fn is_filled(&self, tube: u32, watch: &Watch) -> Result<bool, Stop> {
        let [a, b] = self.ends[tube as usize];
        watch.spend(self.places.len())?;
        let Some(mut around) = self.way(a, b, tube) else { return Ok(false) };
        around.push(tube);
        let vessels: Vec<&Tube> = around.iter().map(|&t| &self.tubes[t as usize]).collect();
        let length: f64 = vessels.iter().map(|t| t.length()).sum();
        let mut center = nalgebra::Vector3::zeros();
        for tube in &vessels {
            center += (tube.a.coords + tube.b.coords) * (0.5 * tube.length() / length);
        }
        let step = STEP * vessels.iter().map(|t| t.min_radius()).fold(f64::INFINITY, f64::min);
        for tube in &vessels {
            if !self.holds([&center.into(), &tube.a, &tube.b], step, watch)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// True if a triangle lies within the tubes, up to `WITHIN`.
    fn holds(&self, [a, b, c]: [&Point3; 3], step: f64, watch: &Watch) -> Result<bool, Stop> {
        let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let count = (longest / step).ceil().clamp(1.0, MOST) as u32;
        let share = |k: u32| f64::from(k) / f64::from(count);
        let is_within = |point: &Point3| {
            self.tubes.iter().any(|tube| {
                let (t, distance) = point_segment(point, &tube.a, &tube.b);
                distance <= WITHIN * tube.radius(t)
            })
        };
        for i in 0..=count {
            watch.spend((count - i + 1) as usize * self.tubes.len() / TUBES_PER_OPERATION)?;
            if !(0..=count - i).all(|j| is_within(&(a + (b - a) * share(i) + (c - a) * share(j)))) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::budget::Budget;
    use std::f64::consts::TAU;

    /// A ring of this radius of vessels with radius 1, with a vessel that leaves it.
    fn ring(radius: f64) -> Cluster {
        let at = |i: u32| {
            let angle = TAU * f64::from(i % 12) / 12.0;
            Point3::new(radius * libm::cos(angle), radius * libm::sin(angle), 0.0)
        };
        let tube = |a, b| Tube { a, b, ra: 1.0, rb: 1.0 };
        let mut tubes: Vec<Tube> = (0..12).map(|i| tube(at(i), at(i + 1))).collect();
        tubes.push(tube(at(0), Point3::new(radius + 9.0, 0.0, 0.0)));
        Cluster { tubes, ..Cluster::default() }
    }

    #[test]
    fn a_loop_within_its_lumen_may_be_filled_and_no_other() {
        for (radius, filled) in [(0.9, 1), (1.2, 1), (1.6, 0), (5.0, 0)] {
            let of = |handles| Loops::of(&ring(radius), handles, &Watch::NOBODY).unwrap();
            assert!([0, 1, 2].into_iter().all(|handles| of(handles).all == 1));
            assert_eq!([0, 1, 2].map(|handles| of(handles).expected), [1 - filled, 1, 1], "radius {radius}");
        }
        let mut two = ring(1.0);
        two.tubes.extend(ring(6.0).tubes);
        let of = |handles| Loops::of(&two, handles, &Watch::NOBODY).unwrap();
        assert_eq!([0, 1, 2, 3].map(|handles| of(handles).expected), [2, 1, 2, 2]);
        let budget = Budget::new(10);
        let stopped = Loops::of(&two, 1, &Watch::NOBODY.within(&budget));
        assert!(matches!(stopped, Err(Stop::OverBudget(_))));
    }

    #[test]
    fn operations_are_counted() {
        let spent = |radius: f64| {
            let budget = Budget::new(1 << 40);
            Loops::of(&ring(radius), 0, &Watch::NOBODY.within(&budget)).unwrap();
            budget.spent()
        };
        assert_eq!([0.9, 1.2, 5.0].map(spent), [49, 85, 21]);
    }

    #[test]
    fn loops_are_filled_in_any_place_and_unit() {
        for (radius, filled) in [(1.2, true), (1.6, false)] {
            let mut moved = ring(radius);
            for tube in &mut moved.tubes {
                let place = |p: Point3| Point3::new(8.0 * p.x + 70.0, 8.0 * p.y - 30.0, 8.0 * p.z + 50.0);
                *tube = Tube { a: place(tube.a), b: place(tube.b), ra: 8.0 * tube.ra, rb: 8.0 * tube.rb };
            }
            let loops = Loops::of(&moved, 0, &Watch::NOBODY).unwrap();
            assert_eq!(loops.expected, 1 - i64::from(filled), "radius {radius}");
        }
    }

    #[test]
    fn a_hole_away_from_the_centre_of_its_loop_is_found() {
        // Two runs side by side, whose lumens touch, and a bend of this radius around a hole.
        let expected = |bend: f64| {
            let side = |sign: f64| {
                let run = (0..10).map(move |i| Point3::new(-24.0 + 2.4 * f64::from(i), 0.4 * sign, 0.0));
                run.chain((1..8).map(move |i| {
                    let angle = std::f64::consts::PI * (1.0 - f64::from(i) / 8.0);
                    Point3::new(bend * (1.0 + libm::cos(angle)), sign * bend * libm::sin(angle), 0.0)
                }))
            };
            let mut points: Vec<Point3> = side(1.0).collect();
            points.push(Point3::new(2.0 * bend, 0.0, 0.0));
            points.extend(side(-1.0).collect::<Vec<_>>().into_iter().rev());
            let ends = points.iter().zip(points.iter().cycle().skip(1));
            let tubes = ends.map(|(&a, &b)| Tube { a, b, ra: 1.0, rb: 1.0 }).collect();
            Loops::of(&Cluster { tubes, ..Cluster::default() }, 0, &Watch::NOBODY).unwrap().expected
        };
        assert_eq!([0.9, 1.2, 2.0, 4.0].map(expected), [0, 0, 1, 1]);
    }
}
