//! Minimization of a convex function of one variable.

/// Value of a function, its argument, and a payload.
pub type Sample = (f64, f64, f64);

/// Minimum of a convex function by golden section, to about 1e-9 of the range. Stops early if the function cannot be
/// below `enough` or cannot fall further; the value is then the least one seen.
pub fn minimise_convex(at: impl Fn(f64) -> Sample, [low, high]: [f64; 2], enough: f64) -> Sample {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let inner = [high - ratio * (high - low), low + ratio * (high - low)];
    let mut points = [at(low), at(inner[0]), at(inner[1]), at(high)];
    // 0.618^44 < 1e-9.
    for _ in 0..44 {
        let best = least(&points);
        let floor = lower_bound(&points);
        if floor >= enough || best.0 - floor <= 1e-12 * best.0.abs() {
            return best;
        }
        let [a, b, c, d] = points;
        points = if b.0 <= c.0 {
            [a, at(c.1 - ratio * (c.1 - a.1)), b, c]
        } else {
            [b, c, at(b.1 + ratio * (d.1 - b.1)), d]
        };
    }
    least(&points)
}

fn least(points: &[Sample; 4]) -> Sample {
    points.iter().copied().fold(points[0], |best, p| if p.0 < best.0 { p } else { best })
}

/// Lower bound of a convex function between the first and last of four points, from its chords.
fn lower_bound(&[a, b, c, d]: &[Sample; 4]) -> f64 {
    let slope = |p: Sample, q: Sample| if q.1 > p.1 { (q.0 - p.0) / (q.1 - p.1) } else { 0.0 };
    let (first, middle, last) = (slope(a, b), slope(b, c), slope(c, d));
    let before = b.0 - middle.max(0.0) * (b.1 - a.1);
    let after = c.0 + middle.min(0.0) * (d.1 - c.1);
    // Between the inner two: above the extended chords on either side.
    let between = if first < 0.0 && last > 0.0 {
        let x = ((c.0 - b.0 - last * c.1 + first * b.1) / (first - last)).clamp(b.1, c.1);
        (b.0 + first * (x - b.1)).max(c.0 + last * (x - c.1))
    } else {
        b.0.min(c.0)
    };
    before.min(between).min(after)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A sum of distances and a line is convex.
        #[test]
        fn finds_the_least(
            terms in prop::collection::vec((-3.0..3.0_f64, 0.1..2.0_f64, 0.0..2.0_f64), 1..4),
            tilt in -4.0..4.0_f64,
            enough in -2.0..9.0_f64,
        ) {
            let f = |x: f64| {
                let sum: f64 = terms.iter().map(|&(p, k, off)| k * libm::hypot(x - p, off)).sum();
                sum + tilt * x
            };
            let sampled = (0..=4000).map(|i| f(-4.0 + f64::from(i) / 500.0)).fold(f64::INFINITY, f64::min);
            let least = minimise_convex(|x| (f(x), x, 0.0), [-4.0, 4.0], f64::INFINITY);
            prop_assert!(least.0 <= sampled + 1e-9 && (f(least.1) - least.0).abs() < 1e-15, "{least:?} {sampled}");
            let stopped = minimise_convex(|x| (f(x), x, 0.0), [-4.0, 4.0], enough);
            prop_assert!(stopped.0 >= least.0 - 1e-9);
            prop_assert_eq!(stopped.0 < enough, least.0 < enough);
        }
    }
}
