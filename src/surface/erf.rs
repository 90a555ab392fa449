//! Error function from a table: value and slope at equidistant knots, with cubic interpolation.

use std::sync::LazyLock;

/// Knots per unit.
const PER_UNIT: usize = 64;
/// Beyond this argument the function is 1 to better than 2e-8.
const LIMIT: usize = 4;
/// Knots in the table: one more than the last interval needs.
const KNOTS: usize = PER_UNIT * LIMIT + 1;

/// Value and slope (per knot spacing) at every knot.
static TABLE: LazyLock<Table> = LazyLock::new(Table::new);

/// Tabulated error function: odd, monotone, error at most 2e-8.
#[derive(Debug)]
pub(crate) struct Table {
    knots: Vec<[f64; 2]>,
}

impl Table {
    /// Returns the table, built at its first use.
    pub(crate) fn get() -> &'static Self {
        &TABLE
    }

    fn new() -> Self {
        let step = 1.0 / PER_UNIT as f64;
        let density = |x: f64| std::f64::consts::FRAC_2_SQRT_PI * libm::exp(-x * x);
        let mut value = 0.0;
        let mut knots = Vec::with_capacity(KNOTS);
        for i in 0..KNOTS {
            let x = i as f64 * step;
            knots.push([value, density(x) * step]);
            // Five-point Gauss quadrature integrates the density over one step to full precision.
            value += GAUSS.iter().map(|&(node, weight)| weight * density(x + 0.5 * step * (1.0 + node))).sum::<f64>()
                * 0.5
                * step;
        }
        Self { knots }
    }

    /// `erf(x)`.
    #[inline]
    pub(crate) fn erf(&self, x: f64) -> f64 {
        let u = x.abs() * PER_UNIT as f64;
        let i = u as usize;
        if i >= KNOTS - 1 {
            return 1.0f64.copysign(x);
        }
        let t = u - i as f64;
        let ([y0, m0], [y1, m1]) = (self.knots[i], self.knots[i + 1]);
        let d = y1 - y0;
        (y0 + t * (m0 + t * ((3.0 * d - 2.0 * m0 - m1) + t * (m0 + m1 - 2.0 * d)))).copysign(x)
    }

    /// `erf(x)` and its derivative.
    #[inline]
    pub(crate) fn erf_and_slope(&self, x: f64) -> (f64, f64) {
        let u = x.abs() * PER_UNIT as f64;
        let i = u as usize;
        if i >= KNOTS - 1 {
            return (1.0f64.copysign(x), 0.0);
        }
        let t = u - i as f64;
        let ([y0, m0], [y1, m1]) = (self.knots[i], self.knots[i + 1]);
        let d = y1 - y0;
        let (c2, c3) = (3.0 * d - 2.0 * m0 - m1, m0 + m1 - 2.0 * d);
        let value = y0 + t * (m0 + t * (c2 + t * c3));
        (value.copysign(x), (m0 + t * (2.0 * c2 + t * 3.0 * c3)) * PER_UNIT as f64)
    }
}

/// Nodes and weights of the five-point Gauss–Legendre rule on [−1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

#[cfg(test)]
mod tests {
    use super::Table;

    /// `erf` by its Maclaurin series, good to 1e-12 for |x| < 3.
    fn series(x: f64) -> f64 {
        let (mut term, mut sum) = (x, x);
        for n in 1..120 {
            term *= -x * x / f64::from(n);
            sum += term / f64::from(2 * n + 1);
        }
        sum * std::f64::consts::FRAC_2_SQRT_PI
    }

    #[test]
    fn stays_within_its_error_bound() {
        let table = Table::get();
        for i in -3000..=3000 {
            let x = f64::from(i) * 1e-3;
            let (value, slope) = table.erf_and_slope(x);
            assert!((value - series(x)).abs() < 2e-8, "erf({x})");
            assert!((table.erf(x) - value).abs() < 1e-15);
            assert!((slope - std::f64::consts::FRAC_2_SQRT_PI * libm::exp(-x * x)).abs() < 1e-5, "slope at {x}");
        }
        assert!((table.erf(3.999) - 1.0).abs() < 2e-8);
        assert!((table.erf(-40.0) + 1.0).abs() < 1e-15);
    }
}
