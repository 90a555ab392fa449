//! Numbers with three significant digits and their unit.

use anastomesh_mesh::units::grouped;

/// Formats three significant digits, with thousands separators or a power of ten.
pub fn figure(x: f64) -> String {
    let scientific = format!("{x:.2e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    let Ok(exponent @ (-3..9)) = exponent.parse::<i32>() else {
        return if x.is_finite() { format!("{mantissa}e{exponent}") } else { scientific };
    };
    let rounded: f64 = scientific.parse().unwrap_or(x);
    let text = format!("{:.*}", (2 - exponent).max(0) as usize, rounded.abs());
    let (whole, fraction) = text.split_once('.').map_or((&*text, None), |(whole, fraction)| (whole, Some(fraction)));
    let whole = whole.parse().map_or_else(|_| whole.to_owned(), grouped);
    let sign = if rounded < 0.0 { "−" } else { "" };
    fraction.map_or_else(|| format!("{sign}{whole}"), |fraction| format!("{sign}{whole}.{fraction}"))
}

/// Formats a relative error; rounding errors are zero.
pub fn relative(error: f64) -> String {
    figure(if error.abs() < 1e-6 { 0.0 } else { error })
}

/// Length unit of a page.
#[derive(Clone, Copy, Debug, Default)]
pub struct LengthUnit(pub Option<&'static str>);

impl LengthUnit {
    /// Formats a length.
    pub fn length(self, x: f64) -> String {
        self.power(x, "")
    }

    /// Formats a volume.
    pub fn volume(self, x: f64) -> String {
        self.power(x, "³")
    }

    fn power(self, x: f64, power: &str) -> String {
        self.0.map_or_else(|| figure(x), |unit| format!("{} {unit}{power}", figure(x)))
    }

    /// Adds the unit to a column title.
    pub fn title(self, name: &str, power: &str) -> String {
        self.0.map_or_else(|| name.to_owned(), |unit| format!("{name} ({unit}{power})"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_three_digits_and_separators() {
        let cases = [
            (0.0, "0.00"),
            (0.88, "0.880"),
            (99.96, "100"),
            (-1234.5, "−1,230"),
            (1_234_567.0, "1,230,000"),
            (0.001_234, "0.00123"),
            (1.234e-9, "1.23e-9"),
            (9.999e8, "1.00e9"),
            (f64::INFINITY, "inf"),
        ];
        for (x, text) in cases {
            assert_eq!(figure(x), text, "{x}");
        }
        assert_eq!((relative(4e-14), relative(0.4)), ("0.00".into(), "0.400".into()));
        assert_eq!(LengthUnit(Some("µm")).volume(1500.0), "1,500 µm³");
        assert_eq!(LengthUnit::default().title("area", "²"), "area");
    }
}
