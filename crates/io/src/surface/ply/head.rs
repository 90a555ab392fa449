//! Header of a PLY file: encoding, elements and properties.

use crate::scalar::Scalar;
use crate::surface::error::SurfaceFault;
use crate::text::Place;
use crate::text::{TextFault, Words};

/// Encoding of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Little,
    Big,
}

/// Returns the number type of a name in a PLY header.
fn scalar_of(word: &[u8]) -> Option<Scalar> {
    Some(match word {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        _ => return None,
    })
}

/// Property of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: Vec<u8>,
    /// Type of the count, for a list.
    pub(super) count: Option<Scalar>,
    /// Type of the value, or of each list item.
    pub(super) value: Scalar,
}

/// Declared element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PlyElement {
    pub(super) name: Vec<u8>,
    /// Number of items announced by the file.
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl PlyElement {
    /// Minimum size of an item, in bytes.
    pub(super) fn least(&self, encoding: Encoding) -> usize {
        // A number in text takes at least a digit and a space.
        let size = |p: &Property| if encoding == Encoding::Text { 2 } else { p.count.unwrap_or(p.value).size() };
        self.properties.iter().map(size).sum()
    }

    /// Index of the property with one of these names.
    pub(super) fn property(&self, names: &[&[u8]]) -> Option<usize> {
        self.properties.iter().position(|p| names.contains(&p.name.as_slice()))
    }
}

/// Parsed header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PlyHeader {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<PlyElement>,
    /// Byte offset of the data.
    pub(super) end: usize,
    /// Line number of the data.
    pub(super) line: usize,
}

/// Parses the header.
pub(super) fn parse(bytes: &[u8]) -> Result<PlyHeader, SurfaceFault> {
    let mut head = PlyHeader { encoding: Encoding::Text, elements: Vec::new(), end: 0, line: 1 };
    let mut encoded = false;
    while let Some(length) = bytes[head.end..].iter().position(|&b| b == b'\n') {
        let line = &bytes[head.end..head.end + length];
        let mut words = Words::from_line(line, head.line);
        let place = Place::Line(head.line);
        head.end += length + 1;
        head.line += 1;
        let keyword = words.word_here().unwrap_or_default();
        match keyword {
            b"ply" if head.line == 2 => {}
            _ if head.line == 2 => return Err(SurfaceFault::unexpected(keyword, "the keyword ply", place)),
            b"format" => {
                head.encoding = encoding(words.need_here("the encoding")?, place)?;
                encoded = true;
            }
            b"element" => {
                let name = words.need_here("the element's name")?.to_vec();
                let count = words.need_here("the element's count")?;
                let count = words.as_integer(count, "the element's count")?;
                let count = u64::try_from(count).map_err(|_| TextFault::OutOfRange {
                    line: words.line(),
                    what: "the element's count",
                    value: count,
                })?;
                head.elements.push(PlyElement { name, count, properties: Vec::new() });
            }
            b"property" => {
                let property = property(&mut words, place)?;
                let element = head.elements.last_mut();
                element
                    .ok_or_else(|| SurfaceFault::unexpected(keyword, "an element", place))?
                    .properties
                    .push(property);
            }
            b"comment" | b"obj_info" | b"" => {}
            b"end_header" if encoded => return Ok(head),
            b"end_header" => return Err(SurfaceFault::Missing { what: "the line 'format'" }),
            _ => {
                return Err(SurfaceFault::unexpected(
                    keyword,
                    "a keyword of the head (element, property, comment, end_header)",
                    place,
                ));
            }
        }
    }
    Err(SurfaceFault::Missing { what: "'end_header'" })
}

fn encoding(word: &[u8], place: Place) -> Result<Encoding, SurfaceFault> {
    match word {
        b"ascii" => Ok(Encoding::Text),
        b"binary_little_endian" => Ok(Encoding::Little),
        b"binary_big_endian" => Ok(Encoding::Big),
        _ => Err(SurfaceFault::unexpected(word, "ascii, binary_little_endian or binary_big_endian", place)),
    }
}

fn property(words: &mut Words, place: Place) -> Result<Property, SurfaceFault> {
    let scalar = |word: &[u8]| scalar_of(word).ok_or_else(|| SurfaceFault::unexpected(word, "a number type", place));
    let kind = words.need_here("the property's type")?;
    if kind != b"list" {
        let value = scalar(kind)?;
        return Ok(Property { name: words.need_here("the property's name")?.to_vec(), count: None, value });
    }
    let counted = words.need_here("the type of the list's count")?;
    let count = scalar(counted)?;
    if count.is_float() {
        return Err(SurfaceFault::unexpected(counted, "a type of integers", place));
    }
    let value = scalar(words.need_here("the type of the list's values")?)?;
    Ok(Property { name: words.need_here("the property's name")?.to_vec(), count: Some(count), value })
}
