//! Units of length on the command line.

use std::str::FromStr;

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    Metre,
    Centimetre,
    Millimetre,
    Micrometre,
}

impl Unit {
    fn of(text: &str) -> Result<Self, String> {
        match text.trim().to_lowercase().as_str() {
            "m" => Ok(Self::Metre),
            "cm" => Ok(Self::Centimetre),
            "mm" => Ok(Self::Millimetre),
            "um" | "µm" | "μm" => Ok(Self::Micrometre),
            other => Err(format!("unknown unit '{other}'; known: m, cm, mm, um")),
        }
    }

    /// Number of units in a metre.
    fn per_metre(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 1e2,
            Self::Millimetre => 1e3,
            Self::Micrometre => 1e6,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Micrometre => "µm",
        }
    }
}

/// Units of the input and of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Units {
    from: Unit,
    to: Unit,
}

impl FromStr for Units {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (from, to) = text.split_once(':').unwrap_or((text, text));
        Ok(Self { from: Unit::of(from)?, to: Unit::of(to)? })
    }
}

impl Units {
    /// Factor on lengths, if the units differ.
    pub fn factor(self) -> Option<f64> {
        let [from, to] = [self.from, self.to].map(Unit::per_metre);
        // The quotient of powers of ten is correctly rounded.
        (self.from != self.to).then(|| to / from)
    }

    /// Names of both.
    pub fn names(self) -> [&'static str; 2] {
        [self.from, self.to].map(Unit::name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_their_quotients() {
        let factor = |text: &str| text.parse::<Units>().map(Units::factor);
        assert_eq!(factor("um"), Ok(None));
        assert_eq!(factor("um:m"), Ok(Some(1e-6)));
        assert_eq!(factor("m:mm"), Ok(Some(1e3)));
        assert_eq!(factor("µm:cm"), Ok(Some(1e-4)));
        assert!(factor("inch").is_err() && factor("um:").is_err() && factor("").is_err());
    }
}
