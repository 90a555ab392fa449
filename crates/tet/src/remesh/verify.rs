//! Checks and measures of a remeshed surface against the input.

use super::reference::{Reference, nearest};
use super::surface::{NONE, Surface};
use crate::contacts::contacts_within;
use crate::error::TetError;
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3};
use rayon::prelude::*;

/// Samples per side of a triangle for the distance between both surfaces.
const SAMPLES: u32 = 5;

/// Triangles between two checks for cancellation.
const CHUNK: usize = 4096;

/// Operations per triangle, as counted by budgets.
const OPERATIONS: usize = 200;

/// Excess of a measured distance over the tolerance that is no fault. Operations test fewer points than the measure.
const EXCESS: f64 = 1.0;

/// Remeshed surface with compact numbers.
pub(super) struct Compact {
    pub surface: TriMesh,
    /// Number of each vertex, or `NONE`.
    pub numbers: Vec<u32>,
    /// Input triangle near each triangle, in the same patch.
    pub origins: Vec<u32>,
    /// Triangle near each point of the input.
    at_input: Vec<u32>,
}

impl Compact {
    /// Vertices in their order, with the points of the input that belong to no triangle.
    pub fn of(s: &Surface) -> Self {
        let input = s.reference.plc.surface;
        let mut is_kept: Vec<bool> = s.around.iter().map(|around| !around.is_empty()).collect();
        let used = anastomesh_mesh::adjacency::vertices_of(&input.triangles, input.points.len());
        for (kept, used) in is_kept.iter_mut().zip(used) {
            *kept |= !used;
        }
        let mut numbers = vec![NONE; s.points.len()];
        let mut points = Vec::new();
        for (v, p) in s.points.iter().enumerate().filter(|(v, _)| is_kept[*v]) {
            numbers[v] = points.len() as u32;
            points.push(*p);
        }
        let (mut triangles, mut origins) = (Vec::with_capacity(s.count()), Vec::with_capacity(s.count()));
        let mut at_input = vec![0; input.points.len()];
        for (t, corners) in s.triangles.iter().enumerate().filter(|(_, corners)| corners[0] != NONE) {
            let number = triangles.len() as u32;
            let given = corners.iter().map(|&v| s.given[v as usize]).filter(|&i| i != NONE);
            for i in given.chain(s.held[t].iter().copied()) {
                at_input[i as usize] = number;
            }
            triangles.push(corners.map(|v| numbers[v as usize]));
            origins.push(s.near[t]);
        }
        Self { surface: TriMesh { points, triangles }, numbers, origins, at_input }
    }
}

/// Largest distances of a surface, and the input triangles at faults.
pub(super) struct Verified {
    pub distance: f64,
    pub faults: Vec<u32>,
}

/// Finds self-intersections, and distances beyond the tolerance in both directions.
///
/// # Errors
/// [`TetError::Cancelled`], [`TetError::OverBudget`].
pub(super) fn verify(r: &Reference, made: &Compact, tolerance: f64, watch: &Watch) -> Result<Verified, TetError> {
    let mut faults = Vec::new();
    let boxes: Vec<Aabb> = made.surface.triangles.iter().map(|t| Aabb::of_points(corners(&made.surface, t))).collect();
    for pair in contacts_within(&made.surface, watch)? {
        for t in pair {
            r.query(&boxes[t as usize], |i| faults.push(i));
            faults.push(made.origins[t as usize]);
        }
    }
    let tree = Bvh::of(boxes);
    let out = distances(&made.surface, watch, |t, p| r.distance(p, made.origins[t]))?;
    let input = r.plc.surface;
    let back = distances(input, watch, |t, p| {
        let hint = made.at_input[input.triangles[t][0] as usize];
        nearest(&tree, p, hint, |t| corners(&made.surface, &made.surface.triangles[t as usize]))
    })?;
    let is_far = |distance: f64| distance > EXCESS * tolerance;
    faults.extend(out.iter().zip(&made.origins).filter(|(d, _)| is_far(**d)).map(|(_, &t)| t));
    faults.extend(back.iter().zip(0..).filter(|(d, _)| is_far(**d)).map(|(_, t)| t));
    faults.sort_unstable();
    faults.dedup();
    Ok(Verified { distance: out.iter().chain(&back).copied().fold(0.0, f64::max), faults })
}

fn corners<'a>(surface: &'a TriMesh, t: &[u32; 3]) -> [&'a Point3; 3] {
    t.map(|v| &surface.points[v as usize])
}

/// Largest distance of samples of each triangle.
fn distances(
    surface: &TriMesh,
    watch: &Watch,
    distance: impl Fn(usize, &Point3) -> f64 + Sync,
) -> Result<Vec<f64>, TetError> {
    let mut all = Vec::with_capacity(surface.triangles.len());
    for (k, chunk) in surface.triangles.chunks(CHUNK).enumerate() {
        watch.spend(OPERATIONS * chunk.len())?;
        let of = |(i, t): (usize, &[u32; 3])| {
            let far = samples(corners(surface, t)).map(|p| distance(k * CHUNK + i, &p));
            far.fold(0.0, f64::max)
        };
        all.par_extend(chunk.par_iter().enumerate().map(of));
    }
    Ok(all)
}

/// Points of a triangle on a regular grid.
fn samples([a, b, c]: [&Point3; 3]) -> impl Iterator<Item = Point3> {
    let (a, u, v) = (*a, b - a, c - a);
    let step = 1.0 / f64::from(SAMPLES - 1);
    let grid = (0..SAMPLES).flat_map(|i| (0..SAMPLES - i).map(move |j| (f64::from(i), f64::from(j))));
    grid.map(move |(i, j)| a + u * (i * step) + v * (j * step))
}
