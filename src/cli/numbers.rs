//! Parsers of numeric options.

/// Parses a number.
pub fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "expected a number".into())
}

/// Parses a finite number above zero.
pub fn above_zero(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("expected a finite number above zero".into()) }
}

/// Parses a fraction of at least 0 and below 1.
pub fn fraction(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if (0.0..1.0).contains(&value) { Ok(value) } else { Err("expected a number from 0 to below 1".into()) }
}

/// Parses the number of a region and a value for it, such as `3=0.5`.
pub fn of_region(text: &str) -> Result<(i32, f64), String> {
    let parts = text.split_once('=').and_then(|(id, value)| Some((id.trim().parse().ok()?, number(value).ok()?)));
    parts.ok_or_else(|| "expected the number of a region and a value, as in 3=0.5".into())
}
