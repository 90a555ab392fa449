//! Median, 99th percentile and worst of what was looked at.

use serde::Serialize;

/// How a quantity is spread over what was looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// How many places were looked at.
    pub count: usize,
    /// The median.
    pub median: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The largest.
    pub worst: f64,
}

impl Spread {
    /// Of any number of values: there may be tens of millions.
    pub(super) fn of(mut values: Vec<f32>) -> Self {
        values.sort_unstable_by(f32::total_cmp);
        let Some(last) = values.len().checked_sub(1) else { return Self::default() };
        let at = |share: f64| f64::from(values[(share * last as f64).round() as usize]);
        Self { count: values.len(), median: at(0.5), p99: at(0.99), worst: at(1.0) }
    }
}
