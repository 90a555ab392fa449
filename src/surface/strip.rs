//! Triangle strip of least cost between two loops (section 3.2.3, Fig. 6), by dynamic programming.
//!
//! Merging by angle is optimal for regular rings only. The cheapest strip is never worse, and has no folds if a strip
//! without folds exists.

/// One triangle of a strip: a step along one loop and an apex on the other. Fields are positions in the loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// A step along the lower loop.
    Low {
        /// Start of the step.
        from: usize,
        /// End of the step.
        to: usize,
        /// Vertex of the upper loop.
        apex: usize,
    },
    /// A step along the upper loop.
    High {
        /// Start of the step.
        from: usize,
        /// End of the step.
        to: usize,
        /// Vertex of the lower loop.
        apex: usize,
    },
}

impl Step {
    /// Returns the loops' values at the corners of the triangle. Both loops run counter-clockwise about an axis from
    /// the lower to the upper loop. The triangle faces away from the axis.
    pub(crate) fn triangle<T: Copy>(self, low: &[T], high: &[T]) -> [T; 3] {
        match self {
            Self::Low { from, to, apex } => [low[from], low[to], high[apex]],
            Self::High { from, to, apex } => [low[apex], high[to], high[from]],
        }
    }
}

/// Returns the strip of least total `cost` and that cost. The loops have `low` and `high` vertices; lower vertex 0 is
/// joined to upper vertex `first`. The traversed fractions of the loops differ by at most `band`. Returns `None` if no
/// such strip exists.
pub(crate) fn cheapest(
    [low, high]: [usize; 2],
    first: usize,
    band: f64,
    cost: impl Fn(Step) -> f64,
) -> Option<(f64, Vec<Step>)> {
    let step = |i: usize, j: usize, along_low: bool| {
        let (l, h) = (|i: usize| i % low, |j: usize| (first + j) % high);
        if along_low {
            Step::Low { from: l(i - 1), to: l(i), apex: h(j) }
        } else {
            Step::High { from: h(j - 1), to: h(j), apex: l(i) }
        }
    };
    // value[i][j]: cost of the best strip up to the edge from lower i to upper j.
    let width = high + 1;
    let mut value = vec![f64::INFINITY; (low + 1) * width];
    let mut along_low = vec![false; value.len()];
    value[0] = 0.0;
    for i in 0..=low {
        for j in 0..=high {
            if (i, j) == (0, 0) || (i as f64 / low as f64 - j as f64 / high as f64).abs() > band {
                continue;
            }
            let at = i * width + j;
            if i > 0 && value[at - width].is_finite() {
                value[at] = value[at - width] + cost(step(i, j, true));
                along_low[at] = true;
            }
            if j > 0 && value[at - 1].is_finite() {
                let other = value[at - 1] + cost(step(i, j, false));
                if other < value[at] {
                    value[at] = other;
                    along_low[at] = false;
                }
            }
        }
    }
    let total = value[low * width + high];
    if !total.is_finite() {
        return None;
    }
    let mut steps = Vec::with_capacity(low + high);
    let (mut i, mut j) = (low, high);
    while i + j > 0 {
        let by_low = along_low[i * width + j];
        steps.push(step(i, j, by_low));
        if by_low { i -= 1 } else { j -= 1 }
    }
    steps.reverse();
    Some((total, steps))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_takes_every_step_once() {
        for [n, m, first] in [[10, 10, 3], [3, 12, 0], [17, 9, 8], [40, 50, 1]] {
            let even = |s: Step| match s {
                Step::Low { from, apex, .. } => (from as f64 / n as f64 - apex as f64 / m as f64).abs(),
                Step::High { from, apex, .. } => (from as f64 / m as f64 - apex as f64 / n as f64).abs(),
            };
            let (total, steps) = cheapest([n, m], first, 1.0, even).expect("a strip");
            assert!((steps.iter().map(|&s| even(s)).sum::<f64>() - total).abs() < 1e-9 * (1.0 + total));
            let mut low: Vec<usize> =
                steps.iter().filter_map(|s| if let Step::Low { from, .. } = s { Some(*from) } else { None }).collect();
            let mut high: Vec<usize> =
                steps.iter().filter_map(|s| if let Step::High { from, .. } = s { Some(*from) } else { None }).collect();
            low.sort_unstable();
            high.sort_unstable();
            assert_eq!(low, (0..n).collect::<Vec<_>>());
            assert_eq!(high, (0..m).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_strip_is_the_cheapest_of_all() {
        // Every strip between loops of 3 and 4 vertices, as the set of lower-loop steps among all seven.
        let cost = |s: Step| match s {
            Step::Low { to, apex, .. } => ((7 * to + 3 * apex) % 11) as f64,
            Step::High { to, apex, .. } => ((5 * to + 8 * apex) % 13) as f64,
        };
        let mut least = f64::INFINITY;
        for set in (0_u32..1 << 7).filter(|s| s.count_ones() == 3) {
            let (mut i, mut j, mut sum) = (0, 0, 0.0);
            for k in 0..7 {
                if set >> k & 1 == 1 {
                    sum += cost(Step::Low { from: i % 3, to: (i + 1) % 3, apex: j % 4 });
                    i += 1;
                } else {
                    sum += cost(Step::High { from: j % 4, to: (j + 1) % 4, apex: i % 3 });
                    j += 1;
                }
            }
            least = least.min(sum);
        }
        let (total, _) = cheapest([3, 4], 0, 2.0, cost).expect("a strip");
        assert_eq!(total, least);
    }

    #[test]
    fn too_narrow_a_band_has_no_strip() {
        assert!(cheapest([3, 4], 0, 0.0, |_| 1.0).is_none());
    }
}
