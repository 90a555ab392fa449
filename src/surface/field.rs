//! Convolution field of a set of tubes (equation 13 of the paper, in its scale-invariant form).
//!
//! Each tube adds the line integral of a Gaussian along its axis: `exp(−d²/2σ²) · ½ (erf((L−s)/√2σ) + erf(s/√2σ))`.
//! Here σ = κ·r, s is the position along the axis and d the distance from it; r is the radius at s. An infinite tube
//! has the level `exp(−1/2κ²)` at exactly its radius, and pieces of a polyline add up to the whole. The contoured
//! function is the distance form `g = √(−2κ² ln F)`. On one tube it is distance over radius, so the surface is `g = 1`
//! and `g` is almost linear across it.

use rustc_hash::FxHashMap;

use super::SurfaceError;
use super::erf::Table;
use anastomesh_mesh::geometry::{Point3, Tube, Vec3};

/// Contributions below this fraction of the level are neglected.
const NEGLIGIBLE: f64 = 3e-4;
/// Ratio of the mean radius of tubes to their harmonic mean up to which they are alike. Two tubes have it if one is nearly four
/// times as thick.
const ALIKE: f64 = 1.5;
/// Ratio of the mean radius of tubes to the smallest one from which the latter is that of the wall. At the foot of a thin branch on
/// a wide vessel, the share of its kernel tends to zero.
const FOOT: f64 = 6.0;
/// Maximum number of tubes without a search structure, which would cost more than it saves.
const FEW: usize = 6;
/// Maximum deviation of a merged run of tubes from one taper, in radii.
const CHORD_ERROR: f64 = 0.01;
/// Maximum chord of a run, in radii.
const LONGEST_CHORD: f64 = 2.0;
/// Maximum number of tubes in a run. Bounds the run time.
const MOST_MERGED: usize = 64;
/// Pieces of the field that one point visits in the time of an operation of the budget.
const PIECES_PER_OPERATION: u64 = 8;
/// Sums of kernels on an axis between which the tubes get smaller weights, and the sum that remains above the second one. Two
/// tubes that cross have the sum 2; a bifurcation has 1.5, and its wall the right radius.
const CROWDED: [f64; 2] = [2.0, 3.0];
const UNCROWDED: f64 = 1.5;
/// Maximum distance from a crowded end of a tube, in radii, at which it has full weight.
const FADE: f64 = 2.0;
/// Bits per coordinate of a search cell's key.
const KEY_BITS: u32 = 21;

/// One tube, prepared for evaluation.
#[derive(Clone, Copy, Debug)]
struct TaperedSegment {
    a: Point3,
    axis: Vec3,
    length: f64,
    ra: f64,
    slope: f64,
    reach: f64,
    /// Lengths over which the weight rises to 1 from the ends, and what it lacks there; `None` if it is 1 everywhere.
    fade: Option<[Fade; 2]>,
}

/// Weight of a tube near one of its ends.
#[derive(Clone, Copy, Debug)]
struct Fade {
    over: f64,
    lacks: f64,
}

/// Distance form of the convolution field: below 1 inside the vessels, 1 on the wall, above 1 outside.
#[derive(Debug)]
pub struct Field {
    pieces: Vec<TaperedSegment>,
    kappa: f64,
    /// Square of the tube cutoff distance, in radii.
    cutoff2: f64,
    /// Value far from all tubes.
    far: f64,
    erf: &'static Table,
    locator: Option<Locator>,
    /// Pieces visited since the last call of `operations`.
    visited: u64,
}

/// Cached lists of the relevant pieces, one per cell of a coarse grid.
#[derive(Debug)]
struct Locator {
    origin: Point3,
    size: f64,
    cells: FxHashMap<u64, (u32, u32)>,
    blocks: FxHashMap<u64, (u32, u32)>,
    lists: Vec<u32>,
    /// Pieces sorted into lists since this was last reset.
    sorted: u64,
}

impl Field {
    /// Creates the field of `tubes` for the kernel width `kappa` (σ over r).
    ///
    /// # Errors
    /// `InvalidTube` for a coordinate or radius that is not finite or a radius that is not positive. `InvalidParameter`
    /// for a kernel width outside (0, 2]. `Empty` if no tube has a length.
    pub fn new(tubes: &[Tube], kappa: f64) -> Result<Self, SurfaceError> {
        if !(kappa > 0.0 && kappa <= 2.0) {
            return Err(SurfaceError::InvalidParameter { name: "kappa", value: kappa });
        }
        let cutoff2 = 1.0 - 2.0 * kappa * kappa * libm::log(NEGLIGIBLE);
        for (i, t) in tubes.iter().enumerate() {
            let finite = t.a.iter().chain(t.b.iter()).all(|x| x.is_finite()) && t.ra.is_finite() && t.rb.is_finite();
            if !finite || t.ra <= 0.0 || t.rb <= 0.0 {
                return Err(SurfaceError::InvalidTube { tube: i as u32 });
            }
        }
        let reach = cutoff2.sqrt();
        let pieces: Vec<TaperedSegment> = merged(tubes).iter().filter_map(|t| TaperedSegment::new(t, reach)).collect();
        if pieces.is_empty() {
            return Err(SurfaceError::Empty);
        }
        let locator = (pieces.len() > FEW).then(|| Locator::new(&pieces));
        let mut field = Self { pieces, kappa, cutoff2, far: cutoff2.sqrt(), erf: Table::get(), locator, visited: 0 };
        field.thin_out();
        Ok(field)
    }

    /// Reduces the weights of tubes where many of them share a place, as the vessels of a star do. The sum of their
    /// kernels would make a far wider lumen than each of them.
    fn thin_out(&mut self) {
        if self.pieces.len() <= FEW {
            return;
        }
        let ends: Vec<[Point3; 2]> = self.pieces.iter().map(|p| [p.a, p.a + p.axis * p.length]).collect();
        let lacks = ends.iter().map(|ends| ends.map(|end| 1.0 - weight(self.sum(&end)))).collect::<Vec<_>>();
        for (piece, lacks) in self.pieces.iter_mut().zip(lacks).filter(|(_, lacks)| *lacks != [0.0; 2]) {
            let radii = [piece.ra, piece.ra + piece.slope * piece.length];
            let fade = |i: usize| Fade { over: piece.length.min(FADE * radii[i]), lacks: lacks[i] };
            piece.fade = Some([fade(0), fade(1)]);
        }
    }

    /// Sum of the kernels at `p`.
    fn sum(&mut self, p: &Point3) -> f64 {
        let mut sum = 0.0;
        let add = |piece: &TaperedSegment| sum += piece.value(p, self.kappa, self.cutoff2, self.erf);
        self.visited += each_near(&mut self.locator, &self.pieces, p, add);
        sum
    }

    /// Kernel width.
    pub fn kappa(&self) -> f64 {
        self.kappa
    }

    /// Operations since the last call, as counted by budgets.
    pub(crate) fn operations(&mut self) -> usize {
        (std::mem::take(&mut self.visited) / PIECES_PER_OPERATION) as usize
    }

    /// Lower and upper corner of the box outside which every value is the far value.
    pub fn bounds(&self) -> (Point3, Point3) {
        let (mut lo, mut hi) = (self.pieces[0].a, self.pieces[0].a);
        for piece in &self.pieces {
            let b = piece.a + piece.axis * piece.length;
            for i in 0..3 {
                lo[i] = lo[i].min(piece.a[i].min(b[i]) - piece.reach);
                hi[i] = hi[i].max(piece.a[i].max(b[i]) + piece.reach);
            }
        }
        (lo, hi)
    }

    /// Distance form at `p`.
    pub fn value(&mut self, p: &Point3) -> f64 {
        let sum = self.sum(p);
        self.distance(sum)
    }

    /// Distance form at `p` and its gradient (zero far from all tubes and on an axis).
    pub fn value_and_gradient(&mut self, p: &Point3) -> (f64, Vec3) {
        let (mut sum, mut gradient) = (0.0, Vec3::zeros());
        let add = |piece: &TaperedSegment| {
            if let Some((f, g)) = piece.value_and_gradient(p, self.kappa, self.cutoff2, self.erf) {
                sum += f;
                gradient += g;
            }
        };
        self.visited += each_near(&mut self.locator, &self.pieces, p, add);
        let g = self.distance(sum);
        if g >= self.far || g <= 1e-6 {
            return (g, Vec3::zeros());
        }
        (g, gradient * (-self.kappa * self.kappa / (g * sum)))
    }

    /// Mean radius of the tubes near `p`, weighted by the kernel; 0 far from all tubes. Where radii differ much, it is a harmonic
    /// mean, or the radius of the thinnest tube. Edges as long as the mean would cut a thin vessel off where it leaves a wide one.
    pub fn radius(&mut self, p: &Point3) -> f64 {
        let (mut sum, mut radii, mut inverse, mut thinnest) = (0.0, 0.0, 0.0, f64::INFINITY);
        let add = |piece: &TaperedSegment| {
            let (weight, radius) = piece.weight_and_radius(p, self.kappa, self.cutoff2);
            if weight > 0.0 && radius < thinnest {
                thinnest = radius;
            }
            sum += weight;
            radii += weight * radius;
            inverse += weight / radius;
        };
        self.visited += each_near(&mut self.locator, &self.pieces, p, add);
        if sum <= 0.0 {
            return 0.0;
        }
        let (mean, harmonic) = (radii / sum, sum / inverse);
        if mean > FOOT * thinnest {
            return thinnest;
        }
        let excess = mean / (ALIKE * harmonic);
        if excess <= 1.0 { mean } else { harmonic * (ALIKE / (excess * excess)).max(1.0) }
    }

    /// Field of the tubes with at least this radius, with the same weights. `None` for all or none of them.
    pub(super) fn of_wide(&self, least: f64) -> Option<Self> {
        let is_wide = |piece: &&TaperedSegment| piece.ra.min(piece.ra + piece.slope * piece.length) >= least;
        let pieces: Vec<TaperedSegment> = self.pieces.iter().filter(is_wide).copied().collect();
        let locator = (pieces.len() > FEW).then(|| Locator::new(&pieces));
        let is_part = !pieces.is_empty() && pieces.len() < self.pieces.len();
        is_part.then_some(Self { pieces, locator, visited: 0, ..*self })
    }

    /// Largest radius of a tube.
    pub(crate) fn largest_radius(&self) -> f64 {
        self.pieces.iter().map(|p| p.ra.max(p.ra + p.slope * p.length)).fold(0.0, f64::max)
    }

    /// `√(−2κ² ln F)`, between 0 (F ≥ 1) and the far value.
    #[inline]
    fn distance(&self, sum: f64) -> f64 {
        if sum >= 1.0 {
            0.0
        } else if sum <= 0.0 {
            self.far
        } else {
            (-2.0 * self.kappa * self.kappa * libm::log(sum)).sqrt().min(self.far)
        }
    }
}

/// Weight of a tube at a point of its axis with this sum of kernels.
fn weight(sum: f64) -> f64 {
    let [low, high] = CROWDED;
    if sum <= low {
        return 1.0;
    }
    let share = ((sum - low) / (high - low)).min(1.0);
    (low + (UNCROWDED - low) * share) / sum
}

/// Visits the pieces that count near a point, in order. Returns the number of pieces visited or sorted into lists.
#[inline]
fn each_near(
    locator: &mut Option<Locator>,
    pieces: &[TaperedSegment],
    p: &Point3,
    mut visit: impl FnMut(&TaperedSegment),
) -> u64 {
    let Some(locator) = locator else {
        pieces.iter().for_each(visit);
        return pieces.len() as u64;
    };
    let (start, end) = locator.range(pieces, p);
    for &i in &locator.lists[start as usize..end as usize] {
        visit(&pieces[i as usize]);
    }
    u64::from(end - start) + std::mem::take(&mut locator.sorted)
}

/// Replaces runs of short tubes along a polyline by their chord if it stays close. Otherwise each piece of a finely
/// sampled centreline would be evaluated at every nearby point.
fn merged(tubes: &[Tube]) -> Vec<Tube> {
    let mut out = Vec::with_capacity(tubes.len());
    let mut first = 0;
    while first < tubes.len() {
        let mut last = first;
        while last + 1 < tubes.len() && last + 1 - first < MOST_MERGED && is_chord(&tubes[first..=last + 1]) {
            last += 1;
        }
        out.push(Tube { b: tubes[last].b, rb: tubes[last].rb, ..tubes[first] });
        first = last + 1;
    }
    out
}

/// True if consecutive tubes form one straight taper within [`CHORD_ERROR`].
fn is_chord(run: &[Tube]) -> bool {
    let (Some(first), Some(last)) = (run.first(), run.last()) else { return false };
    let chord = last.b - first.a;
    let length = chord.norm();
    let slack = CHORD_ERROR * first.min_radius().min(last.min_radius());
    if length <= 0.0 || length > LONGEST_CHORD * first.ra {
        return false;
    }
    let axis = chord / length;
    let mut before = 0.0;
    run.windows(2).all(|pair| {
        let w = pair[0].b - first.a;
        let s = w.dot(&axis);
        let r = first.ra + (last.rb - first.ra) * s / length;
        let forward = s > before && s < length;
        before = s;
        let on_axis = (w - axis * s).norm() < slack;
        let joined = pair[0].b == pair[1].a;
        forward && joined && on_axis && (pair[0].rb - r).abs() < slack && (pair[1].ra - r).abs() < slack
    })
}

impl TaperedSegment {
    /// Returns `None` for a tube without length; `reach` is the cutoff in radii.
    fn new(t: &Tube, reach: f64) -> Option<Self> {
        let length = t.length();
        (length > 0.0).then(|| Self {
            a: t.a,
            axis: (t.b - t.a) / length,
            length,
            ra: t.ra,
            slope: (t.rb - t.ra) / length,
            reach: t.max_radius() * reach,
            fade: None,
        })
    }

    /// Weight at an axial position, and its derivative.
    #[inline]
    fn weight(&self, s: f64) -> (f64, f64) {
        let Some([start, end]) = &self.fade else { return (1.0, 0.0) };
        let near = |fade: &Fade, at: f64| {
            let share = 1.0 - at.clamp(0.0, fade.over) / fade.over;
            let slope = if at > 0.0 && at < fade.over { fade.lacks / fade.over } else { 0.0 };
            (fade.lacks * share, slope)
        };
        let [(a, up), (b, down)] = [near(start, s), near(end, self.length - s)];
        (1.0 - a - b, up - down)
    }

    /// Offset from the start, axial position, squared distance from the axis, and radius; `None` out of reach.
    #[inline]
    fn locate(&self, p: &Point3, cutoff2: f64) -> Option<(Vec3, f64, f64, f64)> {
        let w = p - self.a;
        let s = w.dot(&self.axis);
        if s < -self.reach || s > self.length + self.reach {
            return None;
        }
        let d2 = (w.norm_squared() - s * s).max(0.0);
        let r = self.ra + self.slope * s.clamp(0.0, self.length);
        (d2 < cutoff2 * r * r).then_some((w, s, d2, r))
    }

    #[inline]
    fn value(&self, p: &Point3, kappa: f64, cutoff2: f64, table: &Table) -> f64 {
        let Some((_, s, d2, r)) = self.locate(p, cutoff2) else { return 0.0 };
        let q = std::f64::consts::FRAC_1_SQRT_2 / (kappa * r);
        let value = libm::exp(-d2 * q * q) * 0.5 * (table.erf((self.length - s) * q) + table.erf(s * q));
        self.weight(s).0 * value
    }

    #[inline]
    fn value_and_gradient(&self, p: &Point3, kappa: f64, cutoff2: f64, table: &Table) -> Option<(f64, Vec3)> {
        let (w, s, d2, r) = self.locate(p, cutoff2)?;
        let q = std::f64::consts::FRAC_1_SQRT_2 / (kappa * r);
        // Relative change of σ along the axis; zero beyond the ends, where the radius is constant.
        let growth = if s > 0.0 && s < self.length { self.slope / r } else { 0.0 };
        let across = libm::exp(-d2 * q * q);
        let (e1, m1) = table.erf_and_slope((self.length - s) * q);
        let (e0, m0) = table.erf_and_slope(s * q);
        let along = 0.5 * (e1 + e0);
        let along_slope = 0.5 * q * (m0 * (1.0 - s * growth) - m1 * (1.0 + (self.length - s) * growth));
        let axial = across * (2.0 * d2 * q * q * growth * along + along_slope);
        let radial = -2.0 * q * q * across * along;
        let (value, gradient) = (across * along, (w - self.axis * s) * radial + self.axis * axial);
        let (weight, growth) = self.weight(s);
        Some((weight * value, gradient * weight + self.axis * (growth * value)))
    }

    /// Kernel value at the distance from the axis segment, and the radius there.
    #[inline]
    fn weight_and_radius(&self, p: &Point3, kappa: f64, cutoff2: f64) -> (f64, f64) {
        let w = p - self.a;
        let s = w.dot(&self.axis).clamp(0.0, self.length);
        let (d2, r) = ((w - self.axis * s).norm_squared(), self.ra + self.slope * s);
        if d2 < cutoff2 * r * r { (libm::exp(-0.5 * d2 / (kappa * kappa * r * r)), r) } else { (0.0, r) }
    }

    /// Distance of `p` from the axis segment.
    fn distance(&self, p: &Point3) -> f64 {
        let w = p - self.a;
        (w - self.axis * w.dot(&self.axis).clamp(0.0, self.length)).norm()
    }
}

impl Locator {
    /// Cells per block edge. A cell's list is selected from its block's, a block's from all pieces.
    const BLOCK: u64 = 8;

    fn new(pieces: &[TaperedSegment]) -> Self {
        let mut reaches: Vec<f64> = pieces.iter().map(|p| p.reach).collect();
        reaches.sort_by(f64::total_cmp);
        let mut lo = pieces[0].a;
        for piece in pieces {
            let b = piece.a + piece.axis * piece.length;
            for i in 0..3 {
                lo[i] = lo[i].min(piece.a[i].min(b[i]) - 2.0 * piece.reach);
            }
        }
        let size = reaches[reaches.len() / 8];
        Self {
            origin: lo,
            size,
            cells: FxHashMap::default(),
            blocks: FxHashMap::default(),
            lists: Vec::new(),
            sorted: 0,
        }
    }

    /// Returns the pieces that reach the cell of `p`, as a range of `lists`.
    fn range(&mut self, pieces: &[TaperedSegment], p: &Point3) -> (u32, u32) {
        let limit = ((1u64 << KEY_BITS) - 1) as f64;
        let c: [u64; 3] =
            std::array::from_fn(|i| ((p[i] - self.origin[i]) / self.size).floor().clamp(0.0, limit) as u64);
        let key = pack(c);
        if let Some(&range) = self.cells.get(&key) {
            return range;
        }
        let block = c.map(|x| x / Self::BLOCK);
        let (start, end) = if let Some(&range) = self.blocks.get(&pack(block)) {
            range
        } else {
            let range = self.pick(pieces, None, block, self.size * Self::BLOCK as f64);
            self.blocks.insert(pack(block), range);
            range
        };
        let range = self.pick(pieces, Some((start, end)), c, self.size);
        self.cells.insert(key, range);
        range
    }

    /// Appends the pieces that reach the cube `cell` of edge `size`, selected from the range `from` or from all.
    fn pick(&mut self, pieces: &[TaperedSegment], from: Option<(u32, u32)>, cell: [u64; 3], size: f64) -> (u32, u32) {
        let center = self.origin + Vec3::from_fn(|i, _| (cell[i] as f64 + 0.5) * size);
        let half = 0.5 * size * 3f64.sqrt() * (1.0 + 1e-9);
        let start = self.lists.len() as u32;
        let (first, last) = from.unwrap_or((0, pieces.len() as u32));
        self.sorted += u64::from(last - first);
        for k in first..last {
            let i = if from.is_some() { self.lists[k as usize] } else { k };
            let piece = &pieces[i as usize];
            // The kernel extends `reach` across and along the axis: √2 covers the corner of that cylinder.
            if piece.distance(&center) <= half + piece.reach * std::f64::consts::SQRT_2 {
                self.lists.push(i);
            }
        }
        (start, self.lists.len() as u32)
    }
}

fn pack(c: [u64; 3]) -> u64 {
    c[0] | c[1] << KEY_BITS | c[2] << (2 * KEY_BITS)
}
