//! Shape of tetrahedra and triangles: radius ratio, dihedral and corner angles, and their distribution over a mesh.

mod spokes;

use super::{TET_FACES, TetMesh};
use crate::geometry::{Point3, Vec3};
use nalgebra::{SimdBool, SimdRealField, SimdValue};
use simba::simd::WideF64x4;
use spokes::{LANES, four_corners};

pub(crate) use spokes::Spokes;

/// Number of equal bins over [0, 1] in `TetQuality::histogram`.
pub const HISTOGRAM_BINS: usize = 20;

/// The six edges of a tetrahedron, as pairs of its vertices.
pub const TET_EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Relative roundoff of squared cotangents, except for nearly flat tetrahedra, with a wide margin.
const ROUNDOFF: f64 = 1e-9;

/// Six times the signed volume, `det(b − a, c − a, d − a)` in floating point, so its sign is not exact.
#[inline]
pub fn volume6(a: &Point3, b: &Point3, c: &Point3, d: &Point3) -> f64 {
    (b - a).cross(&(c - a)).dot(&(d - a))
}

/// Radius ratio `3·r_in / R_circ`, with the sign of the volume: 1 for the regular tetrahedron, 0 for a flat one.
#[inline]
pub fn radius_ratio(a: &Point3, b: &Point3, c: &Point3, d: &Point3) -> f64 {
    Spokes::new([a, b, c, d]).radius_ratio()
}

/// True if the radius ratio of a tetrahedron is at least `least`, which is not negative. Without roots in most cases.
#[inline]
pub fn has_ratio([a, b, c, d]: [&Point3; 4], least: f64) -> bool {
    let spokes = Spokes::new([a, b, c, d]);
    spokes.has_ratio(least) || spokes.radius_ratio() >= least
}

/// True if each tetrahedron of a mesh has at least the radius ratio `least`, which is not negative, or is accepted by `or`.
pub fn all_have_ratio(mesh: &TetMesh, least: f64, or: impl Fn([&Point3; 4]) -> bool) -> bool {
    let corners = |t: &[u32; 4]| t.map(|v| &mesh.points[v as usize]);
    let is_good = |corners: [&Point3; 4]| has_ratio(corners, least) || or(corners);
    let (fours, rest) = mesh.tets.as_chunks::<LANES>();
    let are_good = |four: &[[u32; 4]; LANES]| {
        let four = four.each_ref().map(corners);
        Spokes::of_four(&four_corners(&four)).has_ratio(least).all() || four.into_iter().all(is_good)
    };
    fours.iter().all(are_good) && rest.iter().map(corners).all(is_good)
}

/// Radius ratio of a tetrahedron by its corners, in [−1, 1]; negative if inverted.
pub fn tet_ratio([a, b, c, d]: &[Point3; 4]) -> f64 {
    radius_ratio(a, b, c, d)
}

/// Radius ratio of a triangle, 2 r / R of incircle and circumcircle, in [0, 1]; 1 if equilateral.
pub fn triangle_ratio(p: &[Point3; 3]) -> f64 {
    let (a, b, c) = ((p[1] - p[2]).norm(), (p[2] - p[0]).norm(), (p[0] - p[1]).norm());
    // Without the area: 2 r / R = (b+c−a)(c+a−b)(a+b−c) / abc.
    let abc = a * b * c;
    if abc > 0.0 { ((b + c - a) * (c + a - b) * (a + b - c) / abc).max(0.0) } else { 0.0 }
}

/// The six dihedral angles in radians, in the order of `TET_EDGES`; each in [0, π].
pub fn dihedral_angles(corners: [&Point3; 4]) -> [f64; 6] {
    dihedral_sides(corners).map(|[opposite, adjacent]| libm::atan2(opposite, adjacent))
}

/// Opposite and adjacent sides of right triangles with the dihedral angles, in the order of `TET_EDGES`.
fn dihedral_sides(corners: [&Point3; 4]) -> [[f64; 2]; 6] {
    let [a, b, c, d] = corners;
    let normals = TET_FACES.map(|f| {
        let [p, q, r] = f.map(|i| corners[i]);
        (q - p).cross(&(r - p))
    });
    let volume = volume6(a, b, c, d).abs();
    TET_EDGES.map(|[i, j]| {
        // The faces at an edge are opposite the two other vertices. |n₁ × n₂| = |edge| · 6V holds exactly in reals, and
        // does not cancel at angles near 0 or π.
        let [k, l] = opposite_pair(i, j);
        [(corners[j] - corners[i]).norm() * volume, -normals[k].dot(&normals[l])]
    })
}

/// The two vertices of a tetrahedron other than `i` and `j`, in ascending order.
#[inline]
pub fn opposite_pair(i: usize, j: usize) -> [usize; 2] {
    match (i.min(j), i.max(j)) {
        (0, 1) => [2, 3],
        (0, 2) => [1, 3],
        (0, 3) => [1, 2],
        (1, 2) => [0, 3],
        (1, 3) => [0, 2],
        _ => [0, 1],
    }
}

/// Smallest and largest dihedral angle in radians.
pub fn dihedral_range(corners: [&Point3; 4]) -> (f64, f64) {
    let mut cotangents = CotangentRange::default();
    cotangents.include(corners);
    cotangents.angles()
}

/// Range of the cotangents of dihedral angles. They fall from ∞ to −∞ on [0, π], so only the extreme angles are
/// computed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CotangentRange {
    low: f64,
    high: f64,
}

impl Default for CotangentRange {
    fn default() -> Self {
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY }
    }
}

impl CotangentRange {
    fn include(&mut self, corners: [&Point3; 4]) {
        for [opposite, adjacent] in dihedral_sides(corners) {
            // NaN for an edge of length 0 or two faces without area, which `min` and `max` ignore.
            let cotangent = adjacent / opposite;
            (self.low, self.high) = (self.low.min(cotangent), self.high.max(cotangent));
        }
    }

    /// True for tetrahedra that certainly do not widen the range: compares squares, without roots.
    #[inline]
    fn has<T: SimdRealField<Element = f64> + Copy>(&self, spokes: &Spokes<T>) -> T::SimdBool {
        let ([u, v, w], [vw, wu, uv]) = (&spokes.edges, &spokes.crossed);
        let away = -(vw + wu + uv);
        // Faces at the edges of `u`, `v`, `w` and of the three others.
        let adjacent = [wu.dot(uv), vw.dot(uv), vw.dot(wu), uv.dot(&away), wu.dot(&away), vw.dot(&away)];
        let volume = spokes.volume * spokes.volume;
        let squares = [*u, *v, *w, v - u, w - u, w - v].map(|e| e.norm_squared() * volume);
        let bound = |x: f64, roundoff: f64| T::splat(x * x.abs() * (1.0 + roundoff * x.signum()));
        let (low, high) = (bound(self.low, ROUNDOFF), bound(self.high, -ROUNDOFF));
        adjacent.into_iter().zip(squares).fold(Spokes::<T>::truth(), |all, (x, opposite)| {
            let square = -(x * x.simd_abs());
            all & square.simd_gt(low * opposite) & square.simd_lt(high * opposite)
        })
    }

    /// Smallest and largest angle.
    fn angles(self) -> (f64, f64) {
        (libm::atan2(1.0_f64, self.high), libm::atan2(1.0_f64, self.low))
    }
}

/// Vector area of a triangle: along its normal, with its area as length.
#[inline]
pub fn triangle_area_vector(a: &Point3, b: &Point3, c: &Point3) -> Vec3 {
    (b - a).cross(&(c - a)) * 0.5
}

/// Smallest corner angle of a triangle in radians.
pub fn triangle_min_angle(a: &Point3, b: &Point3, c: &Point3) -> f64 {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let area = ab.cross(&ca).norm();
    let corner = |u: &Vec3, v: &Vec3| libm::atan2(area, -u.dot(v));
    corner(&ab, &ca).min(corner(&bc, &ab)).min(corner(&ca, &bc))
}

/// Shape of all tetrahedra of a mesh.
///
/// ```
/// use anastomesh_mesh::{Point3, TetMesh, quality::TetQuality};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let quality = TetQuality::of(&TetMesh { points, tets: vec![[0, 1, 2, 3]] });
/// assert!(quality.min > 0.6 && (quality.dihedral_max - 90.0).abs() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct TetQuality {
    /// Number of tetrahedra.
    pub tets: usize,
    /// Mean radius ratio.
    pub mean: f64,
    /// First percentile of the radius ratio (linear between the two nearest ranks).
    pub percentile_1: f64,
    /// Smallest radius ratio.
    pub min: f64,
    /// Counts of the radius ratio in equal bins over [0, 1]; negative ones are in the first bin.
    pub histogram: [u64; HISTOGRAM_BINS],
    /// Smallest dihedral angle, degrees.
    pub dihedral_min: f64,
    /// Largest dihedral angle, degrees.
    pub dihedral_max: f64,
}

impl TetQuality {
    /// Measures a mesh. A mesh without tetrahedra has zeros everywhere.
    pub fn of(mesh: &TetMesh) -> Self {
        Self::of_tets(mesh, &mesh.tets)
    }

    /// Measures some tetrahedra over the points of a mesh.
    pub fn of_tets(mesh: &TetMesh, tets: &[[u32; 4]]) -> Self {
        let mut ratios = Vec::with_capacity(tets.len());
        let mut sum = QualitySum::default();
        for t in tets {
            let corners = t.map(|v| &mesh.points[v as usize]);
            ratios.push(sum.include(&Spokes::new(corners), corners));
        }
        Self { percentile_1: percentile(&mut ratios, 0.01), ..sum.quality() }
    }
}

/// Number of equal bins over [0, 1] of [`QualitySum`], a multiple of those of `TetQuality`.
pub const FINE_BINS: usize = 400;

const PER_BIN: usize = FINE_BINS / HISTOGRAM_BINS;

/// Shape of the tetrahedra of a piece of a mesh; pieces can be added.
#[derive(Clone, Debug)]
pub struct QualitySum {
    sum: f64,
    min: f64,
    dihedral: CotangentRange,
    /// Counts of the radius ratio in `FINE_BINS` bins; negative ones are in the first.
    bins: Vec<u64>,
}

impl Default for QualitySum {
    fn default() -> Self {
        let dihedral = CotangentRange::default();
        Self { sum: 0.0, min: f64::INFINITY, dihedral, bins: vec![0; FINE_BINS] }
    }
}

impl QualitySum {
    /// Adds a tetrahedron. Returns its radius ratio.
    #[inline]
    pub(crate) fn include(&mut self, spokes: &Spokes, corners: [&Point3; 4]) -> f64 {
        let q = spokes.radius_ratio();
        self.add(q);
        if !self.dihedral.has(spokes) {
            self.dihedral.include(corners);
        }
        q
    }

    #[inline]
    fn add(&mut self, q: f64) {
        // The fine bin lies in the coarse one despite rounding.
        let coarse = ((q * HISTOGRAM_BINS as f64) as usize).min(HISTOGRAM_BINS - 1) * PER_BIN;
        let fine = ((q * FINE_BINS as f64) as usize).clamp(coarse, coarse + PER_BIN - 1);
        self.bins[fine] += 1;
        self.sum += q;
        self.min = self.min.min(q);
    }

    /// Adds tetrahedra. Returns true if all are positive by the exact predicate, and the sum of [`volume6`].
    pub(crate) fn include_all(&mut self, points: &[Point3], tets: &[[u32; 4]]) -> (bool, f64) {
        let corners = |t: &[u32; 4]| t.map(|v| &points[v as usize]);
        let (mut are_positive, mut volume) = (true, 0.0);
        let (fours, rest) = tets.as_chunks::<LANES>();
        for four in fours {
            let four = four.each_ref().map(corners);
            let spokes = Spokes::of_four(&four_corners(&four));
            are_positive &= spokes.are_surely_positive().all() || four.iter().all(|&c| Spokes::new(c).is_positive(c));
            self.include_four(&spokes, &four);
            volume = (0..LANES).fold(volume, |sum, lane| sum + spokes.volume.extract(lane));
        }
        for corners in rest.iter().map(corners) {
            let spokes = Spokes::new(corners);
            are_positive &= spokes.is_positive(corners);
            volume += spokes.volume;
            self.include(&spokes, corners);
        }
        (are_positive, volume)
    }

    #[inline]
    fn include_four(&mut self, spokes: &Spokes<WideF64x4>, four: &[[&Point3; 4]; LANES]) {
        let q = spokes.radius_ratio();
        (0..LANES).for_each(|lane| self.add(q.extract(lane)));
        if !self.dihedral.has(spokes).all() {
            for &corners in four {
                self.dihedral.include(corners);
            }
        }
    }

    /// Shape of all added tetrahedra. The percentile is linear within a bin, so its error is at most a bin's width,
    /// 0.0025. All else is exact, except for the order of summation of the mean.
    pub fn quality(&self) -> TetQuality {
        let tets: u64 = self.bins.iter().sum();
        let (low, high) = if tets == 0 { (0.0, 0.0) } else { self.dihedral.angles() };
        let mut histogram = [0; HISTOGRAM_BINS];
        for (i, &count) in self.bins.iter().enumerate() {
            histogram[i / PER_BIN] += count;
        }
        TetQuality {
            tets: tets as usize,
            mean: self.sum / tets.max(1) as f64,
            percentile_1: self.percentile(0.01, tets),
            min: if tets == 0 { 0.0 } else { self.min },
            histogram,
            dihedral_min: low.to_degrees(),
            dihedral_max: high.to_degrees(),
        }
    }

    /// As [`percentile`], for values known to a bin.
    fn percentile(&self, share: f64, tets: u64) -> f64 {
        let last = tets.saturating_sub(1);
        let rank = share * last as f64;
        let low = self.value_at(rank as u64);
        low + (self.value_at((rank as u64 + 1).min(last)) - low) * rank.fract()
    }

    /// Value of a rank. Values are assumed evenly spread in a bin, and from the smallest on in the first one.
    fn value_at(&self, rank: u64) -> f64 {
        let mut below = 0;
        for (i, &count) in self.bins.iter().enumerate().filter(|(_, count)| **count > 0) {
            if rank < below + count {
                let edge = |i: usize| i as f64 / FINE_BINS as f64;
                let low = if below == 0 { self.min } else { edge(i) };
                return low + (edge(i + 1) - low) * ((rank - below) as f64 + 0.5) / count as f64;
            }
            below += count;
        }
        0.0
    }
}

/// Compact form of a [`QualitySum`]: some hundred bytes.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct QualityPiece {
    sum: f64,
    min: f64,
    /// Range of the cotangents of dihedral angles.
    cotangents: [f64; 2],
    /// Bins up to the last non-empty one, seven bits per byte, lowest first, the eighth set if more follow.
    counts: Vec<u8>,
}

impl QualityPiece {
    /// Smallest radius ratio.
    pub fn min(&self) -> f64 {
        self.min
    }

    /// Smallest dihedral angle in degrees.
    pub fn least_dihedral(&self) -> f64 {
        libm::atan2(1.0_f64, self.cotangents[1]).to_degrees()
    }
}

impl QualitySum {
    /// Converts the sum to its compact form.
    pub fn piece(&self) -> QualityPiece {
        let Some(last) = self.bins.iter().rposition(|&count| count > 0) else { return QualityPiece::default() };
        let mut counts = Vec::with_capacity(last + 16);
        for &count in &self.bins[..=last] {
            let mut left = count;
            while left > 0x7f {
                counts.push((left & 0x7f) as u8 | 0x80);
                left >>= 7;
            }
            counts.push(left as u8);
        }
        // Infinities, which not all formats support, become the largest numbers.
        let finite = |x: f64| x.clamp(f64::MIN, f64::MAX);
        let cotangents = [self.dihedral.low, self.dihedral.high].map(finite);
        QualityPiece { sum: self.sum, min: self.min, cotangents, counts }
    }

    /// Adds a piece. Returns false if it is malformed.
    pub fn add_piece(&mut self, piece: &QualityPiece) -> bool {
        if piece.counts.is_empty() {
            return true;
        }
        let (mut bin, mut count, mut shift) = (0, 0_u64, 0);
        for &byte in &piece.counts {
            let Some(slot) = self.bins.get_mut(bin).filter(|_| shift < 63) else { return false };
            count |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte & 0x80 == 0 {
                *slot += count;
                (bin, count, shift) = (bin + 1, 0, 0);
            }
        }
        self.sum += piece.sum;
        self.min = self.min.min(piece.min);
        self.dihedral.low = self.dihedral.low.min(piece.cotangents[0]);
        self.dihedral.high = self.dihedral.high.max(piece.cotangents[1]);
        true
    }
}

/// The `share`-quantile, linear between the two nearest ranks; 0 for no values. Reorders `values`.
fn percentile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let rank = share * (values.len() - 1) as f64;
    let (_, &mut low, above) = values.select_nth_unstable_by(rank as usize, f64::total_cmp);
    let high = above.iter().copied().reduce(f64::min).unwrap_or(low);
    low + (high - low) * rank.fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn regular() -> [Point3; 4] {
        [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(Point3::from)
    }

    #[test]
    fn the_regular_tetrahedron_is_best() {
        let [a, b, c, d] = regular();
        let sign = volume6(&a, &b, &c, &d).signum();
        assert!((radius_ratio(&a, &b, &c, &d) - sign).abs() < 1e-14);
        let expected = libm::acos(1.0_f64 / 3.0);
        for angle in dihedral_angles([&a, &b, &c, &d]) {
            assert!((angle - expected).abs() < 1e-14);
        }
    }

    proptest! {
        #[test]
        fn ratios_are_compared_as_they_are_computed(
            x in prop::array::uniform4(prop::array::uniform3(-1.0..1.0_f64)), least in 0.0..0.95_f64, unit in -60..60_i32,
        ) {
            let [a, b, c, d] = x.map(|p| Point3::from(p.map(|x| x * 10.0_f64.powi(unit))));
            prop_assert_eq!(has_ratio([&a, &b, &c, &d], least), radius_ratio(&a, &b, &c, &d) >= least);
        }
    }

    #[test]
    fn a_corner_of_a_cube_has_known_values() {
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point3::from);
        // r = 3V/S = (1/2) / (3/2 + √3/2) and R = √3/2.
        let r = 0.5 / (1.5 + 3.0_f64.sqrt() / 2.0);
        let expected = 3.0 * r / (3.0_f64.sqrt() / 2.0);
        assert!((radius_ratio(&a, &b, &c, &d) - expected).abs() < 1e-14);
        let (lo, hi) = dihedral_range([&a, &b, &c, &d]);
        assert!((lo - libm::acos(1.0 / 3.0_f64.sqrt())).abs() < 1e-14);
        assert!((hi - std::f64::consts::FRAC_PI_2).abs() < 1e-14);
    }

    #[test]
    fn a_flat_tetrahedron_is_worthless_and_its_angles_are_0_and_180() {
        let [a, b, c, d] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
        assert!(radius_ratio(&a, &b, &c, &d).abs() < 1e-300);
        let (lo, hi) = dihedral_range([&a, &b, &c, &d]);
        assert!(lo.abs() < 1e-15 && (hi - std::f64::consts::PI).abs() < 1e-15);
        assert!(radius_ratio(&a, &a, &a, &a).abs() < 1e-300);
    }

    #[test]
    fn percentile_is_linear_between_ranks() {
        let mut values: Vec<f64> = (0..=50).rev().map(f64::from).collect();
        assert!((percentile(&mut values, 0.01) - 0.5).abs() < 1e-14);
        assert!(percentile(&mut [], 0.01).abs() < 1e-300);
        assert!((percentile(&mut [3.0], 0.01) - 3.0).abs() < 1e-300);
    }

    #[test]
    fn the_summary_counts_every_tetrahedron_once() {
        let mesh = TetMesh { points: regular().to_vec(), tets: vec![[0, 1, 2, 3], [0, 2, 1, 3]] };
        let quality = TetQuality::of(&mesh);
        assert_eq!(quality.tets, 2);
        assert_eq!(quality.histogram.iter().sum::<u64>(), 2);
        assert!(quality.mean.abs() < 1e-14 && (quality.min + 1.0).abs() < 1e-14);
        assert_eq!(TetQuality::of(&TetMesh::default()).tets, 0);
    }

    #[test]
    fn triangle_angles() {
        let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 3.0_f64.sqrt(), 0.0]].map(Point3::from);
        assert!((triangle_min_angle(&a, &b, &c).to_degrees() - 30.0).abs() < 1e-12);
        assert!((triangle_area_vector(&a, &b, &c) - Vec3::z() * (3.0_f64.sqrt() / 2.0)).norm() < 1e-14);
    }

    proptest! {
        /// The angles at the edges agree with the angle between the faces seen along the edge.
        #[test]
        fn dihedral_angles_agree_with_their_definition(x in prop::array::uniform12(-1.0..1.0_f64)) {
            let p: [Point3; 4] = std::array::from_fn(|i| Point3::new(x[3 * i], x[3 * i + 1], x[3 * i + 2]));
            prop_assume!(volume6(&p[0], &p[1], &p[2], &p[3]).abs() > 1e-4);
            let angles = dihedral_angles([&p[0], &p[1], &p[2], &p[3]]);
            for (n, [i, j]) in TET_EDGES.into_iter().enumerate() {
                let [k, l] = opposite_pair(i, j);
                let e = (p[j] - p[i]).normalize();
                let flat = |q: Point3| { let u = q - p[i]; u - e * u.dot(&e) };
                prop_assert!((flat(p[k]).angle(&flat(p[l])) - angles[n]).abs() < 1e-6);
            }
            let ratio = radius_ratio(&p[0], &p[1], &p[2], &p[3]);
            prop_assert!(ratio.abs() <= 1.0 + 1e-12);
            prop_assert!((ratio + radius_ratio(&p[0], &p[2], &p[1], &p[3])).abs() < 1e-9);
        }
    }
}
