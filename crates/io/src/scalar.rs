//! Number types of binary files.

/// The type of a number in a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scalar {
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

impl Scalar {
    /// Returns the size of a value in bytes.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    pub(crate) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// Decodes one value as a floating-point number, without memory of its own. `bytes` has the size of a value.
    #[inline]
    pub(crate) fn float(self, bytes: &[u8], big_endian: bool) -> f64 {
        let mut word = [0_u8; 8];
        word[..bytes.len()].copy_from_slice(bytes);
        if big_endian {
            word[..bytes.len()].reverse();
        }
        let bits = u64::from_le_bytes(word);
        match self {
            Self::I8 => f64::from(bits as i8),
            Self::U8 => f64::from(bits as u8),
            Self::I16 => f64::from(bits as i16),
            Self::U16 => f64::from(bits as u16),
            Self::I32 => f64::from(bits as i32),
            Self::U32 => f64::from(bits as u32),
            Self::I64 => bits as i64 as f64,
            Self::U64 => bits as f64,
            Self::F32 => f64::from(f32::from_bits(bits as u32)),
            Self::F64 => f64::from_bits(bits),
        }
    }

    /// Decodes values as floating-point numbers. Trailing bytes that make no value are ignored.
    pub(crate) fn floats(self, bytes: &[u8], big_endian: bool) -> Vec<f64> {
        match self {
            Self::F32 => decode(bytes, big_endian, |b| f32::from_le_bytes(b).into()),
            Self::F64 => decode(bytes, big_endian, f64::from_le_bytes),
            _ => self.integers(bytes, big_endian).into_iter().map(|x| x as f64).collect(),
        }
    }

    /// Decodes values as integers; none of a floating-point type. Values above `i64::MAX` become `i64::MAX`, which is neither
    /// a count nor the number of anything. Trailing bytes that make no value are ignored.
    pub(crate) fn integers(self, bytes: &[u8], big_endian: bool) -> Vec<i64> {
        match self {
            Self::I8 => decode(bytes, big_endian, |b| i8::from_le_bytes(b).into()),
            Self::U8 => decode(bytes, big_endian, |b| u8::from_le_bytes(b).into()),
            Self::I16 => decode(bytes, big_endian, |b| i16::from_le_bytes(b).into()),
            Self::U16 => decode(bytes, big_endian, |b| u16::from_le_bytes(b).into()),
            Self::I32 => decode(bytes, big_endian, |b| i32::from_le_bytes(b).into()),
            Self::U32 => decode(bytes, big_endian, |b| u32::from_le_bytes(b).into()),
            Self::I64 => decode(bytes, big_endian, i64::from_le_bytes),
            Self::U64 => decode(bytes, big_endian, |b| i64::try_from(u64::from_le_bytes(b)).unwrap_or(i64::MAX)),
            Self::F32 | Self::F64 => Vec::new(),
        }
    }
}

fn decode<const N: usize, T>(bytes: &[u8], big_endian: bool, value: impl Fn([u8; N]) -> T) -> Vec<T> {
    let little_endian = |mut word: [u8; N]| {
        if big_endian {
            word.reverse();
        }
        word
    };
    bytes.as_chunks::<N>().0.iter().map(|&word| value(little_endian(word))).collect()
}
