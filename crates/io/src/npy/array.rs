//! Decoding of an array to rows of numbers.

use super::error::NpyFault;
use super::header::Header;

/// Undecoded array, with a length that matches its header.
#[derive(Clone, Debug)]
pub(super) struct Array<'a> {
    header: Header,
    kind: Kind,
    /// True for big-endian items.
    big: bool,
    data: &'a [u8],
}

/// Type of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    F4,
    F8,
    I1,
    I2,
    I4,
    I8,
    U1,
    U2,
    U4,
    U8,
}

impl Kind {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "f4" => Self::F4,
            "f8" => Self::F8,
            "i1" => Self::I1,
            "i2" => Self::I2,
            "i4" => Self::I4,
            "i8" => Self::I8,
            "u1" => Self::U1,
            "u2" => Self::U2,
            "u4" => Self::U4,
            "u8" => Self::U8,
            _ => return None,
        })
    }

    /// Bytes per item.
    fn width(self) -> usize {
        match self {
            Self::I1 | Self::U1 => 1,
            Self::I2 | Self::U2 => 2,
            Self::F4 | Self::I4 | Self::U4 => 4,
            Self::F8 | Self::I8 | Self::U8 => 8,
        }
    }
}

impl<'a> Array<'a> {
    /// Reads the header and checks it against the length of the file.
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, NpyFault> {
        let (header, data) = Header::read(bytes)?;
        let wanted = "integers or floats of 32 or 64 bits";
        let unknown = || NpyFault::Type { found: header.descr.chars().take(40).collect(), wanted };
        let order = header.descr.chars().next().ok_or_else(unknown)?;
        let name = header.descr.strip_prefix(['<', '>', '|', '=']).ok_or_else(unknown)?;
        let kind = Kind::of(name).ok_or_else(unknown)?;
        let items = header.shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
        let announced = items.and_then(|items| items.checked_mul(kind.width()));
        if announced != Some(data.len()) {
            let announced = announced.map_or(u64::MAX, |bytes| bytes as u64);
            return Err(NpyFault::Length { announced, found: data.len() as u64 });
        }
        Ok(Self { header, kind, big: order == '>', data })
    }

    /// Number of rows with `N` columns. A one-dimensional array is one column.
    fn rows<const N: usize>(&self) -> Result<usize, NpyFault> {
        match self.header.shape[..] {
            [rows] if N == 1 => Ok(rows),
            [rows, columns] if columns == N => Ok(rows),
            _ => {
                let wanted = if N == 1 { "(n,)".into() } else { format!("(n, {N})") };
                Err(NpyFault::Shape { found: self.header.shape.clone(), wanted })
            }
        }
    }

    /// Number of columns; 1 for a one-dimensional array.
    pub(super) fn columns(&self) -> usize {
        self.header.shape.get(1).copied().unwrap_or(1)
    }

    /// Decodes the items as rows of floats.
    pub(super) fn floats<const N: usize>(&self) -> Result<Vec<[f64; N]>, NpyFault> {
        let rows = self.rows::<N>()?;
        let values = match self.kind {
            Kind::F4 => self.items(|b| f32::from_le_bytes(b).into()),
            Kind::F8 => self.items(f64::from_le_bytes),
            _ => self.integers()?.into_iter().map(|i| i as f64).collect(),
        };
        Ok(self.in_rows(rows, &values))
    }

    /// Decodes the items as rows of integers.
    pub(super) fn ints<const N: usize>(&self) -> Result<Vec<[i64; N]>, NpyFault> {
        let rows = self.rows::<N>()?;
        Ok(self.in_rows(rows, &self.integers()?))
    }

    /// Decodes integers. Values beyond `i64` become its maximum, which is no valid index.
    fn integers(&self) -> Result<Vec<i64>, NpyFault> {
        Ok(match self.kind {
            Kind::I1 => self.items(|b| i8::from_le_bytes(b).into()),
            Kind::I2 => self.items(|b| i16::from_le_bytes(b).into()),
            Kind::I4 => self.items(|b| i32::from_le_bytes(b).into()),
            Kind::I8 => self.items(i64::from_le_bytes),
            Kind::U1 => self.items(|b| u8::from_le_bytes(b).into()),
            Kind::U2 => self.items(|b| u16::from_le_bytes(b).into()),
            Kind::U4 => self.items(|b| u32::from_le_bytes(b).into()),
            Kind::U8 => self.items(|b| i64::try_from(u64::from_le_bytes(b)).unwrap_or(i64::MAX)),
            Kind::F4 | Kind::F8 => {
                return Err(NpyFault::Type { found: self.header.descr.clone(), wanted: "integers" });
            }
        })
    }

    fn items<const W: usize, T>(&self, of: impl Fn([u8; W]) -> T) -> Vec<T> {
        let (items, _) = self.data.as_chunks::<W>();
        let turned = |mut bytes: [u8; W]| {
            if self.big {
                bytes.reverse();
            }
            bytes
        };
        items.iter().map(|&bytes| of(turned(bytes))).collect()
    }

    fn in_rows<const N: usize, T: Copy>(&self, rows: usize, values: &[T]) -> Vec<[T; N]> {
        if self.header.fortran && N > 1 {
            return (0..rows).map(|row| std::array::from_fn(|column| values[column * rows + row])).collect();
        }
        values.as_chunks::<N>().0.to_vec()
    }
}
