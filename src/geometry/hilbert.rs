//! Hilbert curve in three dimensions: an order in which neighbours in the list are neighbours in space.

use super::Point3;

/// Bits per axis of a key.
const BITS: u32 = 20;

/// Position along the Hilbert curve of a cell of a 2^20 grid (Skilling, 'Programming the Hilbert curve', 2004).
pub fn hilbert_key(cell: [u32; 3]) -> u64 {
    let mut x = cell;
    let top = 1u32 << (BITS - 1);
    let mut q = top;
    while q > 1 {
        let p = q - 1;
        for i in 0..3 {
            if x[i] & q != 0 {
                x[0] ^= p;
            } else {
                let t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
        q >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut t = 0;
    let mut q = top;
    while q > 1 {
        if x[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let [a, b, c] = x.map(|v| spread(u64::from(v ^ t)));
    (a << 2) | (b << 1) | c
}

/// Puts two zero bits between any two of the 20 bits of `v`.
fn spread(v: u64) -> u64 {
    let mut v = v & 0x1f_ffff;
    v = (v | (v << 32)) & 0x001f_0000_0000_ffff;
    v = (v | (v << 16)) & 0x001f_0000_ff00_00ff;
    v = (v | (v << 8)) & 0x100f_00f0_0f00_f00f;
    v = (v | (v << 4)) & 0x10c3_0c30_c30c_30c3;
    (v | (v << 2)) & 0x1249_2492_4924_9249
}

/// The Hilbert keys of points, on a grid over their bounding box.
pub fn hilbert_keys(points: &[Point3]) -> Vec<u64> {
    let mut low = Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let mut high = -low;
    for p in points {
        low = low.inf(p);
        high = high.sup(p);
    }
    let size = (high - low).max();
    let cells = f64::from((1u32 << BITS) - 1);
    let scale = if size > 0.0 { cells / size } else { 0.0 };
    let cell = |v: f64| (v * scale).clamp(0.0, cells) as u32;
    points.iter().map(|p| hilbert_key([cell(p.x - low.x), cell(p.y - low.y), cell(p.z - low.z)])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_cells_are_neighbours() {
        let n = 8u32;
        let shift = BITS - 3;
        let mut cells = Vec::new();
        for x in 0..n {
            for y in 0..n {
                for z in 0..n {
                    cells.push((hilbert_key([x << shift, y << shift, z << shift]), [x, y, z]));
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
        assert_eq!(hilbert_keys(&[p, p]), vec![0, 0]);
    }
}
