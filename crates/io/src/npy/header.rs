//! Array header: a Python dictionary with item type, order and shape.

use super::error::NpyFault;

const MAGIC: &[u8] = b"\x93NUMPY";

/// Parsed header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// Item type, such as `<f8`.
    pub descr: String,
    /// True if the first index varies fastest.
    pub fortran: bool,
    pub shape: Vec<usize>,
}

impl Header {
    /// Reads the header and returns it with the remaining bytes.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, &[u8]), NpyFault> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(NpyFault::NotNpy)?;
        let cut_off = NpyFault::Header { what: "it is cut off" };
        let [major, _, rest @ ..] = rest else { return Err(cut_off) };
        let (length, rest) = match (major, rest) {
            (1, [a, b, rest @ ..]) => (u32::from(u16::from_le_bytes([*a, *b])), rest),
            (2 | 3, [a, b, c, d, rest @ ..]) => (u32::from_le_bytes([*a, *b, *c, *d]), rest),
            (1..=3, _) => return Err(cut_off),
            (&major, _) => return Err(NpyFault::Version { major }),
        };
        let (text, data) = rest.split_at_checked(length as usize).ok_or(cut_off)?;
        let text = str::from_utf8(text).map_err(|_| NpyFault::Header { what: "it is no text" })?;
        Ok((Self::parse(text).map_err(|what| NpyFault::Header { what })?, data))
    }

    fn parse(text: &str) -> Result<Self, &'static str> {
        let mut words = HeaderText(text);
        words.expect('{', "it is not a dictionary")?;
        let (mut descr, mut fortran, mut shape) = (None, None, None);
        while !words.skip('}') {
            let key = words.quoted().ok_or("a key is not a quoted string")?;
            words.expect(':', "a key has no value")?;
            match key {
                "descr" => descr = Some(words.quoted().ok_or("records are not supported, only numbers")?),
                "fortran_order" => fortran = Some(words.truth().ok_or("the order is neither True nor False")?),
                "shape" => shape = Some(words.counts()?),
                _ => return Err("it has an unknown key"),
            }
            if !words.skip(',') {
                words.expect('}', "the dictionary is not closed")?;
                break;
            }
        }
        match (descr, fortran, shape) {
            (Some(descr), Some(fortran), Some(shape)) if words.0.trim().is_empty() => {
                Ok(Self { descr: descr.to_owned(), fortran, shape })
            }
            (Some(_), Some(_), Some(_)) => Err("unexpected text after the dictionary"),
            _ => Err("'descr', 'fortran_order' and 'shape' are needed"),
        }
    }
}

/// Remaining text.
struct HeaderText<'a>(&'a str);

impl<'a> HeaderText<'a> {
    fn skip(&mut self, mark: char) -> bool {
        let rest = self.0.trim_start().strip_prefix(mark);
        self.0 = rest.unwrap_or(self.0);
        rest.is_some()
    }

    fn expect(&mut self, mark: char, otherwise: &'static str) -> Result<(), &'static str> {
        if self.skip(mark) { Ok(()) } else { Err(otherwise) }
    }

    /// Parses a quoted text; the required ones contain no backslash.
    fn quoted(&mut self) -> Option<&'a str> {
        let text = self.0.trim_start();
        let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
        let (word, rest) = text[1..].split_once(quote)?;
        self.0 = rest;
        Some(word)
    }

    fn truth(&mut self) -> Option<bool> {
        let text = self.0.trim_start();
        let (value, rest) = match text.strip_prefix("True") {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix("False")?),
        };
        self.0 = rest;
        Some(value)
    }

    /// Parses a tuple of counts.
    fn counts(&mut self) -> Result<Vec<usize>, &'static str> {
        self.expect('(', "the shape is no tuple")?;
        let mut counts = Vec::new();
        while !self.skip(')') {
            let text = self.0.trim_start();
            let digits = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
            counts.push(text[..digits].parse().map_err(|_| "the shape is not a tuple of counts")?);
            self.0 = &text[digits..];
            if !self.skip(',') {
                self.expect(')', "the shape does not end")?;
                break;
            }
        }
        Ok(counts)
    }
}
