//! Organ shapes and the distribution of terminals in them.

use super::params::{GenerateError, Organ, TERMINAL_RADIUS, TERMINALS};
use super::random::{Random, Stream};
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Half extents of the organ along x, y, z, relative to the longest (z). Those of the published rat kidney (14.2 × 11.3
/// × 21.8 mm).
pub(super) const SEMI_AXES: [f64; 3] = [0.651, 0.518, 1.0];

/// Longest extent of a rat kidney with `TERMINALS` terminals of radius `TERMINAL_RADIUS`, in µm.
const KIDNEY: f64 = 21_800.0;

/// Inner boundary of the cortex, as a fraction of the radius: the cortex is 44 % of the ellipsoid.
const CORTEX: f64 = 0.80;

/// Terminal density in the medulla relative to the cortex.
const MEDULLA_DENSITY: f64 = 0.02;

/// Radius of the hilum around the inlet, in half axes.
const HILUM: f64 = 0.45;

/// Fraction of the kidney's ellipsoid that a cortex with the same number of terminals would fill. A uniformly filled
/// ellipsoid is smaller.
const FILLED: f64 = 0.46;

/// Maximum displacement of a candidate from the sequence, in distances between neighbours.
const JITTER: f64 = 0.2;

/// Scaled shape.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    organ: Organ,
    axes: Vec3,
    random: Random,
}

impl Organ {
    /// Longest extent of an organ with this number of terminals, in µm. Volume is proportional to the number of
    /// terminals, and lengths are proportional to their radius.
    pub fn usual_size(self, terminals: u32, terminal_radius: f64) -> f64 {
        let kidney = KIDNEY * libm::cbrt(f64::from(terminals) / TERMINALS) * terminal_radius / TERMINAL_RADIUS;
        match self {
            Self::Kidney => kidney,
            Self::Ellipsoid => kidney * libm::cbrt(FILLED),
        }
    }
}

impl Shape {
    pub fn new(organ: Organ, size: f64, random: Random) -> Self {
        Self { organ, axes: Vec3::from(SEMI_AXES) * (0.5 * size), random }
    }

    /// Inlet position: the middle of the side that faces along x.
    pub fn inlet(&self) -> Point3 {
        Point3::new(self.axes.x, 0.0, 0.0)
    }

    /// Relative terminal density at a point, at most 1.
    fn density(&self, p: &Point3) -> f64 {
        let u = p.coords.component_div(&self.axes);
        let m = u.norm();
        if m > 1.0 {
            return 0.0;
        }
        match self.organ {
            Organ::Kidney if (u - Vec3::x()).norm() < HILUM => 0.0,
            Organ::Kidney if m < CORTEX => MEDULLA_DENSITY,
            Organ::Ellipsoid | Organ::Kidney => 1.0,
        }
    }

    /// True if a point lies in a zone with terminals.
    #[cfg(test)]
    pub fn holds(&self, p: &Point3) -> bool {
        self.density(p) > 0.0
    }

    /// Returns `count` points that fill the organ evenly. They are the jittered points inside it of a low-discrepancy
    /// sequence (Roberts 2018: multiples of the powers of the root of x⁴ = x + 1).
    pub fn terminals(&self, count: u32) -> Result<Vec<Point3>, GenerateError> {
        const ROOT: f64 = 1.220_744_084_605_759_5;
        let step = [1.0 / ROOT, 1.0 / (ROOT * ROOT), 1.0 / (ROOT * ROOT * ROOT)];
        let start = [0, 1, 2].map(|axis| self.random.unit(Stream::Start, axis));
        let half = self.axes.z;
        let filled = self.filled();
        let spacing = 2.0 * half * libm::cbrt(filled / f64::from(count));
        let budget = (20.0 * f64::from(count) / filled) as u64 + 1000;
        let mut found = Vec::with_capacity(count as usize);
        for i in 0..budget {
            let p = Point3::from([0, 1, 2].map(|axis| {
                let place = (start[axis] + (i as f64 * step[axis]).fract()).fract();
                let off = self.random.unit(Stream::Jitter, 3 * i + axis as u64) - 0.5;
                half * (2.0 * place - 1.0) + JITTER * spacing * off
            }));
            if self.random.unit(Stream::Zone, i) < self.density(&p) {
                found.push(p);
                if found.len() == count as usize {
                    return Ok(found);
                }
            }
        }
        Err(GenerateError::NoRoom { placed: found.len() as u32, terminals: count })
    }

    /// Fraction of the enclosing cube filled by terminals; sparse zones count by their density.
    fn filled(&self) -> f64 {
        let ellipsoid = std::f64::consts::FRAC_PI_6 * SEMI_AXES[0] * SEMI_AXES[1] * SEMI_AXES[2];
        match self.organ {
            Organ::Ellipsoid => ellipsoid,
            Organ::Kidney => FILLED * ellipsoid,
        }
    }

    /// Mean distance of neighbouring terminals.
    pub fn spacing(&self, count: u32) -> f64 {
        2.0 * self.axes.z * libm::cbrt(self.filled() / f64::from(count))
    }
}
