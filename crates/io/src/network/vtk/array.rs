//! Arrays of a legacy file, skipped while scanning and decoded on demand.

use super::cursor::Cursor;
use super::error::VtkLegacyError;
use crate::scalar::Scalar;
use crate::text::Place;
use crate::text::shown;

/// Returns the number type of a name in a legacy file.
fn scalar_of(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "signed_char" => Scalar::I8,
        "unsigned_char" => Scalar::U8,
        "short" => Scalar::I16,
        "unsigned_short" => Scalar::U16,
        // VTK writes its own ids as int, however wide they are in memory.
        "int" | "vtkidtype" => Scalar::I32,
        "unsigned_int" => Scalar::U32,
        "long" | "vtktypeint64" => Scalar::I64,
        "unsigned_long" | "vtktypeuint64" => Scalar::U64,
        "float" => Scalar::F32,
        "double" => Scalar::F64,
        _ => return None,
    })
}

/// Undecoded array in the file.
#[derive(Clone, Debug)]
pub(super) struct LegacyArray<'a> {
    /// Name in the file.
    pub name: String,
    /// Number of values.
    pub count: usize,
    /// Number type; `None` for bits.
    scalar: Option<Scalar>,
    bytes: &'a [u8],
    /// Position of its start.
    place: Place,
    binary: bool,
}

impl<'a> LegacyArray<'a> {
    /// Takes a numeric array.
    pub(super) fn take(
        cursor: &mut Cursor<'a>,
        name: &str,
        kind: &str,
        count: Option<usize>,
    ) -> Result<Self, VtkLegacyError> {
        let place = cursor.place();
        let unknown = || VtkLegacyError::UnknownType { place, kind: shown(kind.as_bytes()) };
        let lower = kind.to_ascii_lowercase();
        let scalar = if lower == "bit" { None } else { Some(scalar_of(&lower).ok_or_else(unknown)?) };
        let count = count.unwrap_or(usize::MAX);
        let bytes = if cursor.binary {
            let length = scalar.map_or(Some(count.div_ceil(8)), |scalar| count.checked_mul(scalar.size()));
            length.and_then(|length| cursor.take(length))
        } else {
            cursor.take_words(count)
        };
        let cut = || VtkLegacyError::CutShort { place, array: shown(name.as_bytes()), count };
        let bytes = bytes.ok_or_else(cut)?;
        Ok(Self { name: name.to_owned(), count, scalar, bytes, place, binary: cursor.binary })
    }

    /// Decodes the values as floating-point numbers.
    pub(super) fn floats(&self) -> Result<Vec<f64>, VtkLegacyError> {
        if !self.binary {
            return self.parsed();
        }
        Ok(match self.scalar {
            Some(scalar) => scalar.floats(self.bytes, true),
            None => self.bits().map(|bit| bit as f64).collect(),
        })
    }

    /// Decodes the values as integers.
    pub(super) fn integers(&self) -> Result<Vec<i64>, VtkLegacyError> {
        if !self.binary {
            return self.parsed();
        }
        match self.scalar {
            Some(scalar) if scalar.is_float() => {
                let text = "a floating-point number".into();
                Err(VtkLegacyError::NotANumber { place: self.place, array: self.name.clone(), index: 0, text })
            }
            Some(scalar) => Ok(scalar.integers(self.bytes, true)),
            None => Ok(self.bits().collect()),
        }
    }

    fn bits(&self) -> impl Iterator<Item = i64> {
        (0..self.count).map(|i| i64::from(self.bytes[i / 8] >> (7 - i % 8) & 1))
    }

    fn parsed<T: std::str::FromStr>(&self) -> Result<Vec<T>, VtkLegacyError> {
        let words = self.bytes.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).enumerate();
        let number = |(index, word): (usize, &[u8])| {
            let value = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
            value.ok_or_else(|| {
                let (place, array) = (self.place_of(index), self.name.clone());
                VtkLegacyError::NotANumber { place, array, index, text: shown(word) }
            })
        };
        words.map(number).collect()
    }

    /// Line of a value in a text file.
    fn place_of(&self, index: usize) -> Place {
        let Place::Line(mut line) = self.place else { return self.place };
        let (mut begun, mut inside) = (0, false);
        for byte in self.bytes {
            let space = byte.is_ascii_whitespace();
            begun += usize::from(!space && !inside);
            if begun > index {
                break;
            }
            inside = !space;
            line += usize::from(*byte == b'\n');
        }
        Place::Line(line)
    }
}
