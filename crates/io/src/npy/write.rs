//! Writer of arrays.

use std::io::{self, Write};

/// Number type of an array.
pub trait Item: Copy {
    /// `NumPy` name of the type.
    const DESCR: &'static str;

    /// Writes the bytes in little-endian order.
    fn put(self, out: &mut impl Write) -> io::Result<()>;
}

impl Item for f64 {
    const DESCR: &'static str = "<f8";

    fn put(self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&self.to_le_bytes())
    }
}

impl Item for i32 {
    const DESCR: &'static str = "<i4";

    fn put(self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&self.to_le_bytes())
    }
}

impl Item for u32 {
    const DESCR: &'static str = "<u4";

    fn put(self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&self.to_le_bytes())
    }
}

/// Bytes before the header text: magic number, version, and length of the text.
const BEFORE: usize = 10;

/// Writes the header of an array with these rows and columns; one column gives one dimension.
pub fn head<T: Item>(out: &mut impl Write, rows: usize, columns: usize) -> io::Result<()> {
    let shape = if columns == 1 { format!("({rows},)") } else { format!("({rows}, {columns})") };
    let mut text = format!("{{'descr': '{}', 'fortran_order': False, 'shape': {shape}, }}", T::DESCR);
    // Items start at a multiple of 64 bytes, so that they can be memory-mapped; the header ends with a line break.
    let padding = (BEFORE + text.len() + 1).next_multiple_of(64) - BEFORE - text.len() - 1;
    text.extend(std::iter::repeat_n(' ', padding));
    text.push('\n');
    let length = u16::try_from(text.len()).map_err(|_| io::Error::from(io::ErrorKind::InvalidInput))?;
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(text.as_bytes())
}

/// Writes a whole array of rows.
pub fn write_array<T: Item, const N: usize>(out: &mut impl Write, rows: &[[T; N]]) -> io::Result<()> {
    head::<T>(out, rows.len(), N)?;
    rows.as_flattened().iter().try_for_each(|item| item.put(out))
}
