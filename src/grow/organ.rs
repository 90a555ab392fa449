//! Shapes that are filled with terminals, and where in them the terminals are.

use super::params::{GenerateError, Organ, TERMINAL_RADIUS, TERMINALS};
use super::random::{Random, Stream};
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Half the extent of the organ along x, y, z; z is the longest. That of the published rat kidney
/// (14.2 × 11.3 × 21.8 mm).
pub(super) const SEMI_AXES: [f64; 3] = [0.651, 0.518, 1.0];

/// Longest extent of a rat's kidney with so many terminals of such a radius, µm.
const KIDNEY: f64 = 21_800.0;

/// The cortex lies outside this fraction of the way from the centre to the surface: it is 44 % of the ellipsoid.
const CORTEX: f64 = 0.80;

/// Terminals per volume in the medulla, that in the cortex being 1.
const MEDULLA_DENSITY: f64 = 0.02;

/// Radius of the hilum, in units of the half axes, around the point where the vessel enters.
const HILUM: f64 = 0.45;

/// Share of the kidney's ellipsoid that a cortex of the same number of terminals would fill: an ellipsoid filled
/// uniformly is smaller.
const FILLED: f64 = 0.46;

/// How far a candidate may be from its place in the sequence, in distances between neighbours.
const JITTER: f64 = 0.2;

/// A shape at its size.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    organ: Organ,
    axes: Vec3,
    random: Random,
}

impl Organ {
    /// Longest extent of an organ with so many terminals, in µm: volume goes with the number of terminals, and all
    /// lengths with their radius.
    pub fn usual_size(self, terminals: u32, terminal_radius: f64) -> f64 {
        let kidney = KIDNEY * (f64::from(terminals) / TERMINALS).cbrt() * terminal_radius / TERMINAL_RADIUS;
        match self {
            Self::Kidney => kidney,
            Self::Ellipsoid => kidney * FILLED.cbrt(),
        }
    }
}

impl Shape {
    pub fn new(organ: Organ, size: f64, random: Random) -> Self {
        Self { organ, axes: Vec3::from(SEMI_AXES) * (0.5 * size), random }
    }

    /// Where the vessel enters: the middle of the side that looks along x.
    pub fn inlet(&self) -> Point3 {
        Point3::new(self.axes.x, 0.0, 0.0)
    }

    /// Terminals per volume at a point, 1 at most.
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

    /// Whether a point is where terminals are.
    #[cfg(test)]
    pub fn holds(&self, p: &Point3) -> bool {
        self.density(p) > 0.0
    }

    /// So many points that fill the organ evenly: those of a sequence of low discrepancy (Roberts 2018: multiples of the
    /// powers of the root of x⁴ = x + 1) that fall into it, a little off their places.
    pub fn terminals(&self, count: u32) -> Result<Vec<Point3>, GenerateError> {
        const ROOT: f64 = 1.220_744_084_605_759_5;
        let step = [1.0 / ROOT, 1.0 / (ROOT * ROOT), 1.0 / (ROOT * ROOT * ROOT)];
        let start = [0, 1, 2].map(|axis| self.random.unit(Stream::Start, axis));
        let half = self.axes.z;
        let filled = self.filled();
        let spacing = 2.0 * half * (filled / f64::from(count)).cbrt();
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

    /// Share of the cube around the organ that terminals fill; a thin zone counts by its density.
    fn filled(&self) -> f64 {
        let ellipsoid = std::f64::consts::FRAC_PI_6 * SEMI_AXES[0] * SEMI_AXES[1] * SEMI_AXES[2];
        match self.organ {
            Organ::Ellipsoid => ellipsoid,
            Organ::Kidney => FILLED * ellipsoid,
        }
    }

    /// Mean distance of neighbouring terminals.
    pub fn spacing(&self, count: u32) -> f64 {
        2.0 * self.axes.z * (self.filled() / f64::from(count)).cbrt()
    }
}
