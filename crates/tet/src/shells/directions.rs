//! Outward directions at the vertices of a wall. At rims they lie in the plane of the cap.

use super::shell::of_caps;
use crate::layers::Directions;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rustc_hash::FxHashMap;

/// Minimum cosine between a direction in the plane of a cap and the normals of the wall. The wall behind a cap may rise
/// above its plane, where a tip ends inside a fork; the ring is not flat there.
const STEEP: f64 = 0.25;
/// Shares of the wall's own direction that are added to one that is not steep enough.
const TURNED: [f64; 3] = [0.5, 1.0, 2.0];

/// Region in which the outer position of a vertex may lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Side {
    /// Anywhere outside the wall.
    Free,
    /// In the plane of a cap with this outward normal.
    Flat(Vec3),
    /// In front of that plane. Behind it, the shells would meet the cap at any thickness.
    Front(Vec3),
}

/// Regions of the outer positions. Most vertices are free.
#[derive(Debug, Default)]
pub(super) struct Sides(FxHashMap<u32, Side>);

impl Sides {
    pub fn at(&self, v: usize) -> Side {
        self.0.get(&(v as u32)).copied().unwrap_or(Side::Free)
    }
}

/// Unit vectors that lead away from a wall, whose triangles are seen from inside, and where their vertices may go. At the
/// rim of a cap they lie in its plane, or lead to its front.
pub(super) fn directions(surface: &TriMesh, wall: &[[u32; 3]], caps: &[Option<u32>]) -> (Directions, Sides) {
    let mut ways = Directions::new(&surface.points, wall);
    let mut is_held = vec![false; surface.points.len()];
    let mut sides = Sides::default();
    for (_, triangles) in of_caps(surface, caps) {
        let (centre, normal) = plane(&surface.points, &triangles);
        for v in triangles.into_iter().flatten().map(|v| v as usize) {
            is_held[v] = true;
            // Vertices inside the cap have no triangle of the wall.
            if ways.ways[v] != Vec3::zeros() {
                let way = surface.points[v] - centre;
                let flat = (way - normal * way.dot(&normal)).try_normalize(0.0).unwrap_or_default();
                let (way, side) = at_rim(&ways, v, flat, normal);
                ways.ways[v] = way;
                sides.0.insert(v as u32, side);
            }
        }
    }
    ways.smooth(wall, &is_held);
    (ways, sides)
}

/// Direction at a vertex of a rim: in the plane of the cap if that is steep enough, else to its front.
fn at_rim(ways: &Directions, v: usize, flat: Vec3, normal: Vec3) -> (Vec3, Side) {
    let is_steep = |way: &Vec3| ways.steepness(v, way) >= STEEP;
    if is_steep(&flat) {
        return (flat, Side::Flat(normal));
    }
    let own = ways.ways[v];
    let between = TURNED.into_iter().filter_map(|share| (flat + own * share).try_normalize(0.0));
    let clear = between.into_iter().find(|way| way.dot(&normal) >= 0.0 && is_steep(way));
    match clear.unwrap_or_else(|| ways.way_with(v, -normal)) {
        way if way == Vec3::zeros() => (own, Side::Free),
        way => (way, Side::Front(normal)),
    }
}

/// Centre of area and unit normal of a cap.
fn plane(points: &[Point3], triangles: &[[u32; 3]]) -> (Point3, Vec3) {
    let (mut area, mut moment, mut total) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        let normal = (b - a).cross(&(c - a));
        area += normal;
        total += normal.norm();
        moment += (a.coords + b.coords + c.coords) * (normal.norm() / 3.0);
    }
    let centre = if total > 0.0 { moment / total } else { Vec3::zeros() };
    (Point3::from(centre), area.try_normalize(0.0).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions at vertex 0, whose wall has the given outward normals.
    fn vertex_with(normals: &[Vec3]) -> Directions {
        let (mut points, mut wall) = (vec![Point3::origin()], Vec::new());
        for normal in normals {
            let first = points.len() as u32;
            let side = normal.cross(&Vec3::new(0.31, 0.47, 0.83));
            points.extend([side, side.cross(normal)].map(Point3::from));
            wall.push([0, first, first + 1]);
        }
        Directions::new(&points, &wall)
    }

    #[test]
    fn a_direction_at_a_rim_never_leads_behind_the_cap() {
        let (flat, normal) = (Vec3::x(), Vec3::z());
        let overhang = vertex_with(&[Vec3::new(0.1, 0.99, -0.1), Vec3::new(-0.3, 0.5, -0.6)]);
        assert!(overhang.ways[0].dot(&normal) < 0.0 && overhang.steepness(0, &flat) < STEEP);
        let (way, side) = at_rim(&overhang, 0, flat, normal);
        assert_eq!(side, Side::Front(normal));
        assert!(way.dot(&normal) >= 0.0 && overhang.steepness(0, &way) > 0.0, "{way:?}");

        let upright = vertex_with(&[Vec3::new(0.9, 0.4, -0.1), Vec3::new(0.9, -0.4, 0.1)]);
        assert_eq!(at_rim(&upright, 0, flat, normal), (flat, Side::Flat(normal)));
    }
}
