//! Median, 99th percentile and maximum of samples.

use serde::Serialize;

/// Distribution of a quantity over samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Number of samples.
    pub count: usize,
    /// The median.
    pub median: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// Maximum.
    pub worst: f64,
}

impl Spread {
    /// Distribution of any number of values, possibly tens of millions.
    pub(super) fn of(mut values: Vec<f32>) -> Self {
        values.sort_unstable_by(f32::total_cmp);
        let Some(last) = values.len().checked_sub(1) else { return Self::default() };
        let at = |share: f64| f64::from(values[(share * last as f64).round() as usize]);
        Self { count: values.len(), median: at(0.5), p99: at(0.99), worst: at(1.0) }
    }
}
