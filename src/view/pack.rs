//! Compact integer arrays: differences of neighbours, split into byte planes and compressed.

use anastomesh_mesh::geometry::Point3;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;
use std::io::{self, Write};

/// Position and format of an array.
#[derive(Clone, Debug, Serialize)]
struct Entry {
    name: String,
    /// Number of values.
    count: usize,
    /// Each value is stored as the difference from the value `stride` positions before.
    stride: usize,
    /// Bytes per value.
    planes: usize,
    offset: usize,
}

/// Named arrays.
#[derive(Debug, Default)]
pub struct Pack {
    entries: Vec<Entry>,
    bytes: Vec<u8>,
}

impl Pack {
    /// Adds integers; values at a distance of `stride` are similar.
    pub fn add(&mut self, name: impl Into<String>, values: &[i32], stride: usize) {
        // Zigzag coding: small signed numbers become small unsigned ones.
        let coded = |i: usize| {
            let before = i.checked_sub(stride).map_or(0, |j| values[j]);
            let difference = values[i].wrapping_sub(before);
            ((difference << 1) ^ (difference >> 31)) as u32
        };
        let coded: Vec<u32> = (0..values.len()).map(coded).collect();
        let most = coded.iter().copied().max().unwrap_or(0);
        let planes = (4 - most.leading_zeros() as usize / 8).max(1);
        self.entries.push(Entry { name: name.into(), count: values.len(), stride, planes, offset: self.bytes.len() });
        for plane in 0..planes {
            self.bytes.extend(coded.iter().map(|c| (c >> (8 * plane)) as u8));
        }
    }

    /// Returns the compressed bytes.
    ///
    /// # Errors
    /// Memory is insufficient.
    pub fn compressed(&self) -> io::Result<Vec<u8>> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
        encoder.write_all(&self.bytes)?;
        encoder.finish()
    }

    /// Array descriptions as JSON.
    pub fn entries(&self) -> serde_json::Value {
        serde_json::json!(self.entries)
    }
}

/// Quantization grid for positions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Grid {
    pub origin: [f64; 3],
    /// Step length.
    pub step: f64,
}

impl Grid {
    /// Grid of some points, with this number of steps along the longest side.
    pub fn of<'a>(points: impl Iterator<Item = &'a Point3>, steps: u32) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in points {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
        let side = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let origin = if low[0].is_finite() { low } else { [0.0; 3] };
        Self { origin, step: if side > 0.0 { side / f64::from(steps) } else { 1.0 } }
    }

    /// Quantized positions, three numbers each.
    pub fn steps<'a>(&self, points: impl Iterator<Item = &'a Point3>) -> Vec<i32> {
        points.flat_map(|p| [0, 1, 2].map(|k| ((p[k] - self.origin[k]) / self.step).round() as i32)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Decodes an array as the page does.
    fn read(pack: &Pack, entry: &Entry) -> Vec<i32> {
        let mut values: Vec<i32> = Vec::new();
        for i in 0..entry.count {
            let coded = (0..entry.planes)
                .map(|p| u32::from(pack.bytes[entry.offset + p * entry.count + i]) << (8 * p))
                .sum::<u32>();
            let difference = (coded >> 1) as i32 ^ -((coded & 1) as i32);
            let before = i.checked_sub(entry.stride).map_or(0, |j| values[j]);
            values.push(before.wrapping_add(difference));
        }
        values
    }

    #[test]
    fn what_is_packed_is_read_again() {
        let mut pack = Pack::default();
        let arrays =
            [vec![], vec![7], vec![-3, 4, 1_000_000, -1_000_000, i32::MAX, i32::MIN, 0, 5], vec![1, 2, 3, 2, 3, 4]];
        for (i, values) in arrays.iter().enumerate() {
            pack.add(format!("a{i}"), values, 1 + 2 * (i % 2));
        }
        for (entry, values) in pack.entries.iter().zip(&arrays) {
            assert_eq!(&read(&pack, entry), values);
        }
        assert!(!pack.compressed().unwrap().is_empty());
    }

    #[test]
    fn places_come_back_to_half_a_step() {
        let points = [Point3::new(-1.0, 2.0, 3.0), Point3::new(4.0, 2.5, 3.25)];
        let grid = Grid::of(points.iter(), 65_535);
        let steps = grid.steps(points.iter());
        for (k, step) in steps.iter().enumerate() {
            let back = grid.origin[k % 3] + grid.step * f64::from(*step);
            assert!((back - points[k / 3][k % 3]).abs() <= 0.5 * grid.step + 1e-12 && (0..=65_535).contains(step));
        }
        assert_eq!(Grid::of([].iter(), 9).step, 1.0);
    }
}
