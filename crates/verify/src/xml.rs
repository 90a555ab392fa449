//! Arrays of VTK's XML files, in text, base64 or appended data, raw or with zlib.

use crate::numbers::{Kind, Number, Order};
use anyhow::{Context as _, Result, bail, ensure};
use base64::Engine as _;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use bstr::ByteSlice as _;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::collections::HashMap;
use std::io::Read as _;
use std::rc::Rc;

/// Decoder of base64 with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_allow_trailing_bits(true)
        .with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

type Attributes = HashMap<String, String>;

/// XML file of VTK with its arrays.
#[derive(Default)]
pub struct VtkFile<'a> {
    /// Number of pieces.
    pub pieces: usize,
    attributes: Attributes,
    arrays: Vec<Array<'a>>,
    appended: Option<&'a [u8]>,
    is_base64: bool,
}

struct Array<'a> {
    section: Rc<str>,
    attributes: Attributes,
    text: &'a [u8],
}

impl<'a> VtkFile<'a> {
    /// Finds the arrays of a file.
    pub fn parse(bytes: &'a [u8]) -> Result<Self> {
        let (mut file, mut open, mut reader) = (Self::default(), Vec::<Rc<str>>::new(), Reader::from_reader(bytes));
        let config = reader.config_mut();
        (config.expand_empty_elements, config.check_end_names, config.allow_unmatched_ends) = (true, false, true);
        while file.appended.is_none() {
            match reader.read_event() {
                Ok(Event::Start(tag)) => {
                    let section = open.last().cloned().unwrap_or_default();
                    file.add(&tag, section, &bytes[reader.buffer_position() as usize..])?;
                    open.push(tag.name().as_ref().into());
                }
                Ok(Event::End(_)) => drop(open.pop()),
                Ok(Event::Eof) => break,
                Ok(_) => {}
                Err(error) => bail!("byte {}: {error}", reader.error_position()),
            }
        }
        ensure!(!file.kind().is_empty(), "not an XML file of VTK");
        Ok(file)
    }

    /// Adds a tag with the bytes that follow it.
    fn add(&mut self, tag: &BytesStart, section: Rc<str>, rest: &'a [u8]) -> Result<()> {
        let mut attributes = Attributes::new();
        // The check of the crate for repeated attributes takes quadratic time.
        for attribute in tag.attributes().with_checks(false) {
            let named = || format!("tag {}", tag.name().as_ref());
            let attribute = attribute.with_context(named)?;
            let (name, value) = (attribute.key.as_ref(), attribute.normalized_value(XmlVersion::Implicit1_0));
            let known = attributes.insert(name.to_owned(), value.with_context(named)?.into_owned());
            ensure!(known.is_none(), "{}: the attribute {name} is repeated", named());
        }
        match tag.name().as_ref() {
            "VTKFile" => self.attributes = attributes,
            "Piece" => self.pieces += 1,
            "DataArray" => {
                let text = rest.split_once_str("<").map_or(rest, |(text, _)| text);
                self.arrays.push(Array { section, attributes, text });
            }
            "AppendedData" => {
                self.is_base64 = attributes.get("encoding").is_some_and(|encoding| encoding != "raw");
                self.appended = Some(rest.split_once_str("_").map_or(&[], |(_, data)| data));
            }
            _ => {}
        }
        Ok(())
    }

    /// Attribute `type` of the file, such as `UnstructuredGrid`.
    pub fn kind(&self) -> &str {
        of(&self.attributes, "type")
    }

    /// Names of the arrays of a section.
    pub fn names(&self, section: &str) -> Vec<&str> {
        let own = self.arrays.iter().filter(|array| &*array.section == section);
        own.filter_map(|array| array.attributes.get("Name").map(String::as_str)).collect()
    }

    /// Numbers of an array; `None` if the section has none of this name. An empty name is any name.
    pub fn array<T: Number>(&self, section: &str, name: &str) -> Result<Option<Vec<T>>> {
        let is_meant = |a: &&Array| {
            &*a.section == section && (name.is_empty() || a.attributes.get("Name").is_some_and(|n| n == name))
        };
        let numbers = self.arrays.iter().find(is_meant).map(|array| self.decode(array)).transpose();
        numbers.with_context(|| format!("array '{name}' of {section}"))
    }

    /// Numbers of an array that must exist.
    pub fn required<T: Number>(&self, section: &str, name: &str) -> Result<Vec<T>> {
        self.array(section, name)?.with_context(|| format!("{section} has no array '{name}'"))
    }

    fn decode<T: Number>(&self, array: &Array) -> Result<Vec<T>> {
        let kind = Kind::named(of(&array.attributes, "type"))?;
        ensure!(T::of(kind, 0).is_some(), "floating-point numbers instead of integers");
        let bytes = match of(&array.attributes, "format") {
            "ascii" => {
                let words = array.text.to_str().unwrap_or("?").split_ascii_whitespace().map(|word| word.parse().ok());
                return words.collect::<Option<_>>().context("a word is not a number");
            }
            "appended" => {
                let offset = of(&array.attributes, "offset").parse().ok();
                let data = offset.and_then(|offset: usize| self.appended?.get(offset..));
                self.payload(data.context("its offset is beyond the file")?, self.is_base64)?
            }
            "binary" => self.payload(array.text.trim_ascii(), true)?,
            other => bail!("unknown format '{other}'"),
        };
        let (words, order) = (bytes.chunks_exact(kind.width()), self.order());
        ensure!(words.remainder().is_empty(), "its length is no multiple of the size of a number");
        Ok(words.filter_map(|word| T::of(kind, order.bits(word))).collect())
    }

    /// Bytes of an array, from its header on.
    fn payload(&self, data: &[u8], is_base64: bool) -> Result<Vec<u8>> {
        let width = if of(&self.attributes, "header_type") == "UInt64" { 8 } else { 4 };
        let header = |count: usize| -> Result<Vec<usize>> {
            let bytes = decoded(data, count.saturating_mul(width), is_base64)?;
            Ok(bytes.chunks(width).map(|word| self.order().bits(word).try_into().unwrap_or(usize::MAX)).collect())
        };
        let count = header(1)?[0];
        match of(&self.attributes, "compressor") {
            "" => return Ok(decoded(data, count.saturating_add(width), is_base64)?.split_off(width)),
            "vtkZLibDataCompressor" => {}
            other => bail!("compressor '{other}' is not supported"),
        }
        let header = header(count.saturating_add(3))?;
        let (full, last, sizes) = (header[1], header[2], &header[3..]);
        // Encoded headers and blocks are padded separately.
        let skipped = if is_base64 { letters(header.len() * width) } else { header.len() * width };
        let total = sizes.iter().fold(0, |sum: usize, &size| sum.saturating_add(size));
        let blocks = decoded(data.get(skipped..).unwrap_or_default(), total, is_base64)?;
        let (mut rest, mut out) = (&blocks[..], Vec::new());
        for (i, &size) in sizes.iter().enumerate() {
            let (block, others) = rest.split_at(size);
            let expected = if i + 1 == count && last > 0 { last } else { full };
            let end = out.len().saturating_add(expected);
            let mut decoder = flate2::read::ZlibDecoder::new(block).take((expected as u64).saturating_add(1));
            let is_sound = decoder.read_to_end(&mut out).is_ok() && out.len() == end;
            ensure!(is_sound, "block {i} of its compressed data is damaged");
            rest = others;
        }
        Ok(out)
    }

    fn order(&self) -> Order {
        if of(&self.attributes, "byte_order") == "BigEndian" { Order::Big } else { Order::Little }
    }
}

/// Value of an attribute, empty if it is missing.
fn of<'a>(attributes: &'a Attributes, name: &str) -> &'a str {
    attributes.get(name).map_or("", String::as_str)
}

/// Number of letters of base64 for a number of bytes.
fn letters(length: usize) -> usize {
    length.div_ceil(3).saturating_mul(4)
}

/// The first bytes of raw or base64 data.
fn decoded(data: &[u8], length: usize, is_base64: bool) -> Result<Vec<u8>> {
    let data = &data[..data.len().min(if is_base64 { letters(length) } else { length })];
    let decoded = if is_base64 { BASE64.decode(data).ok() } else { Some(data.to_vec()) };
    let mut bytes = decoded.context("its base64 text is damaged")?;
    ensure!(bytes.len() >= length, if is_base64 { "its base64 text is too short" } else { "the file ends inside it" });
    bytes.truncate(length);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(xml: &str) -> Result<Vec<i64>> {
        VtkFile::parse(xml.as_bytes())?.required("Cells", "a")
    }

    #[test]
    fn base64_with_and_without_header_width() {
        // Length 8 in 32 bits, then 1 and -2; the same with a header of 64 bits, big endian.
        let array = |head: &str, data: &str| {
            whole(&format!(
                "<VTKFile type=\"x\" {head}><Cells><DataArray type='Int32' Name='a' format='binary'>\n {data}\n</DataArray>"
            ))
        };
        assert_eq!(array("", "CAAAAAEAAAD+////").expect("readable"), [1, -2]);
        let big = "byte_order='BigEndian' header_type='UInt64'";
        assert_eq!(array(big, "AAAAAAAAAAQAAAAB").expect("readable"), [1]);
        assert!(array("", "CAAAAAEAAAD+").is_err());
        let damaged = array("", "CAAAA").expect_err("one letter");
        assert_eq!(format!("{damaged:#}"), "array 'a' of Cells: its base64 text is damaged");
        assert_eq!(
            format!("{:#}", array("", "CAAA").expect_err("a cut header")),
            "array 'a' of Cells: its base64 text is too short"
        );
        assert!(array("compressor='vtkLZ4DataCompressor'", "CAAAAAEAAAD+////").is_err());
    }

    #[test]
    fn appended_base64_ends_at_its_length() {
        // 12 bytes are 16 letters without padding; what follows is no base64.
        let file = "<VTKFile type='x'><Cells><DataArray type='Int32' Name='a' format='appended' offset='0'/></Cells>\n\
            <AppendedData encoding='base64'>\n _CAAAAAEAAAD+////\n </AppendedData></VTKFile>";
        assert_eq!(whole(file).expect("readable"), [1, -2]);
    }

    #[test]
    fn attributes_have_either_quote_and_spaces() {
        let of = |tag: &str| VtkFile::parse(format!("<{tag}>").as_bytes()).map(|file| file.attributes);
        let found = of("VTKFile Name = 'a b'\n\ttype=\"Int'32\" n='' entity='a&lt;b'").expect("attributes");
        let expected = [("Name", "a b"), ("type", "Int'32"), ("n", ""), ("entity", "a<b")];
        assert_eq!(found, expected.map(|(name, value)| (name.to_owned(), value.to_owned())).into());
        for damaged in
            ["VTKFile type=a", "VTKFile type='a' open='no", "VTKFile type='a' type='b'", "VTKFile type='&x;'"]
        {
            assert!(of(damaged).is_err(), "{damaged}");
        }
    }

    #[test]
    fn arrays_belong_to_the_section_around_them() {
        let array = |text: &str| format!("<DataArray type='Int32' Name='a' format='ascii'>{text}</DataArray>");
        let xml =
            format!("<VTKFile type='x'><Empty/>{}<Cells>{}</Cells>{}</VTKFile>", array("1"), array("2"), array("3"));
        assert_eq!(whole(&xml).expect("readable"), [2]);
        let file = VtkFile::parse(xml.as_bytes()).expect("tags");
        assert_eq!(
            (file.names("Cells"), file.names("VTKFile"), file.names("Empty")),
            (vec!["a"], vec!["a"; 2], vec![])
        );
        assert!(file.array::<i64>("Cells", "b").expect("no error").is_none());
        assert!(file.array::<i64>("Empty", "").expect("no error").is_none());
    }

    #[test]
    fn damaged_headers_are_errors() {
        for header in [u64::MAX, u64::MAX - 8, 1 << 40] {
            for compressor in ["", "compressor='vtkZLibDataCompressor'"] {
                let mut file = format!(
                    "<VTKFile type='x' header_type='UInt64' {compressor}><Cells><DataArray type='Int32' Name='a' \
                     format='appended' offset='0'/></Cells><AppendedData encoding='raw'>_"
                )
                .into_bytes();
                file.extend(header.to_le_bytes());
                file.extend([1; 40]);
                assert!(VtkFile::parse(&file).expect("tags").required::<i64>("Cells", "a").is_err());
            }
        }
    }
}
