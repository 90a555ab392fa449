//! Edge lengths that remeshing aims at: as the input's triangles by their area, less at curvature and thin parts, graded.

use super::features::{Freedom, area, edge};
use super::reference::Reference;
use super::request::Wanted as Request;
use anastomesh_mesh::adjacency::Incidence;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Increase of the edge length per distance: edges grow by less than a third from one triangle to the next.
pub(super) const GRADING: f64 = 0.3;

/// Square of the wanted length per area. A regular triangle has 2.31 = 4/√3. Edges end up a tenth shorter than wanted, and with
/// this value the bunny keeps its number of triangles.
const SQUARE: f64 = 2.8;

/// Ratio of the sides of a regular triangle to the height.
const SIDE: f64 = 1.155;

/// Edge length in thin strips between feature lines, in widths of the strip. The angles across are then about 27°.
const STRIP: f64 = 2.0;

/// Minimum edge length in tolerances. Details below cannot be told from noise.
const LEAST: f64 = 2.0;

/// Edge lengths at the points of an input.
pub(super) struct Sizes {
    /// Length without curvature and grading.
    pub base: Vec<f64>,
    /// Length that holds.
    pub wanted: Vec<f64>,
}

/// Edge lengths at the points of the input: as requested, or those of the input, limited by curvature and thin parts.
pub(super) fn sizes(r: &Reference, request: &Request, tolerance: f64) -> Sizes {
    let surface = r.plc.surface;
    let mut base: Vec<f64> = match request.size {
        Some(size) => surface.points.iter().map(size).collect(),
        None => own_lengths(r),
    };
    for length in &mut base {
        *length = length.min(request.longest);
    }
    let mut wanted = base.clone();
    limit_by_curvature(r, tolerance, &mut wanted);
    limit_by_lines(r, tolerance, &mut wanted);
    limit_by_strips(r, tolerance, &mut wanted);
    grade(r, &mut wanted);
    Sizes { base, wanted }
}

/// Side of regular triangles with the mean area around each point.
fn own_lengths(r: &Reference) -> Vec<f64> {
    let n = r.plc.surface.points.len();
    let (mut sums, mut counts) = (vec![0.0; n], vec![0.0; n]);
    for (t, corners) in (0..).zip(&r.plc.surface.triangles) {
        let area = area(r.corners(t));
        for &v in corners {
            sums[v as usize] += area;
            counts[v as usize] += 1.0;
        }
    }
    sums.iter().zip(&counts).map(|(sum, count): (&f64, &f64)| (SQUARE * sum / count.max(1.0)).sqrt()).collect()
}

/// Limits lengths to chords within the tolerance: √(8 · tolerance · radius), but not below the input's own resolution. The
/// curvature at a vertex is the mean over its edges, weighted by their turn: plane triangles beside a fillet do not count.
fn limit_by_curvature(r: &Reference, tolerance: f64, wanted: &mut [f64]) {
    let surface = r.plc.surface;
    // Sums of the turn, and of the turn times curvature and height.
    let mut sums = vec![[0.0; 3]; wanted.len()];
    for &([a, b], [t, u]) in &r.features.smooth {
        let length = (surface.points[a as usize] - surface.points[b as usize]).norm();
        let height = 2.0 * area(r.corners(t)).min(area(r.corners(u))) / length;
        let angle = libm::acos(r.normals[t as usize].dot(&r.normals[u as usize]).clamp(-1.0, 1.0));
        let turn = angle * length;
        // Turns within less than the tolerance are noise.
        let curvature = angle / height.max(tolerance);
        let corners = [t, u].into_iter().flat_map(|t| surface.triangles[t as usize]);
        // Both ends occur twice, the apexes once.
        for v in corners {
            let sum = &mut sums[v as usize];
            *sum = [sum[0] + turn, sum[1] + turn * curvature, sum[2] + turn * height];
        }
    }
    for (length, [turn, curvature, height]) in wanted.iter_mut().zip(sums) {
        if curvature > 0.0 {
            let chord = (8.0 * tolerance * turn / curvature).sqrt();
            *length = length.min(chord.max(SIDE * height / turn).max(LEAST * tolerance));
        }
    }
}

/// Limits lengths on feature lines by their curvature, and at short edges between corners.
fn limit_by_lines(r: &Reference, tolerance: f64, wanted: &mut [f64]) {
    let points = &r.plc.surface.points;
    let mut ends: FxHashMap<u32, [u32; 2]> = FxHashMap::default();
    for &[a, b] in &r.features.lines {
        for (v, w) in [(a, b), (b, a)] {
            ends.entry(v).and_modify(|pair| pair[1] = w).or_insert([w, w]);
        }
        if [a, b].iter().all(|&v| r.features.freedom[v as usize] == Freedom::Fixed) {
            let length = (points[a as usize] - points[b as usize]).norm().max(LEAST * tolerance);
            for v in [a, b] {
                wanted[v as usize] = wanted[v as usize].min(length);
            }
        }
    }
    for (v, length) in wanted.iter_mut().enumerate().filter(|(v, _)| r.features.freedom[*v] == Freedom::Line) {
        let Some(&[a, b]) = ends.get(&(v as u32)) else { continue };
        let [before, after] = [points[v] - points[a as usize], points[b as usize] - points[v]];
        let mean = f64::midpoint(before.norm(), after.norm());
        let cosine = before.dot(&after) / (before.norm() * after.norm()).max(f64::MIN_POSITIVE);
        let turn = libm::acos(cosine.clamp(-1.0, 1.0));
        if turn > 0.0 {
            *length = length.min((8.0 * tolerance * mean / turn).sqrt().max(mean).max(LEAST * tolerance));
        }
    }
}

/// Limits lengths in thin strips between feature lines.
fn limit_by_strips(r: &Reference, tolerance: f64, wanted: &mut [f64]) {
    let surface = r.plc.surface;
    let is_line = |a: u32, b: u32| r.features.lines.binary_search(&edge(a, b)).is_ok();
    for &[a, b, c] in &surface.triangles {
        let lines = [(a, b, c), (b, c, a), (c, a, b)].into_iter().filter(|&(a, b, _)| is_line(a, b));
        let lines: Vec<_> = lines.collect();
        let &[(a, b, apex)] = lines.as_slice() else { continue };
        if r.features.freedom[apex as usize] == Freedom::Patch {
            continue;
        }
        let [p, q, top] = [a, b, apex].map(|v| surface.points[v as usize]);
        let (along, side) = (q - p, top - p);
        let share = side.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        if (0.0..=1.0).contains(&share) {
            let width = (side - along * share).norm();
            let most = (STRIP * width).max(LEAST * tolerance);
            for v in [a, b, apex] {
                wanted[v as usize] = wanted[v as usize].min(most);
            }
        }
    }
}

/// Limits the growth of lengths along edges (Dijkstra's algorithm).
fn grade(r: &Reference, wanted: &mut [f64]) {
    let surface = r.plc.surface;
    let neighbours = Incidence::of_vertices(&surface.triangles, surface.points.len());
    // Positive numbers have the order of their bits.
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> =
        wanted.iter().zip(0..).map(|(length, v)| Reverse((length.to_bits(), v))).collect();
    while let Some(Reverse((bits, v))) = queue.pop() {
        let length = wanted[v as usize];
        if length.to_bits() != bits {
            continue;
        }
        for &w in neighbours.get(v) {
            let distance = (surface.points[v as usize] - surface.points[w as usize]).norm();
            let most = length + GRADING * distance;
            if wanted[w as usize] > most {
                wanted[w as usize] = most;
                queue.push(Reverse((most.to_bits(), w)));
            }
        }
    }
}
