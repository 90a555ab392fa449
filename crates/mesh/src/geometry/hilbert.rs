//! Hilbert curve in three dimensions, an order in which list neighbours are close in space.

use super::Point3;

/// Bits per axis of the keys of [`hilbert_keys`].
const BITS: u32 = 20;

/// `STEPS[3 · e + d][octant]`: position of the octant along the curve that enters its cube at corner `e` and leaves it
/// along axis `d`. From bit 3 on: the row of the curve within the octant (Hamilton, 'Compact Hilbert indices', 2006).
const STEPS: [[u8; 8]; 24] = steps();

const fn steps() -> [[u8; 8]; 24] {
    let mut table = [[0u8; 8]; 24];
    let mut row = 0;
    while row < 24 {
        let (e, d) = (row / 3, row % 3);
        let mut octant = 0;
        while octant < 8 {
            let turned = rotate_right(octant ^ e, d + 1);
            let place = turned ^ (turned >> 1) ^ (turned >> 2);
            let next_e = e ^ rotate_right(entry(place), 2 - d);
            let next_d = (d + direction(place) + 1) % 3;
            table[row][octant] = (place | (3 * next_e + next_d) << 3) as u8;
            octant += 1;
        }
        row += 1;
    }
    table
}

const fn rotate_right(bits: usize, by: usize) -> usize {
    let by = by % 3;
    ((bits >> by) | (bits << (3 - by))) & 7
}

/// Corner at which the curve enters the octant at this position.
const fn entry(place: usize) -> usize {
    if place == 0 { 0 } else { gray(2 * ((place - 1) / 2)) }
}

/// Axis along which the curve crosses the octant at this position.
const fn direction(place: usize) -> usize {
    let odd = if place == 0 {
        0
    } else if place.is_multiple_of(2) {
        place - 1
    } else {
        place
    };
    (odd.trailing_ones() % 3) as usize
}

const fn gray(i: usize) -> usize {
    i ^ (i >> 1)
}

/// Position along the Hilbert curve of a cell of a grid of 2^`bits` cells per axis; the key has `3 · bits` bits.
#[inline]
pub fn hilbert_key([x, y, z]: [u32; 3], bits: u32) -> u64 {
    let mut row = 0;
    let mut key = 0;
    for level in (0..bits).rev() {
        let octant = ((x >> level) & 1) | ((y >> level) & 1) << 1 | ((z >> level) & 1) << 2;
        let step = STEPS[row][octant as usize];
        key = (key << 3) | u64::from(step & 7);
        row = (step >> 3) as usize;
    }
    key
}

/// Grid of cubes over the bounding box of points.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    low: Point3,
    scale: f64,
    last: f64,
}

impl Grid {
    /// Creates a grid of 2^`bits` cells along the longest side of the box.
    pub fn new(points: impl IntoIterator<Item = Point3>, bits: u32) -> Self {
        let mut low = Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let mut high = -low;
        for p in points {
            low = low.inf(&p);
            high = high.sup(&p);
        }
        let size = (high - low).max();
        let last = f64::from((1u32 << bits) - 1);
        Self { low, scale: if size > 0.0 { last / size } else { 0.0 }, last }
    }

    /// Cell that contains the point, or the nearest one.
    #[inline]
    pub fn cell(&self, p: &Point3) -> [u32; 3] {
        let cell = |v: f64| (v * self.scale).clamp(0.0, self.last) as u32;
        [cell(p.x - self.low.x), cell(p.y - self.low.y), cell(p.z - self.low.z)]
    }
}

/// Hilbert keys of points, on a grid over their bounding box.
pub fn hilbert_keys(points: impl Iterator<Item = Point3> + Clone) -> impl Iterator<Item = u64> {
    let grid = Grid::new(points.clone(), BITS);
    points.map(move |p| hilbert_key(grid.cell(&p), BITS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_cells_are_neighbours() {
        let n = 8u32;
        let mut cells = Vec::new();
        for x in 0..n {
            for y in 0..n {
                for z in 0..n {
                    cells.push((hilbert_key([x, y, z], 3), [x, y, z]));
                }
            }
        }
        cells.sort_unstable();
        for w in cells.windows(2) {
            let step: u32 = (0..3).map(|i| w[0].1[i].abs_diff(w[1].1[i])).sum();
            assert_eq!(step, 1, "{w:?}");
        }
    }

    #[test]
    fn equal_points_and_flat_boxes_have_keys() {
        let p = Point3::new(1.0, 2.0, 3.0);
        assert_eq!(hilbert_keys([p, p].into_iter()).collect::<Vec<_>>(), [0, 0]);
    }
}
