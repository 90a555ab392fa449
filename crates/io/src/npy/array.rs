//! Decoding of an array to rows of numbers.

use super::error::NpyFault;
use super::header::Header;
use crate::scalar::Scalar;

/// Undecoded array, with a length that matches its header.
#[derive(Clone, Debug)]
pub(super) struct NpyArray<'a> {
    header: Header,
    scalar: Scalar,
    /// True for big-endian items.
    big: bool,
    data: &'a [u8],
}

/// Returns the number type of a name in an array's header, without its byte order.
fn scalar_of(name: &str) -> Option<Scalar> {
    Some(match name {
        "i1" => Scalar::I8,
        "u1" => Scalar::U8,
        "i2" => Scalar::I16,
        "u2" => Scalar::U16,
        "i4" => Scalar::I32,
        "u4" => Scalar::U32,
        "i8" => Scalar::I64,
        "u8" => Scalar::U64,
        "f4" => Scalar::F32,
        "f8" => Scalar::F64,
        _ => return None,
    })
}

impl<'a> NpyArray<'a> {
    /// Reads the header and checks it against the length of the file.
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, NpyFault> {
        let (header, data) = Header::read(bytes)?;
        let wanted = "integers or floats of 32 or 64 bits";
        let unknown = || NpyFault::Type { found: header.descr.chars().take(40).collect(), wanted };
        let order = header.descr.chars().next().ok_or_else(unknown)?;
        let name = header.descr.strip_prefix(['<', '>', '|', '=']).ok_or_else(unknown)?;
        let scalar = scalar_of(name).ok_or_else(unknown)?;
        let items = header.shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
        let announced = items.and_then(|items| items.checked_mul(scalar.size()));
        if announced != Some(data.len()) {
            let announced = announced.map_or(u64::MAX, |bytes| bytes as u64);
            return Err(NpyFault::Length { announced, found: data.len() as u64 });
        }
        Ok(Self { header, scalar, big: order == '>', data })
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
        let values = self.scalar.floats(self.data, self.big);
        Ok(self.in_rows(rows, &values))
    }

    /// Decodes the items as rows of integers.
    pub(super) fn ints<const N: usize>(&self) -> Result<Vec<[i64; N]>, NpyFault> {
        let rows = self.rows::<N>()?;
        if self.scalar.is_float() {
            return Err(NpyFault::Type { found: self.header.descr.clone(), wanted: "integers" });
        }
        Ok(self.in_rows(rows, &self.scalar.integers(self.data, self.big)))
    }

    fn in_rows<const N: usize, T: Copy>(&self, rows: usize, values: &[T]) -> Vec<[T; N]> {
        if self.header.fortran && N > 1 {
            return (0..rows).map(|row| std::array::from_fn(|column| values[column * rows + row])).collect();
        }
        values.as_chunks::<N>().0.to_vec()
    }
}
