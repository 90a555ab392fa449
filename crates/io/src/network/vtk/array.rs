//! Arrays of a legacy file, skipped while scanning and decoded on demand.

use super::cursor::Cursor;
use super::error::VtkLegacyError;
use crate::text::Place;
use crate::text::shown;

/// Value type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Bit,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Kind {
    fn of(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "bit" => Self::Bit,
            "char" | "signed_char" => Self::I8,
            "unsigned_char" => Self::U8,
            "short" => Self::I16,
            "unsigned_short" => Self::U16,
            // VTK writes ids as int, whatever their size in memory.
            "int" | "vtkidtype" => Self::I32,
            "unsigned_int" => Self::U32,
            "long" | "vtktypeint64" => Self::I64,
            "unsigned_long" | "vtktypeuint64" => Self::U64,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Bit | Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// Undecoded array in the file.
#[derive(Clone, Debug)]
pub(super) struct Array<'a> {
    /// Name in the file.
    pub name: String,
    /// Number of values.
    pub count: usize,
    kind: Kind,
    bytes: &'a [u8],
    /// Position of its start.
    place: Place,
    binary: bool,
}

impl<'a> Array<'a> {
    /// Takes a numeric array.
    pub(super) fn take(
        cursor: &mut Cursor<'a>,
        name: &str,
        kind: &str,
        count: Option<usize>,
    ) -> Result<Self, VtkLegacyError> {
        let place = cursor.place();
        let unknown = || VtkLegacyError::UnknownType { place, kind: shown(kind.as_bytes()) };
        let kind = Kind::of(kind).ok_or_else(unknown)?;
        let count = count.unwrap_or(usize::MAX);
        let bytes = if !cursor.binary {
            cursor.take_words(count)
        } else if kind == Kind::Bit {
            cursor.take(count.div_ceil(8))
        } else {
            count.checked_mul(kind.size()).and_then(|length| cursor.take(length))
        };
        let cut = || VtkLegacyError::CutShort { place, array: shown(name.as_bytes()), count };
        let bytes = bytes.ok_or_else(cut)?;
        Ok(Self { name: name.to_owned(), count, kind, bytes, place, binary: cursor.binary })
    }

    /// Decodes the values as floating-point numbers.
    pub(super) fn floats(&self) -> Result<Vec<f64>, VtkLegacyError> {
        if !self.binary {
            return self.parsed();
        }
        Ok(match self.kind {
            Kind::F32 => self.words::<4>().map(|w| f32::from_be_bytes(w).into()).collect(),
            Kind::F64 => self.words::<8>().map(f64::from_be_bytes).collect(),
            _ => self.binary_integers().into_iter().map(|x| x as f64).collect(),
        })
    }

    /// Decodes the values as integers.
    pub(super) fn integers(&self) -> Result<Vec<i64>, VtkLegacyError> {
        if !self.binary {
            return self.parsed();
        }
        if matches!(self.kind, Kind::F32 | Kind::F64) {
            let text = "a floating-point number".into();
            return Err(VtkLegacyError::NotANumber { place: self.place, array: self.name.clone(), index: 0, text });
        }
        Ok(self.binary_integers())
    }

    fn binary_integers(&self) -> Vec<i64> {
        match self.kind {
            Kind::Bit => (0..self.count).map(|i| i64::from(self.bytes[i / 8] >> (7 - i % 8) & 1)).collect(),
            Kind::I8 => self.words::<1>().map(|w| i8::from_be_bytes(w).into()).collect(),
            Kind::U8 => self.words::<1>().map(|w| w[0].into()).collect(),
            Kind::I16 => self.words::<2>().map(|w| i16::from_be_bytes(w).into()).collect(),
            Kind::U16 => self.words::<2>().map(|w| u16::from_be_bytes(w).into()).collect(),
            Kind::I32 => self.words::<4>().map(|w| i32::from_be_bytes(w).into()).collect(),
            Kind::U32 => self.words::<4>().map(|w| u32::from_be_bytes(w).into()).collect(),
            // Values above the signed range are invalid as point index and as count.
            Kind::I64 | Kind::U64 => self.words::<8>().map(i64::from_be_bytes).collect(),
            Kind::F32 | Kind::F64 => Vec::new(),
        }
    }

    fn words<const N: usize>(&self) -> impl Iterator<Item = [u8; N]> {
        self.bytes.as_chunks::<N>().0.iter().copied()
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
