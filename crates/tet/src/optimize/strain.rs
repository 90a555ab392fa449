//! How good a tetrahedron is, and how much it asks to be mended.

use crate::complex::Complex;
use anastomesh_mesh::quality::radius_ratio;

/// Radius ratio below which a tetrahedron strains its surroundings.
const STRAINED: f64 = 0.5;

/// How much the worst weigh more than their number.
const STEEPER: f64 = 0.5;

/// Fall of the strain from which a change is worth making.
pub(super) const EASED: f64 = 0.02;

/// Radius ratio of a tetrahedron of real vertices, if it is positive by the exact predicate.
#[inline]
pub(crate) fn score(c: &Complex, v: &[u32; 4]) -> Option<f64> {
    let [p, q, r, s] = v.map(|i| &c.points[i as usize]);
    (c.orient(v) > 0.0).then(|| radius_ratio(p, q, r, s))
}

/// How much a tetrahedron of this radius ratio asks to be mended: its logarithm below one half, and very little above,
/// so that nothing is mended at the cost of more that is as bad.
#[inline]
pub(crate) fn strain(q: f64) -> f64 {
    let bad = if q < STRAINED { (STRAINED / q.max(1e-12)).ln() } else { 0.0 };
    bad * (1.0 + STEEPER * bad) + 0.1 * (1.0 - q)
}

/// The radius ratio below which a tetrahedron has more strain than this, if that is below one half.
pub(super) fn ratio_of_strain(strain: f64) -> f64 {
    let bad = ((1.0 + 4.0 * STEEPER * strain.max(0.0)).sqrt() - 1.0) / (2.0 * STEEPER);
    STRAINED * (-bad).exp()
}
