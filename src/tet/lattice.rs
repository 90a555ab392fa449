//! Interior points: a body-centred cubic lattice, off the wall and jittered, so that one Delaunay run over surface and
//! lattice leaves only the layer at the wall to improve.

use super::delaunay::hash;
use crate::geometry::{Point3, Vec3, point_triangle};
use crate::mesh::TriMesh;
use rustc_hash::FxHashSet;

/// Jitter of a lattice point, as a part of the cell.
const JITTER: f64 = 0.02;

/// Lattice indices stay below this magnitude, so that three of them pack into 63 bits.
const MAX_INDEX: f64 = 1_000_000.0;

/// Most lattice points tested near the wall and most points made: a cell far too small for its surface gives fewer.
const MAX_POINTS: usize = 50_000_000;

/// Mean edge length of a surface.
pub fn mean_edge(surface: &TriMesh) -> f64 {
    let mut sum = 0.0;
    for t in &surface.triangles {
        let [a, b, c] = t.map(|v| surface.points[v as usize]);
        sum += (b - a).norm() + (c - b).norm() + (a - c).norm();
    }
    sum / (3 * surface.triangles.len()).max(1) as f64
}

/// A body-centred cubic lattice: index `2 i` along each axis for corners, `2 i + 1` for centres, in half cells.
struct Lattice {
    origin: Point3,
    half: f64,
}

impl Lattice {
    /// The jittered place of a lattice point.
    fn place(&self, index: [i64; 3]) -> Point3 {
        let base = self.origin + Vec3::new(index[0] as f64, index[1] as f64, index[2] as f64) * self.half;
        let h = hash(pack(index));
        let coin = |shift: u32| ((h >> shift) & 0x1f_ffff) as f64 / f64::from(0x10_0000) - 1.0;
        base + Vec3::new(coin(0), coin(21), coin(42)) * (2.0 * JITTER * self.half)
    }

    /// Whether the three indices are all even or all odd.
    fn is_site(i: i64, j: i64, k: i64) -> bool {
        (i & 1) == (j & 1) && (j & 1) == (k & 1)
    }
}

fn pack([i, j, k]: [i64; 3]) -> u64 {
    let part = |x: i64| (x + (1 << 20)) as u64 & 0x1f_ffff;
    part(i) | (part(j) << 21) | (part(k) << 42)
}

/// Points of a body-centred cubic lattice with cubes of side `cell`, inside the closed `surface` and at least
/// `clearance` from it. The same surface gives the same points. Inside is decided along one scan line per column; a
/// line that grazes an edge may leave points out or take in points outside, which carving drops.
pub fn lattice_points(surface: &TriMesh, cell: f64, clearance: f64) -> Vec<Point3> {
    let Some(first) = surface.points.first() else { return Vec::new() };
    let (mut low, mut high) = (*first, *first);
    for p in &surface.points {
        low = low.inf(p);
        high = high.sup(p);
    }
    let half = cell / 2.0;
    let usable = cell > 0.0 && half.is_finite() && (high - low).max() / half < MAX_INDEX;
    if !usable {
        return Vec::new();
    }
    let lattice = Lattice { origin: low, half };
    let crossings = column_crossings(surface, &lattice);
    let near = near_wall(surface, &lattice, clearance);
    fill_columns(&lattice, &crossings, &near)
}

/// Where the columns of lattice points (along z) pass through the surface: packed column and height, sorted.
fn column_crossings(surface: &TriMesh, lattice: &Lattice) -> Vec<(u64, f64)> {
    let mut crossings = Vec::new();
    for t in &surface.triangles {
        let [a, b, c] = t.map(|v| (surface.points[v as usize] - lattice.origin) / lattice.half);
        let range = |k: usize| {
            let (lo, hi) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            (lo - 0.01).ceil() as i64..=(hi + 0.01).floor() as i64
        };
        let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if area == 0.0 {
            continue;
        }
        for i in range(0) {
            for j in range(1).filter(|j| (i & 1) == (j & 1)) {
                // A fixed odd offset keeps the lines off the surface's own grid.
                let (x, y) = (i as f64 + 1.37e-4, j as f64 + 2.11e-4);
                let u = ((b.x - x) * (c.y - y) - (b.y - y) * (c.x - x)) / area;
                let v = ((c.x - x) * (a.y - y) - (c.y - y) * (a.x - x)) / area;
                let w = 1.0 - u - v;
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    crossings.push((pack([i, j, 0]), u * a.z + v * b.z + w * c.z));
                }
            }
        }
        if crossings.len() > MAX_POINTS {
            break;
        }
    }
    crossings.sort_unstable_by(|p, q| p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)));
    crossings
}

/// The lattice points closer than `clearance` to the surface, packed.
fn near_wall(surface: &TriMesh, lattice: &Lattice, clearance: f64) -> FxHashSet<u64> {
    let mut near = FxHashSet::default();
    let reach = clearance / lattice.half + 2.0 * JITTER * 2.0;
    for t in &surface.triangles {
        let corners = t.map(|v| surface.points[v as usize]);
        let [a, b, c] = corners.map(|p| (p - lattice.origin) / lattice.half);
        let range = |k: usize| {
            let (lo, hi) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            (lo - reach).ceil() as i64..=(hi + reach).floor() as i64
        };
        for i in range(0) {
            for j in range(1).filter(|j| (i & 1) == (j & 1)) {
                for k in range(2).filter(|&k| Lattice::is_site(i, j, k)) {
                    let key = pack([i, j, k]);
                    if !near.contains(&key) && distance(&lattice.place([i, j, k]), &corners) < clearance {
                        near.insert(key);
                    }
                }
            }
        }
        if near.len() > MAX_POINTS {
            break;
        }
    }
    near
}

fn fill_columns(lattice: &Lattice, crossings: &[(u64, f64)], near: &FxHashSet<u64>) -> Vec<Point3> {
    let mut points = Vec::new();
    for column in crossings.chunk_by(|p, q| p.0 == q.0) {
        let unpack = |shift: u32| ((column[0].0 >> shift) & 0x1f_ffff) as i64 - (1 << 20);
        let (i, j) = (unpack(0), unpack(21));
        for pair in column.chunks_exact(2) {
            let (from, to) = (pair[0].1.ceil() as i64, pair[1].1.floor() as i64);
            for k in (from..=to).filter(|&k| Lattice::is_site(i, j, k)) {
                if !near.contains(&pack([i, j, k])) && points.len() < MAX_POINTS {
                    points.push(lattice.place([i, j, k]));
                }
            }
        }
    }
    points
}

fn distance(p: &Point3, t: &[Point3; 3]) -> f64 {
    point_triangle(p, t.each_ref()).1
}
