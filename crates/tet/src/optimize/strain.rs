//! Quality of a tetrahedron, and the penalty (strain) for a bad one.

use crate::complex::Complex;
use anastomesh_mesh::quality::radius_ratio;

/// Radius ratio below which a tetrahedron is strained.
const STRAINED: f64 = 0.5;

/// Weight of the quadratic term, which emphasizes the worst tetrahedra.
const STEEPER: f64 = 0.5;

/// Minimum decrease of the strain for a change.
pub(super) const EASED: f64 = 0.02;

/// Radius ratio of a tetrahedron of real vertices, if positive by the exact predicate.
#[inline]
pub(crate) fn score(c: &Complex, v: &[u32; 4]) -> Option<f64> {
    let [p, q, r, s] = v.map(|i| &c.points[i as usize]);
    (c.orient(v) > 0.0).then(|| radius_ratio(p, q, r, s))
}

/// Penalty of a tetrahedron with this radius ratio. It grows with the logarithm of the ratio below 1/2 and is
/// small above, so that no repair creates more tetrahedra as bad.
#[inline]
pub(crate) fn strain(q: f64) -> f64 {
    let bad = if q < STRAINED { libm::log(STRAINED / q.max(1e-12)) } else { 0.0 };
    bad * (1.0 + STEEPER * bad) + 0.1 * (1.0 - q)
}

/// Radius ratio below which a tetrahedron has more strain than this, if below 1/2.
pub(super) fn ratio_of_strain(strain: f64) -> f64 {
    let bad = ((1.0 + 4.0 * STEEPER * strain.max(0.0)).sqrt() - 1.0) / (2.0 * STEEPER);
    STRAINED * libm::exp(-bad)
}
