//! Surfaces and facet complexes, and their files.

use crate::vector::{Vector, turned};
use std::fmt::Write as _;

/// Triangles with a marker each. With regions or holes they are a facet complex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Corners.
    pub points: Vec<Vector>,
    /// Corner numbers.
    pub triangles: Vec<[usize; 3]>,
    /// Marker of each triangle, or none.
    pub markers: Vec<i32>,
    /// Points in regions of a complex, with the number of the region.
    pub regions: Vec<(Vector, i32)>,
    /// Points in holes of a complex.
    pub holes: Vec<Vector>,
}

/// Quadrilaterals of a box, oriented outwards; corner `i` has x, y, z from the bits of `i`.
pub const SIDES: [[usize; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// Box between two corners, twelve triangles oriented outwards.
pub fn cuboid(low: Vector, high: Vector) -> Surface {
    let end = |bit: usize, k: usize| if bit == 0 { low[k] } else { high[k] };
    let points = (0..8).map(|i: usize| [end(i & 1, 0), end((i >> 1) & 1, 1), end(i >> 2, 2)]).collect();
    let triangles = SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Surface { points, triangles, ..Surface::default() }
}

/// Sphere of bands with `n` steps of latitude and `2 n` of longitude.
pub fn sphere(n: usize) -> Surface {
    let mut points = vec![[0.0, 0.0, 1.0]];
    for i in 1..n {
        let theta = std::f64::consts::PI * i as f64 / n as f64;
        for j in 0..2 * n {
            let phi = std::f64::consts::PI * j as f64 / n as f64;
            points.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
        }
    }
    points.push([0.0, 0.0, -1.0]);
    let (ring, last) = (2 * n, points.len() - 1);
    let at = |i: usize, j: usize| 1 + (i - 1) * ring + j % ring;
    let mut triangles = Vec::new();
    for j in 0..ring {
        triangles.push([0, at(1, j), at(1, j + 1)]);
        triangles.push([last, at(n - 1, j + 1), at(n - 1, j)]);
        for i in 1..n - 1 {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    Surface { points, triangles, ..Surface::default() }
}

impl Surface {
    /// Adds the points and triangles of another surface.
    pub fn add(&mut self, other: &Self) {
        let first = self.points.len();
        self.points.extend(&other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        self.markers.extend(&other.markers);
        self.regions.extend(&other.regions);
        self.holes.extend(&other.holes);
    }

    /// Surface with all points (also of regions and holes) mapped.
    pub fn map(mut self, map: impl Fn(Vector) -> Vector) -> Self {
        let regions = self.regions.iter_mut().map(|(point, _)| point);
        self.points.iter_mut().chain(regions).chain(&mut self.holes).for_each(|p| *p = map(*p));
        self
    }

    /// Surface in a turned frame.
    pub fn turn(self, frame: &[Vector; 3]) -> Self {
        self.map(|p| turned(p, frame))
    }

    /// Surface with all triangles inverted.
    pub fn inverted(mut self) -> Self {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    /// Surface with one marker.
    pub fn marked(mut self, marker: i32) -> Self {
        self.markers = vec![marker; self.triangles.len()];
        self
    }

    /// Surface with the selected triangles and their points.
    pub fn with_triangles(&self, kept: &[bool]) -> Self {
        let mut number = vec![usize::MAX; self.points.len()];
        let mut out = Self { regions: self.regions.clone(), holes: self.holes.clone(), ..Self::default() };
        for (i, triangle) in self.triangles.iter().enumerate().filter(|(i, _)| kept[*i]) {
            for &v in triangle {
                if number[v] == usize::MAX {
                    number[v] = out.points.len();
                    out.points.push(self.points[v]);
                }
            }
            out.triangles.push(triangle.map(|v| number[v]));
            out.markers.extend(self.markers.get(i));
        }
        out
    }

    /// Surface in which vertex `b` is vertex `a`; triangles with both are removed.
    pub fn collapsed(&self, a: usize, b: usize) -> Self {
        let mut out = self.clone();
        out.triangles.iter_mut().flatten().filter(|v| **v == b).for_each(|v| *v = a);
        let kept: Vec<bool> = out.triangles.iter().map(|[a, b, c]| a != b && b != c && c != a).collect();
        out.with_triangles(&kept)
    }

    /// Number of the connected component of each triangle.
    pub fn components(&self) -> Vec<usize> {
        let mut root: Vec<usize> = (0..self.points.len()).collect();
        for &[a, b, c] in &self.triangles {
            for v in [b, c] {
                let (x, y) = (find(&mut root, a), find(&mut root, v));
                root[x] = y;
            }
        }
        self.triangles.iter().map(|t| find(&mut root, t[0])).collect()
    }

    /// OFF file with every bit of every number.
    pub fn off(&self) -> String {
        let mut out = format!("OFF\n{} {} 0\n", self.points.len(), self.triangles.len());
        for [x, y, z] in &self.points {
            let _ = writeln!(out, "{x:?} {y:?} {z:?}");
        }
        for [a, b, c] in &self.triangles {
            let _ = writeln!(out, "3 {a} {b} {c}");
        }
        out
    }

    /// Facet complex in the format of TetGen's `.poly`, counted from 0.
    pub fn poly(&self) -> String {
        let mut out = format!("{} 3 0 0\n", self.points.len());
        for (i, [x, y, z]) in self.points.iter().enumerate() {
            let _ = writeln!(out, "{i} {x:?} {y:?} {z:?}");
        }
        let _ = writeln!(out, "{} 1", self.triangles.len());
        for (i, [a, b, c]) in self.triangles.iter().enumerate() {
            let _ = writeln!(out, "1 0 {}\n3 {a} {b} {c}", self.markers.get(i).copied().unwrap_or(1));
        }
        let _ = writeln!(out, "{}", self.holes.len());
        for (i, [x, y, z]) in self.holes.iter().enumerate() {
            let _ = writeln!(out, "{i} {x:?} {y:?} {z:?}");
        }
        let _ = writeln!(out, "{}", self.regions.len());
        for (i, ([x, y, z], number)) in self.regions.iter().enumerate() {
            let _ = writeln!(out, "{i} {x:?} {y:?} {z:?} {number}");
        }
        out
    }
}

/// Root of a vertex in a union-find forest.
fn find(root: &mut [usize], mut v: usize) -> usize {
    while root[v] != v {
        root[v] = root[root[v]];
        v = root[v];
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_closed() {
        let sphere = sphere(4);
        let mut edges = std::collections::BTreeMap::new();
        for &[a, b, c] in &sphere.triangles {
            for [i, j] in [[a, b], [b, c], [c, a]] {
                *edges.entry([i.min(j), i.max(j)]).or_insert(0) += if i < j { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|sum| *sum == 0));
        assert_eq!(sphere.points.len() + sphere.triangles.len(), edges.len() + 2);
    }

    #[test]
    fn components_and_collapses() {
        let mut two = cuboid([0.0; 3], [1.0; 3]);
        two.add(&cuboid([2.0; 3], [3.0; 3]));
        let components = two.components();
        assert_ne!(components[0], components[12]);
        assert_eq!(two.collapsed(0, 1).triangles.len(), 22);
    }
}
