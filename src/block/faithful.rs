//! Comparison of a wall with its vessels: axes lie inside, and separate vessels have separate lumens.
//!
//! The genus is not sufficient. A tight helix that fuses to a column has genus 0, and so has a wall that omits half a
//! vessel.

use crate::partition::Cluster;
use crate::surface::Field;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, crossing, place_key};
use anastomesh_skeleton::{CrotchRule, CrotchSearch, Edge, LocalDistances, Node, NodeId, Overlap, Skeleton};
use anastomesh_tet::parts::{Counter, Watch};
use rustc_hash::FxHashMap;

/// Sampling step along an axis, in radii.
const STEP: f64 = 2.0;
/// Maximum samples per tube.
const MOST: f64 = 8.0;
/// Maximum distance at which vessels fuse, in sums of their radii.
const NEAR: f64 = 1.3;
/// Minimum distance along the vessels for fusion, in sums of radii widened by `NEAR`: about 12 radii.
const FAR: f64 = 4.5;
/// Maximum number of pairs of vessels for which the wall is searched without a tree.
const FEW: usize = 8;
/// Operations per pair of close vessels, as counted by budgets.
const PER_PAIR: usize = 20;
/// Maximum distance form of the field deep in a lumen. The wall is where it is 1, so that vessels with such a lumen between them are
/// joined whatever the grid.
const DEEP: f64 = 0.6;
/// Number of steps between two axes in which the field is sampled.
const SAMPLES: u8 = 16;

/// Deviations of a wall from its vessels; empty unless they are allowed.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Astray {
    /// Point of an axis outside the wall.
    pub outside: Option<Point3>,
    /// Two points on axes that are distant along the vessels, with no wall between them.
    pub fused: Option<[Point3; 2]>,
}

impl Astray {
    /// Compares a wall with the vessels of its cluster.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub(super) fn of(wall: &TriMesh, cluster: &Cluster, watch: &Watch) -> Result<Self, Stop> {
        Ok(Self { outside: outside(wall, cluster, watch)?, fused: fused(wall, cluster, watch)? })
    }
}

/// First sample on a cluster's axes that lies outside its wall.
fn outside(wall: &TriMesh, cluster: &Cluster, watch: &Watch) -> Result<Option<Point3>, Stop> {
    let mut places = places(cluster);
    places.sort_by(|p, q| p.y.total_cmp(&q.y));
    let mut winding = vec![0_i32; places.len()];
    let mut on_wall = vec![false; places.len()];
    let mut counter = Counter::new(watch);
    for triangle in &wall.triangles {
        let [a, b, c] = triangle.map(|v| &wall.points[v as usize]);
        let [low, high] = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
        let first = places.partition_point(|p| p.y < low);
        for (i, p) in places.iter().enumerate().skip(first).take_while(|(_, p)| p.y <= high) {
            counter.add(1)?;
            // Rays run along x.
            if p.x > a.x.max(b.x).max(c.x) || p.z < a.z.min(b.z).min(c.z) || p.z > a.z.max(b.z).max(c.z) {
                continue;
            }
            match crossing(p, [a, b, c]) {
                Some(turn) => winding[i] += turn,
                None => on_wall[i] = true,
            }
        }
    }
    counter.end()?;
    Ok((0..places.len()).find(|&i| winding[i] != 1 || on_wall[i]).map(|i| places[i]))
}

/// Sample points on the axes of a cluster, up to its ends.
fn places(cluster: &Cluster) -> Vec<Point3> {
    let mut places = Vec::with_capacity(2 * cluster.tubes.len());
    for tube in inner_tubes(cluster) {
        let count = (tube.length() / (STEP * tube.min_radius())).ceil().clamp(1.0, MOST);
        // The start of most tubes is the end of another one.
        places.extend((1..=count as usize).map(|k| tube.point(k as f64 / count)));
    }
    places
}

fn inner_tubes(cluster: &Cluster) -> impl Iterator<Item = &Tube> {
    let mut beyond = vec![false; cluster.tubes.len()];
    for end in &cluster.ends {
        beyond[end.overrun as usize] = true;
    }
    beyond.into_iter().zip(&cluster.tubes).filter(|(beyond, _)| !beyond).map(|(_, tube)| tube)
}

/// Two points on axes of vessels that are close but distant along the skeleton, with no wall between them.
fn fused(wall: &TriMesh, cluster: &Cluster, watch: &Watch) -> Result<Option<[Point3; 2]>, Stop> {
    let mut walls = WallSearch::new(wall);
    first_joined(cluster, watch, |p, q| {
        watch.spend(if walls.searched < FEW { wall.triangles.len() / 16 } else { 0 })?;
        Ok(!walls.is_parted(p, q))
    })
}

/// Like [`fused`], but from the field, before there is a wall: two points with a deep lumen between them. `None` proves nothing.
///
/// # Errors
/// [`Stop`] if the watch stops it.
pub(super) fn fused_by_field(cluster: &Cluster, kappa: f64, watch: &Watch) -> Result<Option<[Point3; 2]>, Stop> {
    let mut made = None;
    first_joined(cluster, watch, |p, q| {
        // A field that cannot be made is reported by the contour.
        let Ok(field) = made.get_or_insert_with(|| Field::new(&cluster.tubes, kappa)) else { return Ok(false) };
        let is_deep = |k| field.value(&(p + (q - p) * (f64::from(k) / f64::from(SAMPLES)))) < DEEP;
        let are_deep = (0..=SAMPLES).all(is_deep);
        watch.spend(field.operations())?;
        Ok(are_deep)
    })
}

/// First pair of points on axes of vessels that are close but distant along the skeleton, and that `joins` has. The crotch of a
/// bifurcation does not count, however long it is: there the given tubes overlap, and so do their lumens. Neither does the
/// web beyond it.
fn first_joined(
    cluster: &Cluster,
    watch: &Watch,
    mut joins: impl FnMut(&Point3, &Point3) -> Result<bool, Stop>,
) -> Result<Option<[Point3; 2]>, Stop> {
    let skeleton = widened(cluster);
    let adjacency = skeleton.adjacency();
    let overlaps = skeleton.overlaps(&adjacency);
    let mut ways = LocalDistances::default();
    let mut is_far = |o: &Overlap| {
        o.nodes[0].iter().all(|&start| {
            ways.search(&skeleton, &adjacency, start, FAR * o.radii);
            o.nodes[1].iter().all(|&n| ways.of(n).is_infinite())
        })
    };
    let mut crotches = CrotchSearch::default();
    let rule = CrotchRule { narrower: 1.0 / NEAR, beyond: FAR, ..CrotchRule::default() };
    for o in &overlaps.pairs {
        watch.spend(PER_PAIR)?;
        let [p, q] = &o.points;
        if is_far(o) && joins(p, q)? && !crotches.is_in_crotch(&skeleton, &adjacency, o, rule) {
            return Ok(Some(o.points));
        }
    }
    Ok(None)
}

/// Search for triangles of a wall between two points.
pub(super) struct WallSearch<'a> {
    wall: &'a TriMesh,
    /// Number of searches.
    searched: usize,
    /// Search tree, built after some searches.
    tree: Option<Bvh>,
}

impl<'a> WallSearch<'a> {
    pub(super) fn new(wall: &'a TriMesh) -> Self {
        Self { wall, searched: 0, tree: None }
    }

    /// True if the wall crosses or touches the segment between two points.
    pub(super) fn is_parted(&mut self, p: &Point3, q: &Point3) -> bool {
        self.searched += 1;
        if self.searched <= FEW {
            return is_parted(self.wall, p, q);
        }
        let wall = self.wall;
        let corners = |t: &[u32; 3]| t.map(|v| &wall.points[v as usize]);
        let tree = self.tree.get_or_insert_with(|| {
            Bvh::new(&wall.triangles.iter().map(|t| Aabb::of_points(corners(t))).collect::<Vec<Aabb>>())
        });
        let mut found = false;
        tree.query(&Aabb::of_points([p, q]), |i| {
            found = found || meets(corners(&wall.triangles[i as usize]), p, q);
        });
        found
    }
}

/// Graph of the cluster's vessels, widened by the fusion distance.
fn widened(cluster: &Cluster) -> Skeleton {
    let mut skeleton = Skeleton::default();
    let mut nodes: FxHashMap<[u64; 3], NodeId> = FxHashMap::default();
    for tube in inner_tubes(cluster) {
        let radii = [tube.ra, tube.rb].map(|r| NEAR * r);
        let ends = [(&tube.a, radii[0]), (&tube.b, radii[1])].map(|(p, radius)| {
            *nodes.entry(place_key(p)).or_insert_with(|| {
                let id = skeleton.nodes.len() as u32;
                skeleton.nodes.push(Node { position: *p, radius, original: id });
                NodeId(id)
            })
        });
        skeleton.edges.push(Edge { nodes: ends, radii });
    }
    skeleton
}

/// True if the wall crosses or touches the segment between two points.
fn is_parted(wall: &TriMesh, p: &Point3, q: &Point3) -> bool {
    let low = p.coords.inf(&q.coords);
    let high = p.coords.sup(&q.coords);
    wall.triangles.iter().any(|triangle| {
        let [a, b, c] = triangle.map(|v| &wall.points[v as usize]);
        let apart = (0..3).any(|k| a[k].max(b[k]).max(c[k]) < low[k] || a[k].min(b[k]).min(c[k]) > high[k]);
        !apart && meets([a, b, c], p, q)
    })
}

/// True if the segment from `p` to `q` intersects a triangle.
fn meets([a, b, c]: [&Point3; 3], p: &Point3, q: &Point3) -> bool {
    let side = |x: &Point3| orient3d(a, b, c, x);
    if side(p) * side(q) > 0.0 {
        return false;
    }
    let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::partition::{PartitionParams, partition};
    use crate::surface::{Finer, SurfaceParams, vessel_wall};
    use anastomesh_mesh::budget::Budget;
    use anastomesh_mesh::shapes::sphere_surface;
    use anastomesh_skeleton::fixtures::network;

    /// A polyline as one cluster.
    fn cluster(points: &[[f64; 3]]) -> Cluster {
        let edges: Vec<(u32, u32)> = (1..points.len() as u32).map(|i| (i - 1, i)).collect();
        let skeleton = network(points, 1.0, &edges);
        let params = PartitionParams { long: 1e9, ..PartitionParams::default() };
        partition(&skeleton, &params).expect("a partition").clusters.remove(0)
    }

    fn wall(cluster: &Cluster) -> TriMesh {
        vessel_wall(
            &cluster.tubes,
            &SurfaceParams { thin: 1.0, ..SurfaceParams::with_voxel(0.5) },
            &Finer::default(),
            &Watch::NOBODY,
        )
        .expect("a wall")
        .mesh
    }

    fn of(cluster: &Cluster) -> Astray {
        Astray::of(&wall(cluster), cluster, &Watch::NOBODY).unwrap()
    }

    /// Helix of radius 2 with this pitch, in radii of the vessel.
    fn helix(pitch: f64) -> Cluster {
        let point = |i: i32| {
            let a = f64::from(i) * 0.2;
            [2.0 * libm::cos(a), 2.0 * libm::sin(a), pitch * a / std::f64::consts::TAU]
        };
        cluster(&(0..120).map(point).collect::<Vec<_>>())
    }

    #[test]
    fn turns_that_fuse_are_found() {
        let wide = helix(4.0);
        assert_eq!(of(&wide), Astray::default());
        let tight = helix(1.7);
        let found = of(&tight);
        assert!(found.fused.is_some() && found.outside.is_none(), "{found:?}");
        let near = helix(2.59);
        let (wall, budget) = (wall(&near), Budget::new(1 << 40));
        assert_eq!(fused(&wall, &near, &Watch::NOBODY.within(&budget)).unwrap(), None);
        let widened = widened(&near);
        let pairs = widened.overlaps(&widened.adjacency()).pairs.len() as u64;
        assert!(pairs > FEW as u64);
        // The first searches pass over all triangles, further ones over a tree.
        assert_eq!(budget.spent(), 20 * pairs + 8 * (wall.triangles.len() / 16) as u64);
    }

    #[test]
    fn the_field_shows_that_vessels_fuse_before_there_is_a_wall() {
        let by_field = |cluster: &Cluster| fused_by_field(cluster, 0.35, &Watch::NOBODY).unwrap();
        // A vessel that crosses itself at some height.
        let crossing = |height: f64| {
            cluster(&[[0., 0., 0.], [20., 0., 0.], [20., 12., height], [10., 12., height], [10., -12., height]])
        };
        let heights = (0..30).map(|i| 0.1 * f64::from(i));
        let mut counts = [0; 2];
        for cluster in heights.map(crossing).chain([1.2, 1.7, 2.2, 2.6, 4.0].map(helix)) {
            let found =
                [by_field(&cluster).is_some(), fused(&wall(&cluster), &cluster, &Watch::NOBODY).unwrap().is_some()];
            assert!(!found[0] || found[1]);
            (0..2).for_each(|i| counts[i] += usize::from(found[i]));
        }
        assert!(counts[0] > 10 && counts[1] > counts[0] && counts[1] < 30, "{counts:?}");
        let [p, q] = by_field(&crossing(0.5)).expect("it is found");
        assert!(
            (p - Point3::new(10.0, 0.0, 0.0)).norm() < 1e-9 && (q - Point3::new(10.0, 0.0, 0.5)).norm() < 1e-9,
            "{p} {q}"
        );
        let no_time = Budget::new(10);
        assert!(fused_by_field(&crossing(0.5), 0.35, &Watch::NOBODY.within(&no_time)).is_err());
    }

    /// A trunk, and two vessels that leave it side by side, in steps of two radii at these distances.
    fn side_by_side(apart: &[f64]) -> Cluster {
        let mut points = vec![[-9.0, 0.0, 0.0], [0.0; 3]];
        let mut edges = vec![(0, 1)];
        for side in [-0.5, 0.5] {
            let mut last = 1;
            for (i, y) in apart.iter().enumerate() {
                edges.push((last, points.len() as u32));
                last = points.len() as u32;
                points.push([2.0 * (i as f64 + 1.0), side * y, 0.0]);
            }
        }
        let params = PartitionParams { long: 1e9, ..PartitionParams::default() };
        partition(&network(&points, 1.0, &edges), &params).expect("a partition").clusters.remove(0)
    }

    #[test]
    fn a_long_crotch_is_not_fused() {
        // They separate after 20 radii.
        let apart: Vec<f64> = (1..=15).map(|i| 0.5 + 0.15 * f64::from(i)).collect();
        assert_eq!(of(&side_by_side(&apart)), Astray::default());
    }

    #[test]
    fn vessels_that_part_and_meet_again_are_fused() {
        let of = |apart: &[f64]| fused_by_field(&side_by_side(apart), 0.35, &Watch::NOBODY).unwrap();
        // The gap between them has 0.4 radii.
        let [p, q] = of(&[1.0, 1.7, 2.4, 2.4, 2.4, 2.4, 1.7, 1.0, 1.0, 1.0]).expect("they are fused");
        assert!(p.x > 12.0 && q.x > 12.0, "{p} {q}");
        assert_eq!(of(&[1.0, 1.7, 1.7, 1.7, 1.7, 1.7, 1.7, 1.0, 1.0, 1.0]), None);
    }

    #[test]
    fn both_legs_of_a_short_hairpin_are_one_vessel() {
        // Legs one radius apart, of this length in radii.
        let of = |length: u32, radius: f64| {
            let along = (0..=2 * length).map(|i| 0.5 * f64::from(i));
            let back = along.clone().rev().map(|x| [x, 1.0, 0.0]);
            let points: Vec<[f64; 3]> =
                along.map(|x| [x, 0.0, 0.0]).chain(back).map(|p| p.map(|x| x * radius)).collect();
            let edges: Vec<(u32, u32)> = (1..points.len() as u32).map(|i| (i - 1, i)).collect();
            let params = PartitionParams { long: 1e9, ..PartitionParams::default() };
            let cluster =
                partition(&network(&points, radius, &edges), &params).expect("a partition").clusters.remove(0);
            fused_by_field(&cluster, 0.35, &Watch::NOBODY).unwrap().is_some()
        };
        // They count as distant if the way from one to the other has 4.5 · 1.3 · 2 radii.
        for radius in [0.5, 1.0, 4.0] {
            assert_eq!([4, 5, 7, 8].map(|length| of(length, radius)), [false, false, true, true], "{radius}");
        }
    }

    #[test]
    fn an_axis_that_leaves_the_wall_is_found() {
        let straight = cluster(&[[0.0; 3], [10.0, 0.0, 0.0], [20.0, 0.0, 0.0]]);
        let bent = cluster(&[[0.0; 3], [10.0, 1.5, 0.0], [20.0, 0.0, 0.0]]);
        assert_eq!(of(&straight), Astray::default());
        let place = Astray::of(&wall(&straight), &bent, &Watch::NOBODY).unwrap().outside.expect("outside");
        assert!(place.y > 0.9, "{place}");
    }

    #[test]
    fn the_tree_and_the_list_of_triangles_agree() {
        let cluster = helix(4.0);
        let wall = wall(&cluster);
        let mut search = WallSearch { wall: &wall, searched: FEW, tree: None };
        let points: Vec<Point3> = cluster.tubes.iter().map(|tube| tube.a).collect();
        let (mut parted, mut open) = (0, 0);
        for (p, q) in points.iter().flat_map(|p| points.iter().map(move |q| (p, q))) {
            let expected = is_parted(&wall, p, q);
            assert_eq!(search.is_parted(p, q), expected, "{p} {q}");
            *(if expected { &mut parted } else { &mut open }) += 1;
        }
        assert!(search.tree.is_some() && parted > 100 && open > 100, "{parted} {open}");
    }

    fn tube(a: [f64; 3], b: [f64; 3], ra: f64, rb: f64) -> Tube {
        Tube { a: a.into(), b: b.into(), ra, rb }
    }

    fn of_tubes(tubes: Vec<Tube>) -> Cluster {
        Cluster { tubes, ..Cluster::default() }
    }

    #[test]
    fn samples_are_two_radii_apart_and_at_most_eight() {
        let of = |length: f64, ra, rb| places(&of_tubes(vec![tube([1.0, 0.0, 0.0], [1.0 + length, 0.0, 0.0], ra, rb)]));
        let xs = |places: Vec<Point3>| places.iter().map(|p| p.x).collect::<Vec<f64>>();
        assert_eq!(xs(of(6.0, 1.0, 2.0)), [3.0, 5.0, 7.0]);
        assert_eq!(xs(of(7.5, 1.5, 1.25)), [3.5, 6.0, 8.5]);
        assert_eq!(xs(of(0.5, 1.0, 1.0)), [1.5]);
        assert_eq!(xs(of(80.0, 1.0, 1.0)), [11.0, 21.0, 31.0, 41.0, 51.0, 61.0, 71.0, 81.0]);
    }

    #[test]
    fn samples_level_with_vertices_of_the_wall_are_seen() {
        let sphere = sphere_surface(2);
        let found =
            |a: [f64; 3], b: [f64; 3]| outside(&sphere, &of_tubes(vec![tube(a, b, 0.1, 0.1)]), &Watch::NOBODY).unwrap();
        assert_eq!(found([0.0; 3], [0.5, 0.0, 0.0]), None);
        assert_eq!(found([0.0; 3], [0.0, -0.5, 0.0]), None);
        // Outside, and on a vertex of the wall.
        assert_eq!(found([1.5, 0.0, 0.0], [1.6, 0.0, 0.0]), Some(Point3::new(1.6, 0.0, 0.0)));
        assert_eq!(found([-1.5, 0.0, 0.0], [-1.6, 0.0, 0.0]), Some(Point3::new(-1.6, 0.0, 0.0)));
        assert_eq!(found([0.9, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(Point3::new(1.0, 0.0, 0.0)));
    }

    #[test]
    fn segments_meet_a_triangle_that_they_cross_or_touch() {
        let wall = TriMesh {
            points: [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(Point3::from).to_vec(),
            triangles: vec![[0, 1, 2]],
        };
        let below = [1.0, 1.0, -1.0];
        for (p, q, expected) in [
            (below, [1.0, 1.0, 1.0], true),
            (below, [1.0, 1.0, 0.0], true),
            ([1.0, 1.0, 1.0], [1.0, 1.0, 0.0], true),
            (below, [1.0, 1.0, -0.5], false),
            ([1.0, 1.0, 2.0], [1.0, 1.0, 1.0], false),
            ([2.0, 2.0, -1.0], [2.0, 2.0, 1.0], true),
            ([3.0, 3.0, -1.0], [3.0, 3.0, 1.0], false),
            ([-1.0, 1.0, -1.0], [-1.0, 1.0, 1.0], false),
            ([1.0, -1.0, -1.0], [1.0, -1.0, 1.0], false),
            ([1.0, -2.0, -1.0], [1.0, 1.0, 1.0], false),
            ([-2.0, 1.0, -1.0], [1.0, 1.0, 1.0], false),
            ([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], true),
        ] {
            let [p, q] = [p, q].map(Point3::from);
            assert_eq!([is_parted(&wall, &p, &q), is_parted(&wall, &q, &p)], [expected; 2], "{p} {q}");
        }
    }

    #[test]
    fn widened_vessels_share_their_nodes() {
        let at = [2.0, 0.0, 0.0];
        let skeleton = widened(&of_tubes(vec![tube([0.0; 3], at, 1.0, 2.0), tube(at, [2.0, 9.0, 0.0], 2.0, 3.0)]));
        assert_eq!(skeleton.nodes.iter().map(|node| node.radius).collect::<Vec<_>>(), [1.3, 2.6, 1.3 * 3.0]);
        let edges: Vec<_> = skeleton.edges.iter().map(|edge| (edge.nodes.map(|n| n.0), edge.radii)).collect();
        assert_eq!(edges, [([0, 1], [1.3, 2.6]), ([1, 2], [2.6, 1.3 * 3.0])]);
    }
}
