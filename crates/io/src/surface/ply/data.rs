//! Data part of a PLY file.

use super::head::{Element, Encoding, Head, Scalar};
use crate::surface::error::SurfaceFault;
use crate::text::Place;
use crate::text::{TextFault, Words};

/// Cursor over the data.
pub(super) enum Data<'a> {
    Text(Words<'a>),
    Binary { bytes: &'a [u8], at: usize, big: bool },
}

impl<'a> Data<'a> {
    /// Starts after the header.
    pub(super) fn new(bytes: &'a [u8], head: &Head) -> Self {
        if head.encoding == Encoding::Text {
            Self::Text(Words::from_line(&bytes[head.end..], head.line))
        } else {
            Self::Binary { bytes, at: head.end, big: head.encoding == Encoding::Big }
        }
    }

    /// Position of the next number.
    pub(super) fn place(&self) -> Place {
        match self {
            Self::Text(words) => Place::Line(words.line()),
            Self::Binary { at, .. } => Place::Byte(*at),
        }
    }

    /// Rejects an element that exceeds the rest of the file.
    pub(super) fn ensure_room(&self, element: &Element) -> Result<(), SurfaceFault> {
        let (encoding, rest) = match self {
            Self::Text(words) => (Encoding::Text, words.rest() as u64 + 1),
            Self::Binary { bytes, at, .. } => (Encoding::Little, (bytes.len() - at) as u64),
        };
        let needed = element.count.saturating_mul(element.least(encoding) as u64);
        if needed <= rest && element.count < u64::from(u32::MAX) {
            return Ok(());
        }
        match self {
            Self::Text(words) => {
                let count = i64::try_from(element.count).unwrap_or(i64::MAX);
                Err(TextFault::CountTooLarge { line: words.line(), what: "the count of an element", count }.into())
            }
            Self::Binary { bytes, at, .. } => {
                Err(SurfaceFault::Length { announced: needed.saturating_add(*at as u64), found: bytes.len() as u64 })
            }
        }
    }

    /// Takes the next number; integers of all types are exact as `f64`.
    #[inline]
    fn number(&mut self, kind: Scalar) -> Result<f64, SurfaceFault> {
        match self {
            Self::Text(words) => {
                let word = words.need("a number")?;
                Ok(words.as_float(word, "a number")?)
            }
            Self::Binary { bytes, at, big } => {
                let end = *at + kind.size();
                let Some(taken) = bytes.get(*at..end) else {
                    return Err(SurfaceFault::Length { announced: end as u64, found: bytes.len() as u64 });
                };
                *at = end;
                Ok(decode(taken, kind, *big))
            }
        }
    }

    /// Takes the next number, which must be an integer.
    pub(super) fn integer(&mut self, kind: Scalar) -> Result<i64, SurfaceFault> {
        if let Self::Text(words) = self {
            return Ok(words.integer("an integer")?);
        }
        let place = self.place();
        let value = self.number(kind)?;
        if value.fract() == 0.0 && value.abs() < 1e15 {
            return Ok(value as i64);
        }
        Err(SurfaceFault::Unexpected { found: format!("{value:?}"), expected: "an integer", place })
    }

    /// Takes the next coordinate.
    pub(super) fn coordinate(&mut self, kind: Scalar, point: usize) -> Result<f64, SurfaceFault> {
        if let Self::Text(words) = self {
            return Ok(words.finite("a coordinate")?);
        }
        let Place::Byte(byte) = self.place() else { return Err(SurfaceFault::Missing { what: "a coordinate" }) };
        let value = self.number(kind)?;
        if value.is_finite() { Ok(value) } else { Err(SurfaceFault::NotFinite { point, byte }) }
    }

    pub(super) fn list_count(&mut self, kind: Scalar) -> Result<i64, SurfaceFault> {
        let place = self.place();
        let count = self.integer(kind)?;
        if count >= 0 {
            return Ok(count);
        }
        Err(SurfaceFault::Unexpected { found: count.to_string(), expected: "the count of a list", place })
    }

    /// Skips numbers.
    pub(super) fn skip(&mut self, kind: Scalar, count: u64) -> Result<(), SurfaceFault> {
        match self {
            Self::Text(words) => {
                for _ in 0..count {
                    words.need("a number")?;
                }
            }
            Self::Binary { bytes, at, .. } => {
                let end = count.saturating_mul(kind.size() as u64).saturating_add(*at as u64);
                if end > bytes.len() as u64 {
                    return Err(SurfaceFault::Length { announced: end, found: bytes.len() as u64 });
                }
                *at = end as usize;
            }
        }
        Ok(())
    }

    /// Checks that no data follow.
    pub(super) fn expect_end(&mut self) -> Result<(), SurfaceFault> {
        match self {
            Self::Text(words) => Ok(words.expect_end()?),
            // Some programs append a line break to binary files.
            Self::Binary { bytes, at, .. } if bytes[*at..].trim_ascii().is_empty() => Ok(()),
            Self::Binary { bytes, at, .. } => {
                Err(SurfaceFault::Length { announced: *at as u64, found: bytes.len() as u64 })
            }
        }
    }
}

/// Decodes a binary number; zero if there are too few bytes, which the caller excludes.
fn decode(taken: &[u8], kind: Scalar, big: bool) -> f64 {
    let mut low = [0_u8; 8];
    for (i, slot) in low[..taken.len()].iter_mut().enumerate() {
        *slot = if big { taken[taken.len() - 1 - i] } else { taken[i] };
    }
    let bits = u64::from_le_bytes(low);
    match kind {
        Scalar::I8 => f64::from(bits as i8),
        Scalar::U8 => f64::from(bits as u8),
        Scalar::I16 => f64::from(bits as i16),
        Scalar::U16 => f64::from(bits as u16),
        Scalar::I32 => f64::from(bits as i32),
        Scalar::U32 => f64::from(bits as u32),
        Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
        Scalar::F64 => f64::from_bits(bits),
    }
}
