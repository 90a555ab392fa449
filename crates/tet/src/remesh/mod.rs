//! Remeshing of the input surface ([`Boundary::Remesh`](crate::Boundary::Remesh)): incremental isotropic remeshing within a
//! tolerance.
//!
//! Edges are split, collapsed and flipped towards a wanted length, and vertices move along the surface. The method is that of
//! Botsch and Kobbelt, 'A remeshing approach to multiresolution modeling', 2004. Lengths follow curvature (Dunyach et al., 'Adaptive remeshing
//! for real-time mesh deformation', 2013). Each operation keeps the topology, the features, and the distance from the input
//! in both directions. The result is tested exactly for self-intersections. Where it fails, the tolerance is reduced, and at
//! last the triangles of the input are kept.

mod collapse;
mod features;
mod flip;
mod mend;
mod reference;
mod relax;
mod request;
mod sizes;
mod split;
mod surface;
#[cfg(test)]
mod tests;
mod verify;

use crate::error::TetError;
use crate::plc::{Plc, PlcRef};
use crate::progress::{Counter, Stage, Watch};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::adjacency::vertices_of;
use anastomesh_mesh::geometry::Aabb;
use reference::Reference;
pub(super) use request::Wanted;
use sizes::Sizes;
use surface::{Surface, smallest_angle};
use verify::{Compact, verify};

/// Default tolerance, relative to the diagonal of the bounding box.
const TOLERANCE: f64 = 1e-3;

/// Maximum distance from the input, relative to the wanted edge length. So the surface of fine parts changes less.
const SHARE: f64 = 0.1;

/// Iterations. The angles of the shared surfaces hardly change after 8.
const ITERATIONS: usize = 10;

/// Iterations end after one that changes less than one in this many triangles. More iterations change no percentile of angles.
const ENOUGH: usize = 500;

/// Passes of splits in the first iteration, and in the others. Each halves long edges.
const SPLITS: [usize; 2] = [16, 2];

/// Passes that repair the worst triangles at the end.
const REPAIRS: usize = 3;

/// Maximum number of runs with reduced tolerance before the input is kept as it is.
const ROUNDS: usize = 8;

/// Factor of the tolerance at each fault, and faults after which a triangle of the input stays.
const REDUCTION: f64 = 0.25;
const FAULTS: u32 = 3;

/// Round from which triangles at faults, and those around them, stay at once.
const STRICT: usize = 4;

/// Change of the surface by remeshing.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RemeshSummary {
    /// Maximum allowed distance between the input and the remeshed surface, except for roundoff.
    pub tolerance: f64,
    /// Largest distance between both surfaces, in either direction, at 15 points of each triangle.
    pub distance: f64,
    /// Number of points of the remeshed surface. They are the first points of the mesh.
    pub points: usize,
    /// Number of triangles before and after.
    pub triangles: [usize; 2],
    /// Smallest angle of a triangle in degrees, before and after.
    pub smallest_angle: [f64; 2],
    /// First percentile of the smallest angles of triangles in degrees, before and after.
    pub percentile_1: [f64; 2],
    /// Number of input triangles that stay, because the remeshed surface would intersect itself there.
    pub frozen: usize,
    /// Segments of the input, with the ids of their points in the mesh.
    pub segments: Vec<[u32; 2]>,
}

/// Remeshed input.
pub(super) struct Remeshed {
    pub plc: Plc,
    /// Input triangle near each triangle.
    pub origins: Vec<u32>,
    pub summary: RemeshSummary,
}

/// Remeshes a checked complex that does not intersect itself.
///
/// # Errors
/// [`TetError::BadSize`] for a tolerance that is not positive; [`TetError::Cancelled`].
pub(super) fn remesh(plc: PlcRef, wanted: &Wanted, watch: &Watch) -> Result<Remeshed, TetError> {
    let default = || TOLERANCE * Aabb::of_points(&plc.surface.points).diagonal();
    let tolerance = wanted.tolerance.unwrap_or_else(default);
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(TetError::BadSize { value: tolerance });
    }
    let mut reference = Reference::new(plc, tolerance);
    watch.ask()?;
    let sizes = sizes::sizes(&reference, wanted, tolerance);
    let most: Vec<f64> = sizes.wanted.iter().map(|length| SHARE * length).collect();
    let mut faults = near_loose_parts(&reference, tolerance);
    for round in 0..ROUNDS {
        let factor = |&faults: &u32| if faults < FAULTS { REDUCTION.powi(faults as i32) } else { 0.0 };
        reference.allow(&most, &faults.iter().map(factor).collect::<Vec<_>>());
        let frozen: Vec<bool> = faults.iter().map(|&faults| faults >= FAULTS).collect();
        watch.report(Stage::Remesh, round, ROUNDS)?;
        let made = Compact::of(&iterate(&reference, &sizes, &frozen, wanted.most, watch)?);
        let verified = verify(&reference, &made, tolerance, watch)?;
        if verified.faults.is_empty() && is_valid(&made.surface) {
            watch.report(Stage::Remesh, ROUNDS, ROUNDS)?;
            let frozen = frozen.iter().filter(|frozen| **frozen).count();
            return Ok(finished(&reference, made, [tolerance, verified.distance], frozen));
        }
        add_faults(plc.surface, &verified.faults, round >= STRICT, &mut faults);
    }
    Ok(unchanged(plc, tolerance))
}

/// Faults of input triangles at the start: those near segments and points without triangles stay.
fn near_loose_parts(r: &Reference, tolerance: f64) -> Vec<u32> {
    let surface = r.plc.surface;
    let mut faults = vec![0; surface.triangles.len()];
    let used = vertices_of(&surface.triangles, surface.points.len());
    let loose = surface.points.iter().zip(used).filter(|(_, used)| !used).map(|(p, _)| Aabb::of_points([p]));
    let is_loose = |e: &&[u32; 2]| r.features.lines.binary_search(&features::edge(e[0], e[1])).is_err();
    let segments = r.plc.segments.iter().filter(is_loose);
    let segments = segments.map(|e| Aabb::of_points(e.map(|v| &surface.points[v as usize])));
    for aabb in loose.chain(segments) {
        r.query(&aabb.grown(2.0 * tolerance), |t| faults[t as usize] = FAULTS);
    }
    faults
}

/// Counts faults; in a strict round the triangles at them, and those around, stay.
fn add_faults(surface: &TriMesh, found: &[u32], is_strict: bool, faults: &mut [u32]) {
    if !is_strict {
        for &t in found {
            faults[t as usize] += 1;
        }
        return;
    }
    let mut is_near = vec![false; surface.points.len()];
    let corners = |t: &u32| surface.triangles[*t as usize];
    found.iter().flat_map(corners).for_each(|v| is_near[v as usize] = true);
    for (faults, t) in faults.iter_mut().zip(&surface.triangles) {
        if t.iter().any(|&v| is_near[v as usize]) {
            *faults = FAULTS;
        }
    }
}

/// Remeshes the input once.
fn iterate<'a>(
    reference: &'a Reference,
    sizes: &Sizes,
    frozen: &[bool],
    most: usize,
    watch: &Watch,
) -> Result<Surface<'a>, TetError> {
    let mut counter = Counter::new(watch);
    let mut s = Surface::new(reference, sizes, frozen);
    for iteration in 0..ITERATIONS {
        let mut changes = s.collapse_short(&mut counter)?;
        s.flip_all(&mut counter)?;
        for _ in 0..SPLITS[iteration.min(1)] {
            let splits = s.split_long(most, &mut counter)?;
            if splits == 0 {
                break;
            }
            changes += splits;
            s.flip_all(&mut counter)?;
        }
        s.relax(&mut counter)?;
        s.flip_all(&mut counter)?;
        watch.ask()?;
        if changes * ENOUGH < s.count() {
            break;
        }
    }
    for _ in 0..REPAIRS {
        s.mend(&mut counter)?;
        s.flip_all(&mut counter)?;
        s.relax(&mut counter)?;
        s.flip_all(&mut counter)?;
    }
    counter.end()?;
    Ok(s)
}

/// True if no two points of a surface coincide.
fn is_valid(surface: &TriMesh) -> bool {
    crate::input::no_duplicate_points(&surface.points).is_ok()
}

fn finished(r: &Reference, made: Compact, [tolerance, distance]: [f64; 2], frozen: usize) -> Remeshed {
    let Compact { surface, numbers, origins, .. } = made;
    let before = angles(r.plc.surface);
    let after = angles(&surface);
    let segments: Vec<[u32; 2]> = r.plc.segments.iter().map(|e| e.map(|v| numbers[v as usize])).collect();
    let summary = RemeshSummary {
        tolerance,
        distance,
        points: surface.points.len(),
        triangles: [before.len(), after.len()],
        smallest_angle: [&before, &after].map(|angles| angles.first().copied().unwrap_or(0.0)),
        percentile_1: [&before, &after].map(|angles| angles.get(angles.len() / 100).copied().unwrap_or(0.0)),
        frozen,
        segments: segments.clone(),
    };
    let plc = Plc {
        surface,
        markers: origins.iter().filter_map(|&t| r.plc.markers.get(t as usize).copied()).collect(),
        segments,
        holes: r.plc.holes.to_vec(),
        regions: r.plc.regions.to_vec(),
    };
    Remeshed { plc, origins, summary }
}

/// The input as it is.
fn unchanged(plc: PlcRef, tolerance: f64) -> Remeshed {
    let angles = angles(plc.surface);
    let triangles = angles.len();
    let summary = RemeshSummary {
        tolerance,
        distance: 0.0,
        points: plc.surface.points.len(),
        triangles: [triangles; 2],
        smallest_angle: [angles.first().copied().unwrap_or(0.0); 2],
        percentile_1: [angles.get(triangles / 100).copied().unwrap_or(0.0); 2],
        frozen: triangles,
        segments: plc.segments.to_vec(),
    };
    Remeshed { plc: plc.to_owned(), origins: (0..triangles as u32).collect(), summary }
}

/// Smallest angle of each triangle in degrees, ascending.
fn angles(surface: &TriMesh) -> Vec<f64> {
    let of = |t: &[u32; 3]| smallest_angle(t.map(|v| &surface.points[v as usize])).to_degrees();
    let mut angles: Vec<f64> = surface.triangles.iter().map(of).collect();
    angles.sort_by(f64::total_cmp);
    angles
}
