//! Features of the input that remeshing keeps: lines, corners, and the smooth patches between them.

use crate::plc::PlcRef;
use anastomesh_mesh::adjacency::Incidence;
use anastomesh_mesh::geometry::{DisjointSets, Point3, Vec3, point_segment, unit_normal};
use rustc_hash::FxHashSet;

/// Cosine of the angle between normals above which an edge is a feature: 40°. Tubes of 12 segments (30°) stay smooth, and
/// tubes of 8 segments (45°) keep their edges. Usual values of other remeshers are 30° to 60°.
const SMOOTH: f64 = 0.766;

/// Cosine of the turn of a feature line above which its vertex is a corner: 40°, as for edges.
const STRAIGHT: f64 = 0.766;

/// Height of triangles without a reliable normal, relative to the tolerance. Roundoff and noise of the input are below.
const FLAT: f64 = 0.1;

/// Height of a turn of a feature line above which it is a corner, relative to the tolerance. Lower turns are noise.
const HEIGHT: f64 = 0.25;

/// Passes that take the normals of flat triangles from their neighbours. Chains of flat triangles are rarely longer.
const PASSES: usize = 8;

/// Motion that a vertex has left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Freedom {
    /// Inside a smooth patch.
    Patch,
    /// Inside a feature line.
    Line,
    /// None.
    Fixed,
}

/// Features of an input.
pub(super) struct Features {
    /// Feature edges, smaller vertex first, ascending.
    pub lines: Vec<[u32; 2]>,
    /// Freedom of each point.
    pub freedom: Vec<Freedom>,
    /// Patch of each triangle: its smallest triangle.
    pub patches: Vec<u32>,
    /// Edges of two triangles inside patches, with both triangles.
    pub smooth: Vec<([u32; 2], [u32; 2])>,
}

/// One side of a triangle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    edge: [u32; 2],
    triangle: u32,
    is_forward: bool,
}

/// Edge with its smaller vertex first.
pub(super) fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Sides of all triangles, ascending.
fn sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let of = |(triangle, t): (u32, &[u32; 3])| {
        let [a, b, c] = *t;
        [(a, b), (b, c), (c, a)].map(|(u, v)| Side { edge: edge(u, v), triangle, is_forward: u < v })
    };
    let mut all: Vec<Side> = (0..).zip(triangles).flat_map(of).collect();
    all.sort_unstable();
    all
}

/// Finds the features of an input, and the normals of its triangles.
pub(super) fn find(plc: PlcRef, tolerance: f64) -> (Features, Vec<Vec3>) {
    let surface = plc.surface;
    let sides = sides(&surface.triangles);
    let normals = normals(plc, &sides, FLAT * tolerance);
    let segments: FxHashSet<[u32; 2]> = plc.segments.iter().map(|&[a, b]| edge(a, b)).collect();
    let mut patches = DisjointSets::new(surface.triangles.len());
    let (mut lines, mut smooth) = (Vec::new(), Vec::new());
    for run in sides.chunk_by(|x, y| x.edge == y.edge) {
        let edge = run[0].edge;
        match *run {
            [x, y] if is_smooth(plc, &normals, x, y) && !segments.contains(&edge) => {
                patches.join(x.triangle, y.triangle);
                smooth.push((edge, [x.triangle, y.triangle]));
            }
            _ => lines.push(edge),
        }
    }
    patches.flatten();
    let patches = (0..surface.triangles.len() as u32).map(|t| patches.find(t)).collect();
    let freedom = freedoms(plc, &lines, HEIGHT * tolerance);
    (Features { lines, freedom, patches, smooth }, normals)
}

fn is_smooth(plc: PlcRef, normals: &[Vec3], x: Side, y: Side) -> bool {
    let [t, u] = [x, y].map(|side| side.triangle as usize);
    x.is_forward != y.is_forward && plc.markers.get(t) == plc.markers.get(u) && normals[t].dot(&normals[u]) >= SMOOTH
}

/// Unit normals. Triangles lower than `height` get the mean of their neighbours, weighted by area.
fn normals(plc: PlcRef, sides: &[Side], height: f64) -> Vec<Vec3> {
    let surface = plc.surface;
    let corners = |t: &[u32; 3]| t.map(|v| &surface.points[v as usize]);
    let mut normals: Vec<Vec3> = surface.triangles.iter().map(|t| normal_of(corners(t))).collect();
    let areas: Vec<f64> = surface.triangles.iter().map(|t| area(corners(t))).collect();
    let mut is_flat: Vec<bool> = surface.triangles.iter().map(|t| is_lower(corners(t), height)).collect();
    for _ in 0..PASSES {
        let mut sums = vec![Vec3::zeros(); normals.len()];
        for run in sides.chunk_by(|x, y| x.edge == y.edge) {
            let &[x, y] = run else { continue };
            let [t, u] = [x, y].map(|side| side.triangle as usize);
            if x.is_forward != y.is_forward {
                // Below the least normal number, areas would not weigh.
                sums[t] += if is_flat[u] { Vec3::zeros() } else { normals[u] * areas[u].max(f64::MIN_POSITIVE) };
                sums[u] += if is_flat[t] { Vec3::zeros() } else { normals[t] * areas[t].max(f64::MIN_POSITIVE) };
            }
        }
        let mut any = false;
        for (t, sum) in sums.iter().enumerate().filter(|(t, _)| is_flat[*t]).collect::<Vec<_>>() {
            if let Some(mean) = sum.try_normalize(0.0) {
                (normals[t], is_flat[t], any) = (mean, false, true);
            }
        }
        if !any {
            break;
        }
    }
    normals
}

/// Unit normal of a triangle.
pub(super) fn normal_of([a, b, c]: [&Point3; 3]) -> Vec3 {
    unit_normal(a.coords, b.coords, c.coords)
}

/// True for a triangle lower than a height.
fn is_lower([a, b, c]: [&Point3; 3], height: f64) -> bool {
    2.0 * area([a, b, c]) < height * (a - b).norm().max((b - c).norm()).max((c - a).norm())
}

/// Area of a triangle.
pub(super) fn area([a, b, c]: [&Point3; 3]) -> f64 {
    0.5 * (b - a).cross(&(c - a)).norm()
}

/// Freedom of each point: on a line, exactly two feature edges meet without a sharp turn.
fn freedoms(plc: PlcRef, lines: &[[u32; 2]], height: f64) -> Vec<Freedom> {
    let surface = plc.surface;
    let n = surface.points.len();
    let at = Incidence::of_cells(lines, n);
    let around = Incidence::of_cells(&surface.triangles, n);
    let lines_at = |v: u32| {
        let mut ends = at.get(v).iter().map(|&i| lines[i as usize]).map(|[a, b]| if a == v { b } else { a });
        (ends.next(), ends.next(), ends.next())
    };
    let mut freedom: Vec<Freedom> = (0..n as u32)
        .map(|v| match lines_at(v) {
            _ if !is_connected(around.get(v), v, &surface.triangles) => Freedom::Fixed,
            (None, ..) => Freedom::Patch,
            (Some(a), Some(b), None) if !turns(&surface.points, [a, v, b], height) => Freedom::Line,
            _ => Freedom::Fixed,
        })
        .collect();
    for &v in plc.segments.iter().flatten() {
        freedom[v as usize] = Freedom::Fixed;
    }
    freedom
}

fn turns(points: &[Point3], [a, v, b]: [u32; 3], height: f64) -> bool {
    let [a, v, b] = [a, v, b].map(|v| &points[v as usize]);
    let (before, after) = (v - a, b - v);
    before.dot(&after) < STRAIGHT * before.norm() * after.norm() && point_segment(v, a, b).1 > height
}

/// True if the triangles around a vertex are connected by edges.
fn is_connected(around: &[u32], v: u32, triangles: &[[u32; 3]]) -> bool {
    let mut sets = DisjointSets::new(around.len());
    let mut ends: Vec<(u32, u32)> = Vec::with_capacity(2 * around.len());
    for (i, &t) in (0..).zip(around) {
        ends.extend(triangles[t as usize].into_iter().filter(|&w| w != v).map(|w| (w, i)));
    }
    ends.sort_unstable();
    for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        sets.join(pair[0].1, pair[1].1);
    }
    !around.is_empty() && (0..around.len() as u32).all(|i| sets.root(i) == 0)
}
