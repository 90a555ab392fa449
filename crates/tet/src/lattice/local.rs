//! Lattices with cubes as large as the nearby triangles of the surface. Each band of edge lengths has its own lattice,
//! kept where the nearest vertex of the surface has edges of that band.

use super::octree::octree_points;
use super::{edges_at_vertices, graded_lattice_points, sites};
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rustc_hash::FxHashMap;

/// Maximum ratio of the edge lengths at the ends of a band.
const BAND: f64 = 1.4;

/// Minimum distance of points of different lattices, in cubes of the coarser one. Within a lattice it is 0.87.
const APART: f64 = 0.62;

const MAX_BANDS: usize = 12;

/// Ratio of edge lengths from which cubes are those of an octree. Each lattice fills the bounding box of the surface.
const WIDE_SPREAD: f64 = 24.0;

/// Points between two checks for cancellation and the budget.
const ASKED_EVERY: usize = 4096;

/// Points of body-centred cubic lattices inside the closed `surface`. Cubes have side `cell`, and points at least
/// `clearance` from the surface, both in nearby edge lengths. Away from the surface cubes are 2, 4, ... times as large.
/// The result is deterministic.
///
/// # Errors
/// [`Stop`] if the watch stops it.
pub fn local_lattice_points(surface: &TriMesh, cell: f64, clearance: f64, watch: &Watch) -> Result<Vec<Point3>, Stop> {
    let sizes = edges_at_vertices(surface);
    if spread(&sizes) > WIDE_SPREAD {
        return octree_points(surface, &sizes, cell, clearance, watch);
    }
    let Some(bands) = Bands::of(&sizes) else {
        let h = surface.mean_edge();
        return graded_lattice_points(surface, cell * h, clearance * h, watch);
    };
    let band: Vec<usize> = sizes.iter().map(|&s| bands.of_size(s)).collect();
    let places: Vec<[f64; 3]> = surface.points.iter().map(|p| [p.x, p.y, p.z]).collect();
    // Building fails only without points or with NaN coordinates.
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&places) else { return Ok(Vec::new()) };
    let size_of = |t: &[u32; 3]| t.iter().map(|&v| sizes[v as usize]).sum::<f64>() / 3.0;
    let mut taken = Taken::new(APART * cell * bands.middle(bands.count - 1));
    let mut points = Vec::new();
    for k in 0..bands.count {
        let near = |t: &[u32; 3]| t.iter().any(|&v| band[v as usize].abs_diff(k) <= 1);
        let clear = |t: &[u32; 3]| near(t).then(|| clearance * size_of(t));
        let side = cell * bands.middle(k);
        let Some((lattice, mut columns)) = sites(surface, side, clear, watch)? else { continue };
        columns.thin(watch)?;
        for (i, p) in columns.places(&lattice).into_iter().enumerate() {
            if i.is_multiple_of(ASKED_EVERY) {
                watch.spend(10 * ASKED_EVERY)?;
            }
            let nearest = tree.query(&[p.x, p.y, p.z]).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize;
            if band[nearest] == k && taken.is_free(&p, APART * side, k) {
                taken.push(&p, k);
                points.push(p);
            }
        }
    }
    Ok(points)
}

/// Ratio of the largest size to the smallest one.
fn spread(sizes: &[f64]) -> f64 {
    let used = sizes.iter().copied().filter(|&s| s > 0.0);
    used.clone().fold(0.0, f64::max) / used.fold(f64::INFINITY, f64::min)
}

/// Bands of edge lengths with equal ratio.
struct Bands {
    low: f64,
    ratio: f64,
    count: usize,
}

impl Bands {
    /// Returns `None` if all lengths are similar.
    fn of(sizes: &[f64]) -> Option<Self> {
        let mut sorted: Vec<f64> = sizes.iter().copied().filter(|&s| s > 0.0).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied();
        let (low, high) = (at(0.04)?, at(0.96)?);
        let spread = high / low;
        if !spread.is_finite() || spread < BAND * BAND.sqrt() {
            return None;
        }
        let count = ((libm::log(spread) / libm::log(BAND)).ceil() as usize).min(MAX_BANDS);
        Some(Self { low, ratio: libm::pow(spread, 1.0 / count as f64), count })
    }

    fn of_size(&self, size: f64) -> usize {
        let k = libm::log(size / self.low) / libm::log(self.ratio);
        (k.max(0.0) as usize).min(self.count - 1)
    }

    /// Length in the middle of a band.
    fn middle(&self, k: usize) -> f64 {
        self.low * libm::pow(self.ratio, k as f64 + 0.5)
    }
}

/// Points made so far, in cubes as wide as the largest distance queried.
struct Taken {
    side: f64,
    cubes: FxHashMap<[i64; 3], Vec<(Point3, usize)>>,
}

impl Taken {
    fn new(side: f64) -> Self {
        Self { side, cubes: FxHashMap::default() }
    }

    fn cube(&self, p: &Point3) -> [i64; 3] {
        [p.x, p.y, p.z].map(|x| (x / self.side).floor() as i64)
    }

    fn push(&mut self, p: &Point3, band: usize) {
        self.cubes.entry(self.cube(p)).or_default().push((*p, band));
    }

    /// True if no point of another band is closer than `distance`.
    fn is_free(&self, p: &Point3, distance: f64, band: usize) -> bool {
        let reach = Vec3::repeat(distance);
        let (low, high) = (self.cube(&(p - reach)), self.cube(&(p + reach)));
        let near = |q: &(Point3, usize)| q.1 != band && (q.0 - p).norm_squared() < distance * distance;
        (low[0]..=high[0]).all(|i| {
            (low[1]..=high[1]).all(|j| {
                (low[2]..=high[2]).all(|k| self.cubes.get(&[i, j, k]).is_none_or(|list| !list.iter().any(near)))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Effort, Interior, Tetrahedralizer};
    use anastomesh_mesh::quality::TetQuality;
    use std::f64::consts::TAU;

    const CORNERS: u32 = 12;

    /// A horn: rings of points with radius growing from 1 and edges in proportion, closed by a vertex at either end.
    fn horn(rings: u32, growth: f64) -> TriMesh {
        let (mut z, mut r) = (0.0, 1.0);
        let mut s = TriMesh::default();
        for k in 0..rings {
            for i in 0..CORNERS {
                let a = TAU * (f64::from(i) + 0.5 * f64::from(k % 2)) / f64::from(CORNERS);
                s.points.push(Point3::new(r * libm::cos(a), r * libm::sin(a), z));
            }
            z += 0.45 * r;
            r *= growth;
        }
        let n = CORNERS * rings;
        s.points.extend([Point3::new(0.0, 0.0, -0.3), Point3::new(0.0, 0.0, z - 0.15 * r)]);
        for k in 0..rings - 1 {
            for i in 0..CORNERS {
                let at = |ring: u32, i: u32| ring * CORNERS + i % CORNERS;
                let [a, b, c, d] = [at(k, i), at(k, i + 1), at(k + 1, i), at(k + 1, i + 1)];
                s.triangles.extend(if k % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] });
            }
        }
        for i in 0..CORNERS {
            let (j, top) = ((i + 1) % CORNERS, n - CORNERS);
            s.triangles.extend([[j, i, n], [top + i, top + j, n + 1]]);
        }
        s
    }

    #[test]
    fn points_lie_as_densely_as_the_surface_nearby() {
        let (cell, clearance) = (1.35, 0.37);
        let s = horn(40, 1.05);
        let points = local_lattice_points(&s, cell, clearance, &Watch::NOBODY).unwrap();
        // Slices as long as wide have similar counts everywhere. 40 rings widen by 1.05⁴⁰ = 7.
        let radius = |z: f64| 1.0 + z * 0.05 / 0.45;
        let widest = radius(s.points[s.points.len() - 1].z);
        let in_slice = |r: f64| points.iter().filter(|p| (0.8..1.25).contains(&(radius(p.z) / r))).count() as f64;
        let (thin, thick) = (in_slice(1.3), in_slice(0.75 * widest));
        assert!(thin > 10.0 && (0.6..1.6).contains(&(thick / thin)), "{thin} {thick}");
        // Distances are not much below those of the local lattice.
        for (i, p) in points.iter().enumerate() {
            let edge = 0.5 * radius(p.z);
            assert!(points[..i].iter().all(|q| (p - q).norm() > 0.5 * 0.87 * cell * edge * 0.8));
        }
        let interior = Interior::Local { cell, clearance };
        let quality =
            TetQuality::of(&Tetrahedralizer::new().effort(Effort::Fast).interior(interior).run(&s).unwrap().mesh);
        assert!(quality.mean > 0.8 && quality.percentile_1 > 0.4, "{quality:?}");
    }

    #[test]
    fn cubes_of_very_different_sizes_are_those_of_an_octree() {
        let (cell, clearance) = (1.35, 0.37);
        let s = horn(100, 1.05);
        assert!(spread(&edges_at_vertices(&s)) > WIDE_SPREAD);
        let points = local_lattice_points(&s, cell, clearance, &Watch::NOBODY).unwrap();
        let radius = |z: f64| 1.0 + z * 0.05 / 0.45;
        let in_slice = |r: f64| points.iter().filter(|p| (0.8..1.25).contains(&(radius(p.z) / r))).count() as f64;
        let counts = [2.0, 8.0, 32.0, 90.0].map(in_slice);
        assert!(counts.iter().all(|&count| count > 10.0 && count < 3.0 * counts[0]), "{counts:?}");
        for (i, p) in points.iter().enumerate() {
            let edge = 0.5 * radius(p.z);
            assert!(points[..i].iter().all(|q| (p - q).norm() > 0.25 * cell * edge), "{p}");
        }
        let interior = Interior::Local { cell, clearance };
        let quality =
            TetQuality::of(&Tetrahedralizer::new().effort(Effort::Fast).interior(interior).run(&s).unwrap().mesh);
        assert!(quality.mean > 0.78 && quality.percentile_1 > 0.4, "{quality:?}");
    }

    #[test]
    fn even_surfaces_get_the_graded_lattice() {
        let s = horn(12, 1.0);
        let h = s.mean_edge();
        let graded = graded_lattice_points(&s, 1.2 * h, 0.4 * h, &Watch::NOBODY);
        assert_eq!(local_lattice_points(&s, 1.2, 0.4, &Watch::NOBODY), graded);
    }
}
