//! Colour scale of values, as codes of limited size.

use serde::Serialize;

/// Range of values that the colours cover.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scale {
    pub low: f64,
    pub high: f64,
    /// True for a logarithmic scale.
    pub logarithmic: bool,
}

impl Scale {
    /// Code of a value, 1 to `most` + 1; 0 if it has no place on the scale.
    pub(super) fn code(&self, value: f64, most: f64) -> i32 {
        let Self { low, high, logarithmic } = *self;
        if !value.is_finite() || low > high || (logarithmic && value <= 0.0) {
            return 0;
        }
        let (above, range) =
            if logarithmic { (libm::log(value / low), libm::log(high / low)) } else { (value - low, high - low) };
        1 + if range > 0.0 { (most * above / range).clamp(0.0, most) as i32 } else { (most / 2.0) as i32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_cover_the_scale() {
        let linear = Scale { low: -2.0, high: 6.0, logarithmic: false };
        assert_eq!([-2.0, 2.0, 6.0, 9.0, f64::NAN].map(|x| linear.code(x, 254.0)), [1, 128, 255, 255, 0]);
        let steep = Scale { low: 0.01, high: 100.0, logarithmic: true };
        assert_eq!([0.01, 1.0, 100.0, 0.0].map(|x| steep.code(x, 254.0)), [1, 128, 255, 0]);
        assert_eq!(Scale { low: 3.0, high: 3.0, logarithmic: true }.code(3.0, 254.0), 128);
        assert_eq!(Scale { low: f64::INFINITY, high: 0.0, logarithmic: true }.code(3.0, 254.0), 0);
    }
}
