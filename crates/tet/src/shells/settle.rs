//! Outer positions for which all prisms are positive, and the outer surface does not intersect itself.

use super::directions::directions;
use super::heights::heights;
use super::improve::Improver;
use super::outside::Outside;
use super::shell::Given;
use crate::error::{Obstacle, Stuck, TetError};
use crate::layers::{Numbers, Places, Ways, rims, toward};
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::adjacency::vertices_of;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Maximum passes that make shells thinner.
const MAX_PASSES: usize = 30;
/// Factor of the thickness at an obstacle, at first and after some passes.
const FACTORS: [f64; 2] = [0.7, 0.4];
/// Fraction of the thickness wanted below which the search ends.
const LEAST: f64 = 1e-3;
/// Passes with the first factor.
const PATIENT: usize = 8;

/// Shells with their final positions.
pub(super) struct Settled {
    pub numbers: Numbers,
    /// Positions of the surface's points and of all copies.
    pub points: Vec<Point3>,
    /// Thickness of each vertex relative to that wanted.
    pub shares: Vec<f64>,
}

/// Finds positions.
pub(super) fn settle(given: &Given, watch: &Watch) -> Result<Settled, TetError> {
    let Given { surface, wall, caps, shells, around } = *given;
    let points = &surface.points;
    let (directions, sides) = directions(surface, wall, caps);
    let ways = &directions.ways;
    let stuck = |triangle: [u32; 3], reason| Err(TetError::Stuck { part: Obstacle::Triangle(triangle), reason });
    if let Some(&t) = wall.iter().find(|t| t.iter().any(|&v| ways[v as usize] == Vec3::zeros())) {
        return stuck(t, Stuck::Layer);
    }
    let on_wall = vertices_of(wall, points.len());
    let wanted: Vec<f64> = (0..points.len()).map(|v| shells.iter().map(|shell| shell.thickness[v]).sum()).collect();
    let heights = heights(&joined(surface, around), wall, ways, &wanted);
    let is_rim = rims(surface, |t| caps[t].is_none());
    let numbers = Numbers::new(on_wall.iter().copied(), is_rim.clone(), shells.iter().map(|s| s.layers).sum());
    let mut outside = Outside::new(&numbers, given);
    let improver = Improver::new((surface, wall), &numbers, shells, (&directions, &sides), &heights);
    let mut places = Places {
        surface,
        wall,
        is_rim,
        wanted: (0..points.len()).map(|v| points[v] + ways[v] * heights[v]).collect(),
        is_held: on_wall.iter().map(|on_wall| !on_wall).collect(),
        is_narrow: true,
    };
    let length = |outer: &[Point3], v: usize| (outer[v] - points[v]).norm();
    let mut changed: Vec<u32> = (0..wall.len() as u32).collect();
    let mut last = wall[0];
    for pass in 0..MAX_PASSES {
        watch.ask()?;
        improver.improve(&changed, &mut places.wanted);
        let mut positions = Vec::with_capacity(numbers.len() as usize + around.map_or(0, |around| around.points.len()));
        positions.extend_from_slice(points);
        for v in (0..points.len()).filter(|&v| on_wall[v]) {
            positions.extend(improver.depths_at(v).iter().map(|&depth| toward(&points[v], &places.wanted[v], depth)));
        }
        let mut obstacles = numbers.turned(wall, &positions);
        let reason = if obstacles.is_empty() { Stuck::Intersection } else { Stuck::Layer };
        if obstacles.is_empty() {
            obstacles = outside.meeting(positions, watch)?;
        }
        if obstacles.is_empty() {
            let share = |v: usize| match length(&places.wanted, v) / wanted[v] {
                // Rounding of a complete thickness.
                share if !on_wall[v] || share > 1.0 - 1e-9 => 1.0,
                share => share,
            };
            let shares = (0..points.len()).map(share).collect();
            return Ok(Settled { points: outside.into_points(numbers.len() as usize), numbers, shares });
        }
        let mut offsets = Ways::new(&places);
        offsets.drawn_back = FACTORS[usize::from(pass >= PATIENT)];
        offsets.reduce_offsets(obstacles.as_flattened());
        let outer = offsets.inner();
        let is_least = |v: usize| on_wall[v] && length(&outer, v) < LEAST * wanted[v];
        let least = |t: &&[u32; 3]| t.iter().any(|&v| is_least(v as usize));
        if let Some(&t) = obstacles.iter().find(least) {
            return stuck(t, reason);
        }
        last = obstacles[0];
        places.wanted = outer;
        changed = improver.around_vertices(obstacles.into_iter().flatten());
    }
    stuck(last, Stuck::Budget)
}

/// The surface, and the obstacles with it.
fn joined(surface: &TriMesh, around: Option<&TriMesh>) -> TriMesh {
    let mut all = surface.clone();
    if let Some(around) = around {
        let first = all.points.len() as u32;
        all.points.extend_from_slice(&around.points);
        all.triangles.extend(around.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}
