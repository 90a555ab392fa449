//! Decoding of a `DataArray` from text or bytes to values.

use super::array::{DataArray, Values};
use super::document::{Appended, ElementId, Layout, VtkXml};
use super::error::VtkError;
use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;
use std::io::Read;

/// Padding is optional: writers differ in where a header ends within a base64 stream.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Value type.
#[derive(Clone, Copy)]
enum Kind {
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
        Some(match name {
            "Int8" => Self::I8,
            "UInt8" | "String" => Self::U8,
            "Int16" => Self::I16,
            "UInt16" => Self::U16,
            "Int32" => Self::I32,
            "UInt32" => Self::U32,
            "Int64" => Self::I64,
            "UInt64" => Self::U64,
            "Float32" => Self::F32,
            "Float64" => Self::F64,
            _ => return None,
        })
    }

    fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }
}

impl VtkXml<'_> {
    /// Reads the array of a `DataArray` element.
    ///
    /// # Errors
    /// Type, encoding or bytes violate VTK's format, or the data are truncated.
    pub fn read(&self, element: ElementId) -> Result<DataArray, VtkError> {
        let attribute = |name| self.attribute(element, name).unwrap_or_default();
        let name = attribute("Name");
        let array = || name.to_owned();
        let kind = Kind::of(attribute("type"))
            .ok_or_else(|| VtkError::UnknownType { array: array(), kind: attribute("type").to_owned() })?;
        let (text, layout) = (self.text(element), self.layout());
        let values = match attribute("format") {
            "ascii" | "" => parse_ascii(name, kind, text)?,
            "binary" => {
                let source = Source { array: name, layout, bytes: text.as_bytes(), base64: true };
                values_of(name, kind, layout, &source.read()?)?
            }
            "appended" => values_of(name, kind, layout, &appended_source(self, element, name)?.read()?)?,
            format => return Err(VtkError::UnknownFormat { array: array(), format: format.to_owned() }),
        };
        let components = self.count(element, "NumberOfComponents")?.max(1);
        Ok(DataArray { components, values })
    }
}

fn appended_source<'a>(document: &'a VtkXml<'a>, element: ElementId, array: &'a str) -> Result<Source<'a>, VtkError> {
    let bad = || VtkError::BadOffset { array: array.to_owned() };
    let offset: usize = document.attribute(element, "offset").and_then(|o| o.trim().parse().ok()).ok_or_else(bad)?;
    let Appended { bytes, base64, .. } = document.appended().ok_or_else(bad)?;
    let bytes = bytes.get(offset..).ok_or_else(bad)?;
    Ok(Source { array, layout: document.layout(), bytes, base64 })
}

fn parse_ascii(array: &str, kind: Kind, text: &str) -> Result<Values, VtkError> {
    let bad = |index: usize, word: &str| VtkError::BadNumber {
        array: array.to_owned(),
        index,
        text: word.chars().take(40).collect(),
    };
    let words = text.split_ascii_whitespace().enumerate();
    if kind.is_float() {
        let floats = words.map(|(i, word)| word.parse().map_err(|_| bad(i, word)));
        Ok(Values::Float(floats.collect::<Result<_, _>>()?))
    } else {
        let ints = words.map(|(i, word)| word.parse().map_err(|_| bad(i, word)));
        Ok(Values::Int(ints.collect::<Result<_, _>>()?))
    }
}

/// Converts bytes to values of one type.
fn values_of(array: &str, kind: Kind, layout: Layout, bytes: &[u8]) -> Result<Values, VtkError> {
    macro_rules! numbers {
        ($number:ty, $wide:ty) => {{
            const SIZE: usize = size_of::<$number>();
            let (words, rest) = bytes.as_chunks::<SIZE>();
            if !rest.is_empty() {
                return Err(VtkError::Ragged { array: array.to_owned(), size: SIZE });
            }
            let big = layout.big_endian;
            let number = |w: &[u8; SIZE]| if big { <$number>::from_be_bytes(*w) } else { <$number>::from_le_bytes(*w) };
            words.iter().map(|w| <$wide>::from(number(w))).collect()
        }};
    }
    Ok(match kind {
        Kind::I8 => Values::Int(numbers!(i8, i64)),
        Kind::U8 => Values::Int(numbers!(u8, i64)),
        Kind::I16 => Values::Int(numbers!(i16, i64)),
        Kind::U16 => Values::Int(numbers!(u16, i64)),
        Kind::I32 => Values::Int(numbers!(i32, i64)),
        Kind::U32 => Values::Int(numbers!(u32, i64)),
        Kind::I64 => Values::Int(numbers!(i64, i64)),
        Kind::U64 => {
            let wide: Vec<i64> = numbers!(i64, i64);
            if let Some(index) = wide.iter().position(|&x| x < 0) {
                return Err(VtkError::TooLarge { array: array.to_owned(), index });
            }
            Values::Int(wide)
        }
        Kind::F32 => Values::Float(numbers!(f32, f64)),
        Kind::F64 => Values::Float(numbers!(f64, f64)),
    })
}

/// Bytes that start with an array: a header of lengths, then the data.
struct Source<'a> {
    array: &'a str,
    layout: Layout,
    bytes: &'a [u8],
    base64: bool,
}

impl Source<'_> {
    /// Decodes and decompresses the bytes of the array.
    fn read(&self) -> Result<Vec<u8>, VtkError> {
        let bytes = if self.base64 { Cow::Owned(self.without_space()) } else { Cow::Borrowed(self.bytes) };
        if bytes.is_empty() && self.base64 {
            return Ok(Vec::new());
        }
        if self.layout.zlib { self.read_compressed(&bytes) } else { self.read_plain(&bytes) }
    }

    /// Base64 characters, up to the first other byte.
    fn without_space(&self) -> Vec<u8> {
        let is_base64 = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'/' | b'=');
        self.bytes.iter().copied().filter(|b| !b.is_ascii_whitespace()).take_while(is_base64).collect()
    }

    fn cut_short(&self) -> VtkError {
        VtkError::ArrayCutShort { array: self.array.to_owned() }
    }

    fn word(&self) -> usize {
        if self.layout.wide_header { 8 } else { 4 }
    }

    /// First `count` lengths.
    fn lengths(&self, bytes: &[u8], count: usize) -> Result<Vec<usize>, VtkError> {
        let size = self.word();
        let end = count.checked_mul(size).ok_or_else(|| self.cut_short())?;
        let head = self.prefix(bytes, end)?.0;
        let number = |w: &[u8]| {
            let fold = |sum: u64, &byte: &u8| sum << 8 | u64::from(byte);
            if self.layout.big_endian { w.iter().fold(0, fold) } else { w.iter().rev().fold(0, fold) }
        };
        Ok(head.chunks_exact(size).map(|w| usize::try_from(number(w)).unwrap_or(usize::MAX)).collect())
    }

    /// First `count` decoded bytes, and their encoded size if they are encoded separately.
    fn prefix<'b>(&self, bytes: &'b [u8], count: usize) -> Result<(Cow<'b, [u8]>, usize), VtkError> {
        let taken = if self.base64 { count.div_ceil(3).saturating_mul(4) } else { count };
        let part = bytes.get(..taken).ok_or_else(|| self.cut_short())?;
        if !self.base64 {
            return Ok((Cow::Borrowed(part), taken));
        }
        let mut decoded = BASE64.decode(part).map_err(|_| VtkError::BadBase64 { array: self.array.to_owned() })?;
        if decoded.len() < count {
            return Err(self.cut_short());
        }
        decoded.truncate(count);
        Ok((Cow::Owned(decoded), taken))
    }

    /// Reads one length and the data; in base64 as one stream, or (some writers) separately.
    fn read_plain(&self, bytes: &[u8]) -> Result<Vec<u8>, VtkError> {
        let header = self.word();
        let length = self.lengths(bytes, 1)?[0];
        let apart = self.prefix(bytes, header)?.1;
        if !self.base64 || bytes[..apart].ends_with(b"=") {
            return Ok(self.prefix(&bytes[apart..], length)?.0.into_owned());
        }
        let total = header.checked_add(length).ok_or_else(|| self.cut_short())?;
        let mut data = self.prefix(bytes, total)?.0.into_owned();
        data.drain(..header);
        Ok(data)
    }

    /// Reads block count, block size, size of a partial last block, compressed sizes, and the blocks. In base64, header
    /// and blocks are encoded separately.
    fn read_compressed(&self, bytes: &[u8]) -> Result<Vec<u8>, VtkError> {
        let blocks = self.lengths(bytes, 1)?[0];
        if blocks == 0 {
            return Ok(Vec::new());
        }
        let words = blocks.checked_add(3).ok_or_else(|| self.cut_short())?;
        let header = self.lengths(bytes, words)?;
        let (size, last, packed) = (header[1], header[2], &header[3..]);
        let start = self.prefix(bytes, words * self.word())?.1;
        let total = packed.iter().try_fold(0_usize, |sum, &n| sum.checked_add(n)).ok_or_else(|| self.cut_short())?;
        let data = self.prefix(&bytes[start..], total)?.0;
        let mut out = Vec::new();
        let mut rest: &[u8] = &data;
        for (block, &length) in packed.iter().enumerate() {
            let expected = if block + 1 == blocks && last > 0 { last } else { size };
            let (part, after) = rest.split_at(length);
            self.inflate(part, block, expected, &mut out)?;
            rest = after;
        }
        Ok(out)
    }

    /// Decompresses one block to exactly `expected` bytes. The buffer grows with the actual data, so a false length in
    /// a damaged file allocates nothing.
    fn inflate(&self, part: &[u8], block: usize, expected: usize, out: &mut Vec<u8>) -> Result<(), VtkError> {
        let before = out.len();
        let limit = (expected as u64).saturating_add(1);
        let read = flate2::read::ZlibDecoder::new(part).take(limit).read_to_end(out);
        if read.is_err() || out.len() - before != expected {
            return Err(VtkError::BadZlib { array: self.array.to_owned(), block });
        }
        Ok(())
    }
}
