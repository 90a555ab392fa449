//! Trimming (section 3.2.2 of the paper): removes the cluster beyond a cut plane and flattens the end surface.

use super::flatten::{Flat, FlattenAttempt, flatten};
use super::region::{Reach, Region, RegionGrowing, WALL};
use super::relax::EndRelaxation;
use crate::block::{CutEnd, EndSurface, FlattenFailure, cross};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::quality::triangle_ratio;
use anastomesh_mesh::{Kept, TetMesh};

/// Options of trimming.
#[derive(Clone, Copy, Debug)]
pub struct TrimOptions {
    /// Edge length of the mesh.
    pub edge: f64,
    /// Relax the end surfaces.
    pub relax: bool,
    /// Maximum depth of flattening below the plane, in radii of the cut.
    pub depth: f64,
}

/// Trimmed mesh.
#[derive(Clone, Debug, Default)]
pub struct Trimmed {
    /// Remaining mesh, with vertices in their old order.
    pub mesh: TetMesh,
    /// New number of each old vertex, or `u32::MAX`.
    pub renumbered: Vec<u32>,
    /// End surface of each requested end.
    pub ends: Vec<EndSurface>,
}

/// Score above which an end surface is accepted without further attempts.
const GOOD: f64 = 0.25;

/// Trims a mesh at its ends. `neighbours` are face neighbours as handles `4·tet + face`, `u32::MAX` at the boundary.
/// Vertices in `frozen` (sorted: those of caps) are neither moved nor removed.
///
/// # Errors
/// Index of the failed end and the reason.
pub fn trim(
    mesh: &TetMesh,
    neighbours: &[[u32; 4]],
    ends: &[CutEnd],
    frozen: &[u32],
    options: &TrimOptions,
) -> Result<Trimmed, (usize, FlattenFailure)> {
    let seeds = seeds(mesh, ends, options);
    let mut points = mesh.points.clone();
    let mut alive = vec![true; mesh.tets.len()];
    let mut local_tet = vec![WALL; mesh.tets.len()];
    let mut local_vertex = vec![WALL; mesh.points.len()];
    let mut surfaces = Vec::with_capacity(ends.len());
    for (i, end) in ends.iter().enumerate() {
        let seed = seeds[i].filter(|&t| alive[t as usize]).ok_or((i, FlattenFailure::NothingBeyond))?;
        let (r, h) = (end.section.radius, options.edge);
        let reach = Reach { lateral: 2.0 * r + 4.0 * h, depth: (options.depth + 0.5) * r + 4.0 * h };
        let mut ground = RegionGrowing {
            points: &points,
            tets: &mesh.tets,
            neighbours,
            alive: &alive,
            local_tet: &mut local_tet,
            local_vertex: &mut local_vertex,
        };
        let region = Region::grow(&mut ground, seed, &end.section, reach);
        let flat = best_attempt(&region, &points, options, r).map_err(|f| (i, f))?;
        if options.relax {
            relax(&region, &flat, &mut points, frozen, end);
        }
        for (t, &gone) in region.tets.iter().zip(&flat.removed) {
            alive[*t as usize] &= !gone;
        }
        surfaces.push((region, flat));
    }
    let trimmed = finish(mesh, &points, &alive, ends, &surfaces)?;
    match frozen.iter().find(|&&v| trimmed.renumbered[v as usize] == u32::MAX) {
        // A cut plane intersects another vessel's cap.
        Some(&lost) => Err((taker(mesh, &surfaces, lost), FlattenFailure::LeavesVessel)),
        None => Ok(trimmed),
    }
}

/// Last end that removed a tetrahedron at a vertex which then had none left.
fn taker(mesh: &TetMesh, surfaces: &[(Region, Flat)], vertex: u32) -> usize {
    let took = |(region, flat): &(Region, Flat)| {
        region.tets.iter().zip(&flat.removed).any(|(&t, &gone)| gone && mesh.tets[t as usize].contains(&vertex))
    };
    surfaces.iter().rposition(took).unwrap_or(0)
}

/// For each end, the tetrahedron with its centroid nearest to an axis point in the tip.
fn seeds(mesh: &TetMesh, ends: &[CutEnd], options: &TrimOptions) -> Vec<Option<u32>> {
    let h = options.edge;
    let ball = |e: &CutEnd| {
        let r = e.section.radius;
        (e.section.origin + e.section.axis * (0.7 * r + h).min(r + 2.0 * h), r + h)
    };
    let balls: Vec<(Point3, f64)> = ends.iter().map(ball).collect();
    let mut by_x: Vec<usize> = (0..ends.len()).collect();
    by_x.sort_by(|&a, &b| balls[a].0.x.total_cmp(&balls[b].0.x));
    let widest = balls.iter().map(|b| b.1).fold(0.0, f64::max);
    let mut best: Vec<(f64, Option<u32>)> = balls.iter().map(|b| (b.1 * b.1, None)).collect();
    for (t, corners) in mesh.tets.iter().enumerate() {
        let c = corners.iter().map(|&v| mesh.points[v as usize].coords).sum::<anastomesh_mesh::geometry::Vec3>() / 4.0;
        let first = by_x.partition_point(|&e| balls[e].0.x < c.x - widest);
        for &e in &by_x[first..] {
            if balls[e].0.x > c.x + widest {
                break;
            }
            let d = (c - balls[e].0.coords).norm_squared();
            if d < best[e].0 {
                best[e] = (d, Some(t as u32));
            }
        }
    }
    best.into_iter().map(|b| b.1).collect()
}

/// Cuts at several heights and slope limits. Returns the first good end surface, or else the best.
fn best_attempt(region: &Region, points: &[Point3], options: &TrimOptions, r: f64) -> Result<Flat, FlattenFailure> {
    let h = options.edge;
    let depth = options.depth * r + h;
    let mut best: Option<(f64, Flat)> = None;
    let mut failure = FlattenFailure::NothingBeyond;
    for min_cosine in [0.4, 0.2, 0.0] {
        for offset in [-0.4, 0.0, -0.8, 0.4, -1.2] {
            match flatten(region, points, 0, FlattenAttempt { offset: offset * h, min_cosine, depth }) {
                Ok(flat) => {
                    let score = score(region, points, &flat, h);
                    if best.as_ref().is_none_or(|b| score > b.0) {
                        best = Some((score, flat));
                    }
                    if score >= GOOD {
                        break;
                    }
                }
                Err(f) => failure = f,
            }
        }
        if best.as_ref().is_some_and(|b| b.0 > 0.0 || min_cosine == 0.0) {
            break;
        }
    }
    best.map(|b| b.1).ok_or(failure)
}

/// Score of an end surface: its worst triangle, minus penalties for rim deviations from one height and one direction of
/// rotation.
fn score(region: &Region, points: &[Point3], flat: &Flat, h: f64) -> f64 {
    let at = |v: u32| points[region.vertices[v as usize] as usize];
    let worst = flat.triangles.iter().map(|t| triangle_ratio(&t.map(at))).fold(1.0, f64::min);
    let n = flat.rim.len();
    let backwards = (0..n)
        .filter(|&i| {
            let (a, b) = (flat.rim[i], flat.rim[(i + 1) % n]);
            cross([0, 0], region.flat[a as usize], region.flat[b as usize]) <= 0
        })
        .count();
    let (low, high) = flat.rim.iter().fold((f64::MAX, f64::MIN), |(l, u), &v| {
        let x = region.height[v as usize];
        (l.min(x), u.max(x))
    });
    worst - 0.1 * (high - low - 1.5 * h).max(0.0) / h - 0.5 * backwards as f64
}

/// Relaxes an end surface; reverts if it does not stay flat.
fn relax(region: &Region, flat: &Flat, points: &mut [Point3], frozen: &[u32], end: &CutEnd) {
    let mut moved: Vec<u32> = flat.triangles.iter().flatten().map(|&v| region.vertices[v as usize]).collect();
    moved.sort_unstable();
    moved.dedup();
    let before: Vec<Point3> = moved.iter().map(|&v| points[v as usize]).collect();
    let is_frozen = |v: u32| frozen.binary_search(&region.vertices[v as usize]).is_ok();
    let relaxation = EndRelaxation { region, removed: &flat.removed, section: &end.section, frozen: &is_frozen };
    relaxation.run(points, &flat.triangles, &flat.rim);
    if !all_positive(region, flat, points) || global_surface(region, flat, end, |v| v).check(points).is_err() {
        for (&v, p) in moved.iter().zip(before) {
            points[v as usize] = p;
        }
    }
}

/// True if every remaining tetrahedron at the end surface is positive, by the exact predicate.
fn all_positive(region: &Region, flat: &Flat, points: &[Point3]) -> bool {
    let at = |v: u32| &points[region.vertices[v as usize] as usize];
    flat.triangles.iter().flatten().flat_map(|&v| region.star(v)).filter(|&&t| !flat.removed[t as usize]).all(|&t| {
        let [a, b, c, d] = region.corners[t as usize];
        orient3d(at(a), at(b), at(c), at(d)) > 0.0
    })
}

/// End surface in renumbered global vertices.
fn global_surface(region: &Region, flat: &Flat, end: &CutEnd, number: impl Fn(u32) -> u32) -> EndSurface {
    let global = |v: u32| number(region.vertices[v as usize]);
    let mut rim: Vec<u32> = flat.rim.iter().map(|&v| global(v)).collect();
    if let Some(first) = (0..rim.len()).min_by_key(|&i| rim[i]) {
        rim.rotate_left(first);
    }
    let triangles = flat.triangles.iter().map(|t| t.map(global)).collect();
    EndSurface { cut: end.cut, side: end.side, section: end.section, triangles, rim }
}

fn finish(
    mesh: &TetMesh,
    points: &[Point3],
    alive: &[bool],
    ends: &[CutEnd],
    surfaces: &[(Region, Flat)],
) -> Result<Trimmed, (usize, FlattenFailure)> {
    let staying: Vec<[u32; 4]> = mesh.tets.iter().zip(alive).filter(|(_, a)| **a).map(|(t, _)| *t).collect();
    let used = Kept::used(&staying, points.len(), 0);
    let kept = used.select(points);
    let tets = staying.iter().map(|t| used.cell(t)).collect();
    let renumbered = used.number;
    let number = |v: u32| renumbered[v as usize];
    let mut out = Vec::with_capacity(ends.len());
    for (i, ((region, flat), end)) in surfaces.iter().zip(ends).enumerate() {
        let surface = global_surface(region, flat, end, number);
        // A later end may have removed a vertex of an earlier one.
        if surface.triangles.iter().flatten().any(|&v| v == u32::MAX) || surface.check(&kept).is_err() {
            return Err((i, FlattenFailure::NotADisc));
        }
        out.push(surface);
    }
    Ok(Trimmed { mesh: TetMesh { points: kept, tets }, renumbered, ends: out })
}
