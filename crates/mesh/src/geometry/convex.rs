//! Minimization of a convex function of one variable.

/// Value of a function, its argument, and a payload.
pub type Sample = (f64, f64, f64);

/// Maximum number of samples between the ends.
const SAMPLES: usize = 44;
/// Distance of samples beside the least one, as a share of the range: at first, and in the end.
const BESIDE: [f64; 2] = [1e-6, 1e-9];
/// Factor from each such distance to the next.
const CLOSER: f64 = 0.03;
/// Ratio of the golden section.
const GOLDEN: f64 = 0.381_966_011_250_105_1;

/// Minimum of a convex function by parabolas and golden section, to about 1e-9 of the range. Stops early if the function
/// cannot be below `enough` or cannot fall further; the value is then the least one seen.
///
/// Source: R. P. Brent, Algorithms for Minimization without Derivatives (1973), chapter 5. Samples on both sides of the least
/// one, and lower bounds from chords, replace his stopping rule.
pub fn minimise_convex(at: impl Fn(f64) -> Sample, [low, high]: [f64; 2], enough: f64) -> Sample {
    let step = GOLDEN * (high - low);
    let mut points = [at(low), at(low + step), at(high - step), at(high)];
    let mut beside = BESIDE[0] * (high - low);
    let mut widths = [f64::INFINITY; 2];
    for _ in 0..SAMPLES {
        let floor = lower_bound(&points);
        let (left, best, right) = around_least(&points);
        let width = right.1 - left.1;
        if floor >= enough || best.0 - floor <= 1e-12 * best.0.abs() {
            break;
        }
        if width <= 2.5 * beside {
            if beside <= BESIDE[1] * (high - low) {
                break;
            }
            beside *= CLOSER;
        }
        let is_slow = width > 0.5 * widths[0];
        widths = [widths[1], width];
        let far = if right.1 - best.1 > best.1 - left.1 { right.1 } else { left.1 };
        let vertex = if is_slow { None } else { vertex(left, best, right) };
        let next = vertex.unwrap_or(best.1 + GOLDEN * (far - best.1));
        let next = if (next - best.1).abs() < beside { best.1 + beside.copysign(far - best.1) } else { next };
        if next <= left.1 || next >= right.1 {
            break;
        }
        points = with(&points, at(next));
    }
    least(&points)
}

/// The least of four points with its neighbours, or twice itself at an end.
fn around_least(points: &[Sample; 4]) -> (Sample, Sample, Sample) {
    let i = (1..4).fold(0, |best, i| if points[i].0 < points[best].0 { i } else { best });
    (points[i.saturating_sub(1)], points[i], points[(i + 1).min(3)])
}

/// Argument of the least value of the parabola through three points.
fn vertex(left: Sample, best: Sample, right: Sample) -> Option<f64> {
    let (before, after) = (best.1 - left.1, right.1 - best.1);
    let (falls, rises) = ((left.0 - best.0) / before, (right.0 - best.0) / after);
    let curvature = falls + rises;
    (before > 0.0 && after > 0.0 && curvature > 0.0)
        .then(|| best.1 + 0.5 * (falls * after - rises * before) / curvature)
}

/// Four of five points: the least one, its neighbours, and another.
fn with(points: &[Sample; 4], new: Sample) -> [Sample; 4] {
    let [a, b, c, d] = *points;
    let place = points.partition_point(|p| p.1 < new.1);
    let five = match place {
        0 | 1 => [a, new, b, c, d],
        2 => [a, b, new, c, d],
        _ => [a, b, c, new, d],
    };
    let i = (1..5).fold(0, |best, i| if five[i].0 < five[best].0 { i } else { best });
    if i < 2 || i == 2 && five[3].1 - five[2].1 <= five[2].1 - five[1].1 {
        [five[0], five[1], five[2], five[3]]
    } else {
        [five[1], five[2], five[3], five[4]]
    }
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
