//! Arrays of VTK's XML files: text, base64 and appended data, raw or with zlib.

use crate::mesh::{Read, ReadError, fail};
use std::collections::HashMap;
use std::io::Read as _;

/// Maximum length of the first reservation for an array, in numbers. Damaged headers reserve no more.
const RESERVED: usize = 1 << 20;

/// XML file of VTK with its arrays.
pub struct VtkFile<'a> {
    /// Attribute `type` of the file, such as `UnstructuredGrid`.
    pub kind: String,
    /// Number of pieces.
    pub pieces: usize,
    attributes: HashMap<String, String>,
    arrays: Vec<Array<'a>>,
    appended: &'a [u8],
    is_raw: bool,
}

struct Array<'a> {
    section: String,
    attributes: HashMap<String, String>,
    text: &'a [u8],
}

/// Numbers of an array.
pub enum Numbers {
    /// Integers of any width.
    Whole(Vec<i64>),
    /// Floating-point numbers of any width.
    Real(Vec<f64>),
}

impl Numbers {
    /// Integers; floating-point numbers are an error.
    pub fn whole(self) -> Read<Vec<i64>> {
        match self {
            Self::Whole(numbers) => Ok(numbers),
            Self::Real(_) => fail("an array of indices has floating-point numbers"),
        }
    }

    /// Numbers as 64-bit floating-point numbers.
    pub fn real(self) -> Vec<f64> {
        match self {
            Self::Whole(numbers) => numbers.into_iter().map(|n| n as f64).collect(),
            Self::Real(numbers) => numbers,
        }
    }
}

impl<'a> VtkFile<'a> {
    /// Finds the arrays of a file.
    pub fn parse(bytes: &'a [u8]) -> Read<Self> {
        let mut file = Self {
            kind: String::new(),
            pieces: 0,
            attributes: HashMap::new(),
            arrays: Vec::new(),
            appended: &[],
            is_raw: true,
        };
        let (mut at, mut open) = (0, Vec::<String>::new());
        while let Some(start) = find(bytes, at, b"<") {
            let Some(end) = find(bytes, start, b">") else { return fail("a tag is not closed") };
            at = end + 1;
            let Ok(tag) = std::str::from_utf8(&bytes[start + 1..end]) else { return fail("a tag is not UTF-8") };
            if tag.starts_with(['?', '!']) {
                continue;
            }
            if tag.starts_with('/') {
                open.pop();
                continue;
            }
            let name = tag.split([' ', '\n', '\t', '\r', '/']).next().unwrap_or_default();
            let attributes = attributes(tag);
            match name {
                "VTKFile" => {
                    file.kind = attributes.get("type").cloned().unwrap_or_default();
                    file.attributes = attributes;
                }
                "AppendedData" => {
                    file.is_raw = attributes.get("encoding").is_none_or(|encoding| encoding == "raw");
                    let first = find(bytes, at, b"_").map_or(bytes.len(), |underscore| underscore + 1);
                    file.appended = &bytes[first..];
                    break;
                }
                "DataArray" => {
                    let text = &bytes[at..find(bytes, at, b"<").unwrap_or(bytes.len())];
                    let section = open.last().cloned().unwrap_or_default();
                    file.arrays.push(Array { section, attributes, text });
                }
                "Piece" => file.pieces += 1,
                _ => {}
            }
            if !tag.ends_with('/') {
                open.push(name.to_owned());
            }
        }
        if file.kind.is_empty() { fail("not an XML file of VTK") } else { Ok(file) }
    }

    /// Names of the arrays of a section.
    pub fn names(&self, section: &str) -> Vec<&str> {
        let own = self.arrays.iter().filter(|array| array.section == section);
        own.filter_map(|array| array.attributes.get("Name").map(String::as_str)).collect()
    }

    /// Numbers of an array; `None` if the section has none of this name. An empty name is any name.
    pub fn array(&self, section: &str, name: &str) -> Read<Option<Numbers>> {
        let is_meant = |array: &&Array| {
            array.section == section && (name.is_empty() || array.attributes.get("Name").is_some_and(|n| n == name))
        };
        let Some(array) = self.arrays.iter().find(is_meant) else { return Ok(None) };
        self.decode(array).map(Some).map_err(|e| ReadError(format!("array '{name}' of {section}: {e}")))
    }

    /// Numbers of an array that must exist.
    pub fn required(&self, section: &str, name: &str) -> Read<Numbers> {
        self.array(section, name)?.map_or_else(|| fail(format!("{section} has no array '{name}'")), Ok)
    }

    fn decode(&self, array: &Array) -> Read<Numbers> {
        let of = |name: &str| array.attributes.get(name).map_or("", String::as_str);
        let kind = of("type");
        let bytes = match of("format") {
            "ascii" => return ascii(array.text, kind.starts_with("Float")),
            "appended" => {
                let offset = of("offset").parse().ok().and_then(|offset: usize| self.appended.get(offset..));
                let Some(data) = offset else { return fail("its offset is beyond the file") };
                self.payload(data, self.is_raw)?
            }
            "binary" => self.payload(array.text.trim_ascii(), false)?,
            other => return fail(format!("unknown format '{other}'")),
        };
        self.numbers(&bytes, kind)
    }

    /// Bytes of an array, from its header on.
    fn payload(&self, data: &[u8], is_raw: bool) -> Read<Vec<u8>> {
        let word = if self.attributes.get("header_type").is_some_and(|t| t == "UInt64") { 8 } else { 4 };
        let compressor = self.attributes.get("compressor").map_or("", String::as_str);
        let start = |length: usize| decoded(data, length, is_raw);
        let number = |bytes: &[u8], i: usize| self.word(&bytes[i * word..(i + 1) * word]);
        let first = number(&start(word)?, 0);
        if compressor.is_empty() {
            let Some(end) = word.checked_add(first) else { return fail("its length is damaged") };
            return Ok(start(end)?.split_off(word));
        }
        if compressor != "vtkZLibDataCompressor" {
            return fail(format!("compressor '{compressor}' is not supported"));
        }
        let Some(length) = first.checked_add(3).and_then(|n| n.checked_mul(word)) else {
            return fail("its number of blocks is damaged");
        };
        let header = start(length)?;
        let (full, last) = (number(&header, 1), number(&header, 2));
        let sizes: Vec<usize> = (0..first).map(|i| number(&header, 3 + i)).collect();
        let Some(total) = sizes.iter().try_fold(0_usize, |sum, &size| sum.checked_add(size)) else {
            return fail("its block lengths are damaged");
        };
        // Encoded headers and blocks are padded separately.
        let skipped = if is_raw { length } else { length.div_ceil(3) * 4 };
        let blocks = decoded(data.get(skipped..).unwrap_or_default(), total, is_raw)?;
        let (mut out, mut at) = (Vec::new(), 0);
        for (i, &size) in sizes.iter().enumerate() {
            let expected = if i + 1 == first && last > 0 { last } else { full };
            let before = out.len();
            let mut block = flate2::read::ZlibDecoder::new(&blocks[at..at + size]).take(expected as u64 + 1);
            if block.read_to_end(&mut out).is_err() || out.len() - before != expected {
                return fail(format!("block {i} of its compressed data is damaged"));
            }
            at += size;
        }
        Ok(out)
    }

    fn is_big_endian(&self) -> bool {
        self.attributes.get("byte_order").is_some_and(|order| order == "BigEndian")
    }

    fn word(&self, bytes: &[u8]) -> usize {
        let fold = |n: u64, &byte: &u8| n * 256 + u64::from(byte);
        let n = if self.is_big_endian() { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) };
        usize::try_from(n).unwrap_or(usize::MAX)
    }

    fn numbers(&self, bytes: &[u8], kind: &str) -> Read<Numbers> {
        let width = match kind {
            "Int8" | "UInt8" => 1,
            "Int16" | "UInt16" => 2,
            "Int32" | "UInt32" | "Float32" => 4,
            "Int64" | "UInt64" | "Float64" => 8,
            other => return fail(format!("type '{other}' is not supported")),
        };
        if !bytes.len().is_multiple_of(width) {
            return fail("its length is no multiple of the size of a number");
        }
        let words = bytes.chunks_exact(width).map(|chunk| self.word(chunk) as u64);
        Ok(match kind {
            "Float64" => Numbers::Real(words.map(f64::from_bits).collect()),
            "Float32" => Numbers::Real(words.map(|w| f64::from(f32::from_bits(w as u32))).collect()),
            "UInt8" | "UInt16" | "UInt32" | "UInt64" => {
                Numbers::Whole(words.map(|w| i64::try_from(w).unwrap_or(i64::MAX)).collect())
            }
            // Sign extension.
            _ => Numbers::Whole(words.map(|w| ((w << (64 - 8 * width)) as i64) >> (64 - 8 * width)).collect()),
        })
    }
}

fn ascii(text: &[u8], is_real: bool) -> Read<Numbers> {
    let Ok(text) = std::str::from_utf8(text) else { return fail("its text is not UTF-8") };
    let numbers = if is_real {
        text.split_ascii_whitespace().map(|word| word.parse().ok()).collect::<Option<_>>().map(Numbers::Real)
    } else {
        text.split_ascii_whitespace().map(|word| word.parse().ok()).collect::<Option<_>>().map(Numbers::Whole)
    };
    numbers.map_or_else(|| fail("a word is not a number"), Ok)
}

/// The first bytes of raw or base64 data.
fn decoded(data: &[u8], length: usize, is_raw: bool) -> Read<Vec<u8>> {
    if is_raw {
        return data.get(..length).map_or_else(|| fail("the file ends inside it"), |bytes| Ok(bytes.to_vec()));
    }
    let mut out = Vec::with_capacity(length.min(RESERVED));
    for four in data.chunks(4) {
        if out.len() >= length {
            break;
        }
        let (mut bits, mut count) = (0_u32, 0);
        for value in four.iter().map_while(|&c| base64(c)) {
            bits = bits * 64 + value;
            count += 1;
        }
        if count < 2 {
            return fail("its base64 text is damaged");
        }
        bits <<= 6 * (4 - count);
        out.extend_from_slice(&bits.to_be_bytes()[1..count]);
    }
    if out.len() < length {
        return fail("its base64 text is too short");
    }
    out.truncate(length);
    Ok(out)
}

fn base64(c: u8) -> Option<u32> {
    let value = match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    };
    Some(u32::from(value))
}

fn attributes(tag: &str) -> HashMap<String, String> {
    let mut found = HashMap::new();
    let mut rest = tag;
    while let Some((before, after)) = rest.split_once('=') {
        let name = before.rsplit(char::is_whitespace).find(|word| !word.is_empty()).unwrap_or_default();
        let after = after.trim_start();
        let Some(quote) = after.chars().next().filter(|c| matches!(c, '"' | '\'')) else { break };
        let Some((value, next)) = after[1..].split_once(quote) else { break };
        found.insert(name.to_owned(), value.to_owned());
        rest = next;
    }
    found
}

fn find(bytes: &[u8], from: usize, what: &[u8]) -> Option<usize> {
    bytes.get(from..)?.windows(what.len()).position(|window| window == what).map(|at| from + at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(xml: &str) -> Read<Vec<i64>> {
        VtkFile::parse(xml.as_bytes())?.required("Cells", "a")?.whole()
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
        let damaged = array("", "CAAAA").expect_err("one letter").to_string();
        assert_eq!(damaged, "array 'a' of Cells: its base64 text is damaged");
        assert_eq!(
            array("", "CAAA").expect_err("a cut header").to_string(),
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
        let found = attributes("DataArray Name = 'a b'\n\ttype=\"Int'32\" n='' open='no");
        let expected = [("Name", "a b"), ("type", "Int'32"), ("n", "")];
        assert_eq!(found, expected.map(|(name, value)| (name.to_owned(), value.to_owned())).into());
        assert!(attributes("DataArray Name=a type='b'").is_empty());
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
        assert!(file.array("Cells", "b").expect("no error").is_none());
        assert!(file.array("Empty", "").expect("no error").is_none());
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
                assert!(VtkFile::parse(&file).expect("tags").required("Cells", "a").is_err());
            }
        }
    }
}
