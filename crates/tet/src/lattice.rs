//! Interior points: a jittered body-centred cubic lattice away from the wall. After one Delaunay run over surface and
//! lattice, only the layer at the wall needs improvement. Away from the wall its cubes may grow.

mod local;
mod octree;

pub use local::local_lattice_points;

use super::delaunay::hash;
use super::progress::{Counter, Watch};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Vec3, point_triangle};
use rustc_hash::FxHashMap;

/// Jitter of a lattice point, relative to the cell.
const JITTER: f64 = 0.02;

/// Upper bound of lattice indices, so that three of them pack into 63 bits.
const MAX_INDEX: f64 = 1_000_000.0;

/// Maximum points made. A cell far too small for its surface gives fewer.
const MAX_POINTS: usize = 50_000_000;

/// Steps along the cube diagonals from the outermost points at which cubes become two, four and eight times as large.
const COARSER_AT: [u32; 3] = [3, 8, 16];

/// Mean edge length at every vertex of a surface, smoothed over its neighbours; 0 without edges.
fn edges_at_vertices(surface: &TriMesh) -> Vec<f64> {
    let n = surface.points.len();
    let mut sums = vec![(0.0, 0.0); n];
    for t in &surface.triangles {
        for k in 0..3 {
            let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
            // Every edge lies in two triangles; the second one counts its other end.
            let slot = &mut sums[a];
            *slot = (slot.0 + (surface.points[a] - surface.points[b]).norm(), slot.1 + 1.0);
        }
    }
    let mean = |(sum, count): (f64, f64)| if count > 0.0 { sum / count } else { 0.0 };
    let raw: Vec<f64> = sums.iter().map(|&s| mean(s)).collect();
    let mut even: Vec<(f64, f64)> = raw.iter().map(|&s| (3.0 * s, 3.0)).collect();
    for t in &surface.triangles {
        for k in 0..3 {
            let slot = &mut even[t[k] as usize];
            *slot = (slot.0 + raw[t[(k + 1) % 3] as usize], slot.1 + 1.0);
        }
    }
    even.into_iter().map(mean).collect()
}

/// A body-centred cubic lattice: index `2 i` along each axis for corners, `2 i + 1` for centres, in half cells.
struct Lattice {
    origin: Point3,
    half: f64,
}

impl Lattice {
    /// Jittered position of a lattice point.
    fn place(&self, index: [i64; 3]) -> Point3 {
        let base = self.origin + Vec3::new(index[0] as f64, index[1] as f64, index[2] as f64) * self.half;
        let h = hash(pack(index));
        let coin = |shift: u32| ((h >> shift) & 0x1f_ffff) as f64 / f64::from(0x10_0000) - 1.0;
        base + Vec3::new(coin(0), coin(21), coin(42)) * (2.0 * JITTER * self.half)
    }
}

fn pack([i, j, k]: [i64; 3]) -> u64 {
    let part = |x: i64| (x + (1 << 20)) as u64 & 0x1f_ffff;
    part(i) | (part(j) << 21) | (part(k) << 42)
}

/// Points of a body-centred cubic lattice with cubes of side `cell`, inside the closed `surface` and at least
/// `clearance` from it. The result is deterministic. One scan line per column decides which points are inside; a line
/// that grazes an edge may give wrong points, which carving drops.
///
/// # Errors
/// [`Stop`] if the watch stops it.
pub fn lattice_points(surface: &TriMesh, cell: f64, clearance: f64, watch: &Watch) -> Result<Vec<Point3>, Stop> {
    let sites = sites(surface, cell, |_| Some(clearance), watch)?;
    Ok(sites.map_or_else(Vec::new, |(lattice, columns)| columns.places(&lattice)))
}

/// As [`lattice_points`], with cubes that grow by 2, 4, ... away from the surface.
///
/// # Errors
/// See [`lattice_points`].
pub fn graded_lattice_points(surface: &TriMesh, cell: f64, clearance: f64, watch: &Watch) -> Result<Vec<Point3>, Stop> {
    let Some((lattice, mut columns)) = sites(surface, cell, |_| Some(clearance), watch)? else { return Ok(Vec::new()) };
    columns.thin(watch)?;
    Ok(columns.places(&lattice))
}

/// Lattice and its points inside, off the wall by the clearance of each triangle; `None` if the cell is unusable.
/// Triangles without a clearance are skipped.
///
/// # Errors
/// See [`lattice_points`].
fn sites(
    surface: &TriMesh,
    cell: f64,
    clearance: impl Fn(&[u32; 3]) -> Option<f64>,
    watch: &Watch,
) -> Result<Option<(Lattice, Columns)>, Stop> {
    let Some(first) = surface.points.first() else { return Ok(None) };
    let (mut low, mut high) = (*first, *first);
    for p in &surface.points {
        low = low.inf(p);
        high = high.sup(p);
    }
    let half = cell / 2.0;
    let usable = cell > 0.0 && half.is_finite() && (high - low).max() / half < MAX_INDEX;
    if !usable {
        return Ok(None);
    }
    let lattice = Lattice { origin: low, half };
    let mut columns = Columns::between(&column_crossings(surface, &lattice, watch)?, watch)?;
    clear_wall(surface, &lattice, clearance, &mut columns, watch)?;
    Ok(Some((lattice, columns)))
}

/// Crossings of the lattice columns (along z) with the surface: packed column and height, sorted.
fn column_crossings(surface: &TriMesh, lattice: &Lattice, watch: &Watch) -> Result<Vec<(u64, f64)>, Stop> {
    let mut crossings = Vec::new();
    let mut counter = Counter::new(watch);
    for t in &surface.triangles {
        counter.add(1)?;
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
            counter.add(width(&range(1)))?;
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
    counter.end()?;
    crossings.sort_unstable_by(|p, q| p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)));
    Ok(crossings)
}

/// Number of integers in a range.
fn width(range: &std::ops::RangeInclusive<i64>) -> usize {
    usize::try_from(range.end() - range.start() + 1).unwrap_or(0)
}

/// Removes the points closer to a triangle than its clearance.
fn clear_wall(
    surface: &TriMesh,
    lattice: &Lattice,
    clearance: impl Fn(&[u32; 3]) -> Option<f64>,
    columns: &mut Columns,
    watch: &Watch,
) -> Result<(), Stop> {
    let mut counter = Counter::new(watch);
    for t in &surface.triangles {
        counter.add(1)?;
        let Some(clearance) = clearance(t) else { continue };
        let reach = clearance / lattice.half + 2.0 * JITTER * 2.0;
        let corners = t.map(|v| surface.points[v as usize]);
        let [a, b, c] = corners.map(|p| (p - lattice.origin) / lattice.half);
        let range = |k: usize| {
            let (lo, hi) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            (lo - reach).ceil() as i64..=(hi + reach).floor() as i64
        };
        for i in range(0) {
            for j in range(1).filter(|j| (i & 1) == (j & 1)) {
                let Some(column) = columns.at(i, j) else { continue };
                let parity = i & 1;
                counter.add(width(&range(2)))?;
                for k in range(2).filter(|k| (k & 1) == parity) {
                    if let Some((word, bit)) = column.bit(k >> 1)
                        && columns.bits[word] & bit != 0
                        && point_triangle(&lattice.place([i, j, k]), corners.each_ref()).1 < clearance
                    {
                        columns.bits[word] &= !bit;
                    }
                }
            }
        }
    }
    counter.end()
}

/// Lattice points by columns along z, one bit each: point (i, j, k) is bit `k >> 1` of column (i, j). Its indices k
/// have the parity of i and j.
struct Columns {
    list: Vec<Column>,
    index: FxHashMap<u64, u32>,
    bits: Vec<u64>,
}

/// Words of 64 points each.
#[derive(Clone, Copy)]
struct Column {
    i: i64,
    j: i64,
    /// Index of its first word along z.
    first: i64,
    /// Position and number of its words.
    start: usize,
    words: usize,
}

impl Column {
    /// Word and bit of a point.
    fn bit(&self, n: i64) -> Option<(usize, u64)> {
        let word = (n >> 6) - self.first;
        (0..self.words as i64).contains(&word).then(|| (self.start + word as usize, 1 << (n & 63)))
    }
}

impl Columns {
    /// Points between the first and second, third and fourth, ... crossing of each column.
    fn between(crossings: &[(u64, f64)], watch: &Watch) -> Result<Self, Stop> {
        let mut counter = Counter::new(watch);
        let mut this = Self { list: Vec::new(), index: FxHashMap::default(), bits: Vec::new() };
        let mut count = 0;
        for crossed in crossings.chunk_by(|p, q| p.0 == q.0) {
            let unpack = |shift: u32| ((crossed[0].0 >> shift) & 0x1f_ffff) as i64 - (1 << 20);
            let (i, j) = (unpack(0), unpack(21));
            let parity = i & 1;
            // Range of bits between two heights: k = 2 n + parity.
            let run = |pair: &[(u64, f64)]| {
                let [from, to] = [pair[0].1.ceil() as i64, pair[1].1.floor() as i64];
                ((from - parity + 1) >> 1, (to - parity) >> 1)
            };
            let runs = || crossed.chunks_exact(2).map(run).filter(|(from, to)| from <= to);
            let (Some(from), Some(to)) = (runs().map(|r| r.0).min(), runs().map(|r| r.1).max()) else { continue };
            count += runs().map(|(from, to)| (to - from + 1) as usize).sum::<usize>();
            if count > MAX_POINTS || this.bits.len() > MAX_POINTS / 4 {
                break;
            }
            counter.add(1 + runs().map(|(from, to)| (to - from + 1) as usize).sum::<usize>() / 16)?;
            let (first, start) = (from >> 6, this.bits.len());
            let column = Column { i, j, first, start, words: ((to >> 6) - first + 1) as usize };
            this.bits.resize(start + column.words, 0);
            for (word, bit) in runs().flat_map(|(from, to)| from..=to).filter_map(|n| column.bit(n)) {
                this.bits[word] |= bit;
            }
            this.index.insert(pack([i, j, 0]), this.list.len() as u32);
            this.list.push(column);
        }
        counter.end()?;
        Ok(this)
    }

    fn at(&self, i: i64, j: i64) -> Option<Column> {
        self.index.get(&pack([i, j, 0])).map(|&c| self.list[c as usize])
    }

    /// Points with all eight neighbours in `bits`.
    fn eroded(&self, bits: &[u64]) -> Vec<u64> {
        let mut out = bits.to_vec();
        for column in &self.list {
            for (di, dj) in [(-1, -1), (-1, 1), (1, -1), (1, 1)] {
                let near = self.at(column.i + di, column.j + dj);
                let word = |w: i64| match near {
                    Some(c) if (0..c.words as i64).contains(&(w - c.first)) => bits[c.start + (w - c.first) as usize],
                    _ => 0,
                };
                for (w, slot) in (column.first..).zip(&mut out[column.start..column.start + column.words]) {
                    let here = word(w);
                    // Above and below (k ± 1) are bits n and n − 1 of a neighbour, or n and n + 1.
                    let other =
                        if column.i & 1 == 0 { here << 1 | word(w - 1) >> 63 } else { here >> 1 | word(w + 1) << 63 };
                    *slot &= here & other;
                }
            }
        }
        out
    }

    /// Thins points far from the rim to those of lattices with larger cubes.
    fn thin(&mut self, watch: &Watch) -> Result<(), Stop> {
        let (mut deep, mut depth) = (self.bits.clone(), 0);
        for (level, at) in (1..).zip(COARSER_AT) {
            while depth < at {
                watch.spend(self.list.len() + self.bits.len())?;
                deep = self.eroded(&deep);
                depth += 1;
            }
            if deep.iter().all(|&word| word == 0) {
                return Ok(());
            }
            for column in &self.list {
                let coarse = column.points_of_level(level);
                for word in column.start..column.start + column.words {
                    self.bits[word] &= coarse | !deep[word];
                }
            }
        }
        Ok(())
    }

    fn places(&self, lattice: &Lattice) -> Vec<Point3> {
        let mut points = Vec::with_capacity(self.bits.iter().map(|word| word.count_ones() as usize).sum());
        for column in &self.list {
            let words = &self.bits[column.start..column.start + column.words];
            for (w, &word) in (column.first..).zip(words) {
                let mut left = word;
                while left != 0 {
                    let n = 64 * w + i64::from(left.trailing_zeros());
                    points.push(lattice.place([column.i, column.j, 2 * n + (column.i & 1)]));
                    left &= left - 1;
                }
            }
        }
        points
    }
}

impl Column {
    /// Bit mask of the points of the lattice with cubes `2^level` times as large. Their indices are multiples of
    /// `2^level`: three even multiples or three odd ones.
    fn points_of_level(&self, level: u32) -> u64 {
        let step = 1 << level;
        if self.i % step != 0 || self.j % step != 0 || (self.i ^ self.j) & step != 0 {
            return 0;
        }
        // k = 2 n is a multiple of the step, an even or an odd one.
        let odd = u64::from(self.i & step != 0);
        (0..64).filter(|n| n % step as u64 == odd * (step as u64 / 2)).fold(0, |mask, n| mask | 1 << n)
    }
}
