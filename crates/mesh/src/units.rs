//! Human-readable numbers: counts, sizes, times, positions.

/// Formats a count with thousands separators.
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// Formats a count with its noun, whose plural ends in s.
pub fn counted(count: usize, what: &str) -> String {
    format!("{} {what}{}", grouped(count), if count == 1 { "" } else { "s" })
}

/// Formats a number of tetrahedra.
pub fn tetrahedra(count: usize) -> String {
    if count == 1 { "1 tetrahedron".into() } else { format!("{} tetrahedra", grouped(count)) }
}

/// Formats five significant digits, independent of the unit.
pub fn digits(x: f64) -> String {
    let magnitude = if x == 0.0 { 0.0 } else { libm::log10(x.abs()).floor() };
    if (-3.0..7.0).contains(&magnitude) {
        format!("{x:.*}", (4.0 - magnitude).max(0.0) as usize)
    } else {
        format!("{x:.4e}")
    }
}

/// Formats five significant digits without trailing zeros.
pub fn number(x: f64) -> String {
    let text = digits(x);
    if text.contains('e') { text } else { short(&text) }
}

/// Formats a position with seven digits of its largest coordinate, to be pasted after `--at` or `#at=`.
pub fn place(at: [f64; 3]) -> String {
    let largest = at.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let magnitude = if largest > 0.0 { libm::log10(largest).floor() } else { 0.0 };
    if !(-6.0..12.0).contains(&magnitude) {
        return at.map(|x| format!("{x:.6e}")).join(",");
    }
    let decimals = (6.0 - magnitude).max(0.0) as usize;
    at.map(|x| short(&format!("{x:.decimals$}"))).join(",")
}

/// Removes trailing zeros of a number, and the sign of a resulting zero.
fn short(number: &str) -> String {
    let text = if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number };
    if text == "-0" { "0".into() } else { text.into() }
}

/// Formats a fraction as a percentage.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    if value == 0.0 || value >= 99.95 || (value - value.round()).abs() < 1e-9 {
        format!("{value:.0} %")
    } else {
        format!("{value:.1} %")
    }
}

/// Formats two digits of a number, with its magnitude in words.
pub fn rounded(number: f64) -> String {
    match number {
        n if n >= 1e9 => format!("{:.1} billion", n / 1e9),
        n if n >= 1e6 => format!("{:.1} million", n / 1e6),
        n => grouped((n / 100.0).round() as usize * 100),
    }
}

/// Formats bytes.
pub fn bytes_of(bytes: u64) -> String {
    match bytes as f64 {
        b if b >= 1e10 => format!("{:.0} GB", b / 1e9),
        b if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        b if b >= 1e7 => format!("{:.0} MB", b / 1e6),
        b if b >= 1e6 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.0} kB", (b / 1e3).ceil()),
    }
}

/// Formats a time.
pub fn seconds_of(seconds: f64) -> String {
    match seconds {
        s if s >= 7200.0 => format!("{:.1} h", s / 3600.0),
        s if s >= 120.0 => format!("{:.0} min", s / 60.0),
        s if s >= 10.0 => format!("{s:.0} s"),
        s if s >= 0.1 => format!("{s:.1} s"),
        s => format!("{:.0} ms", (1000.0 * s).ceil()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_shares() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
        assert_eq!([0.0, 1.0, 0.5, 0.0126, 0.9999].map(percent), ["0 %", "100 %", "50 %", "1.3 %", "100 %"]);
    }

    #[test]
    fn places_have_the_digits_that_find_them() {
        assert_eq!(place([699.286_844, 0.0, -151.567_544]), "699.2868,0,-151.5675");
        assert_eq!(place([1e-4, -2.5e-5, 0.0]), "0.0001,-0.000025,0");
        assert_eq!(place([0.0; 3]), "0,0,0");
        assert_eq!(place([1e20, 0.0, -1.0]), "1.000000e20,0.000000e0,-1.000000e0");
        assert_eq!(place([1000.0, -1e-9, 20.0]), "1000,0,20");
    }

    #[test]
    fn sizes_and_times() {
        assert_eq!([counted(1, "file"), counted(2000, "file")], ["1 file", "2,000 files"]);
        let sizes = [12, 1_016_155, 44_500_000, 4_163_000_000, 61_000_000_000].map(bytes_of);
        assert_eq!(sizes, ["1 kB", "1.0 MB", "44 MB", "4.2 GB", "61 GB"]);
        assert_eq!([0.012, 0.3, 12.4, 130.0, 9000.0].map(seconds_of), ["12 ms", "0.3 s", "12 s", "2 min", "2.5 h"]);
        assert_eq!([1234.0, 1.81e8, 2e9].map(rounded), ["1,200", "181.0 million", "2.0 billion"]);
    }
}
