//! Quality of an inner vertex's star as a function of the vertex position.

use super::strain::strain;
use crate::complex::Complex;
use anastomesh_mesh::geometry::{Point3, Vec3, predicates::orient3d};
use anastomesh_mesh::quality::radius_ratio;
use std::cell::Cell;

/// Star of an inner vertex as a function of the vertex's displacement x. Q is the sum of squared edge lengths, V six
/// times the volume, both cheap polynomials in x. The energy is the sum of Q³ / (432 V²) = 1 / (mean ratio)³, at least
/// 1 each.
#[derive(Clone, Debug, Default)]
pub struct StarEnergy {
    pub(super) cells: Vec<Summand>,
    /// Faces opposite the vertex, ordered so that (vertex, f₀, f₁, f₂) is positive.
    pub(super) faces: Vec<[Point3; 3]>,
    /// Attainable radius ratio of each tetrahedron; empty if all are 1.
    pub(super) allowed: Vec<f64>,
    /// Ratios below this count as inverted if `allowed` is set.
    pub(super) least: f64,
    pub(super) tets: Vec<u32>,
    /// Objective of the direct search.
    pub(super) aim: Aim,
    /// Face that rejected the last position. It is tested first, since most positions fail at the same one.
    pub(super) strict: Cell<usize>,
}

/// Objective that the direct search maximizes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Aim {
    /// Worst radius ratio of the star.
    #[default]
    Worst,
    /// Negative strain of the star (see [`super::strain`]), with no radius ratio below this.
    Ease(f64),
}

/// V(x) = height − normal·x, Q(x) = 3 |x − center|² + rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Summand {
    normal: Vec3,
    height: f64,
    center: Vec3,
    rest: f64,
}

impl Summand {
    pub(super) fn new(origin: &Point3, [p, q, r]: &[Point3; 3]) -> Self {
        let (a, b, c) = (p - origin, q - origin, r - origin);
        let normal = (b - a).cross(&(c - a));
        let center = (a + b + c) / 3.0;
        // Spokes: Σ|x − a|² = 3|x − m|² + Σ|a − m|², and three times the latter is the sum over the rim's edges.
        let rim = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
        Self { normal, height: normal.dot(&a), center, rest: rim * (4.0 / 3.0) }
    }

    #[inline]
    pub(super) fn volume(&self, x: &Vec3) -> f64 {
        self.height - self.normal.dot(x)
    }

    #[inline]
    pub(super) fn energy(&self, x: &Vec3) -> f64 {
        let v = self.volume(x);
        if v <= 0.0 {
            return f64::INFINITY;
        }
        let q = 3.0 * (x - self.center).norm_squared() + self.rest;
        q * q * q / (432.0 * v * v)
    }
}

impl StarEnergy {
    /// Gathers the tetrahedra around vertex `v`, none of which may be a ghost.
    pub(super) fn gather(&mut self, c: &Complex, v: u32, tets: &[u32]) {
        let origin = c.points[v as usize];
        self.cells.clear();
        self.faces.clear();
        self.allowed.clear();
        self.tets.clear();
        self.aim = Aim::Worst;
        for &t in tets {
            let Some(i) = c.slot_of(t, v) else { continue };
            let face = c.face(4 * t + i as u32).map(|w| c.points[w as usize]);
            self.cells.push(Summand::new(&origin, &face));
            self.faces.push(face);
            self.tets.push(t);
        }
    }

    pub(super) fn energy(&self, x: &Vec3, limit: f64) -> f64 {
        let mut sum = 0.0;
        for cell in &self.cells {
            sum += cell.energy(x);
            if sum > limit {
                return f64::INFINITY;
            }
        }
        sum
    }

    /// Energy at displacement `x`, and the Newton step from there.
    pub(super) fn newton_step(&self, x: &Vec3) -> (f64, Option<Vec3>) {
        let mut energy = 0.0;
        let mut gradient = Vec3::zeros();
        // Upper triangle of the Hessian: xx, xy, xz, yy, yz, zz.
        let mut hessian = [0.0; 6];
        for cell in &self.cells {
            let v = cell.volume(x);
            let d = x - cell.center;
            let (per_q, per_v) = (1.0 / (3.0 * d.norm_squared() + cell.rest), 1.0 / v);
            let f = per_v * per_v / (432.0 * per_q * per_q * per_q);
            let (dq, dv) = (d * (6.0 * per_q), cell.normal * -per_v);
            let g = dq * 3.0 - dv * 2.0;
            energy += f;
            gradient += g * f;
            // Without the term −3 dq dqᵀ the sum is positive definite; with it, steps are longer but may go uphill.
            let (gf, dvf, diagonal) = (g * f, dv * (2.0 * f), 18.0 * per_q * f);
            hessian[0] += gf.x * g.x + dvf.x * dv.x + diagonal;
            hessian[1] += gf.x * g.y + dvf.x * dv.y;
            hessian[2] += gf.x * g.z + dvf.x * dv.z;
            hessian[3] += gf.y * g.y + dvf.y * dv.y + diagonal;
            hessian[4] += gf.y * g.z + dvf.y * dv.z;
            hessian[5] += gf.z * g.z + dvf.z * dv.z + diagonal;
        }
        (energy, solve_symmetric(hessian, -gradient))
    }

    /// True if no radius ratio is below `least` at displacement `x`, where the vertex is at `p`. The radius ratio is at
    /// least 1 / e, with e the energy of a tetrahedron (Liu, Joe, 'Relationship between tetrahedron shape measures',
    /// 1994). So most ratios are not computed.
    pub(super) fn keeps_above(&self, x: &Vec3, p: &Point3, least: f64) -> bool {
        self.cells
            .iter()
            .zip(&self.faces)
            .all(|(cell, [a, b, c])| cell.energy(x) * least <= 1.0 || radius_ratio(p, a, b, c) >= least)
    }

    pub(super) fn stays_positive(&self, p: &Point3) -> bool {
        self.faces.iter().all(|[a, b, c]| orient3d(p, a, b, c) > 0.0)
    }

    /// Objective with the star's vertex at `p`; any value up to `floor` if it is not above.
    pub(super) fn value(&self, p: &Point3, floor: f64) -> f64 {
        match self.aim {
            Aim::Worst => self.worst(p, floor),
            Aim::Ease(least) => self.ease(p, least, floor),
        }
    }

    /// Radius ratio of the tetrahedron on face `i` with the vertex at `p`, relative to the attainable one.
    #[inline]
    pub(super) fn ratio(&self, p: &Point3, i: usize) -> f64 {
        let [a, b, c] = &self.faces[i];
        let ratio = radius_ratio(p, a, b, c);
        match self.allowed.get(i) {
            None => ratio,
            Some(_) if ratio < self.least => ratio - self.least,
            Some(allowed) => (ratio / allowed).min(1.0),
        }
    }

    pub(super) fn worst(&self, p: &Point3, floor: f64) -> f64 {
        let mut worst = f64::INFINITY;
        for i in self.strictest_first() {
            worst = worst.min(self.ratio(p, i));
            if worst <= floor {
                self.strict.set(i);
                break;
            }
        }
        worst
    }

    /// Face indices, the strictest face first.
    pub(super) fn strictest_first(&self) -> impl Iterator<Item = usize> + use<> {
        let strict = self.strict.get();
        let known = (strict < self.faces.len()).then_some(strict);
        known.into_iter().chain(0..self.faces.len())
    }

    pub(super) fn ease(&self, p: &Point3, least: f64, floor: f64) -> f64 {
        let mut ease = 0.0;
        let strict = self.strict.get();
        if strict < self.faces.len() && self.ratio(p, strict) < least {
            return f64::NEG_INFINITY;
        }
        for i in 0..self.faces.len() {
            let q = self.ratio(p, i);
            if q < least {
                self.strict.set(i);
                return f64::NEG_INFINITY;
            }
            ease -= strain(q);
            if ease <= floor {
                break;
            }
        }
        ease
    }
}

/// Solves a positive definite system, given by its upper triangle row by row, through its cofactors.
fn solve_symmetric([xx, xy, xz, yy, yz, zz]: [f64; 6], b: Vec3) -> Option<Vec3> {
    let first = Vec3::new(yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let (cyy, cyz, czz) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
    let determinant = xx * first.x + xy * first.y + xz * first.z;
    let x = Vec3::new(first.dot(&b), first.y * b.x + cyy * b.y + cyz * b.z, first.z * b.x + cyz * b.y + czz * b.z)
        / determinant;
    (determinant > 0.0 && x.iter().all(|c| c.is_finite())).then_some(x)
}
