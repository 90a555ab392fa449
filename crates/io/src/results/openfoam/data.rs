//! Scanner of a file: words, numbers and lists, as text or binary.

use crate::results::error::ResultFault;

/// Position in a file.
pub(super) struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Encoding of lists.
    pub layout: Layout,
}

/// Encoding of lists in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Layout {
    pub binary: bool,
    /// True if labels have 8 bytes instead of 4.
    pub wide_labels: bool,
    /// True if scalars have 4 bytes instead of 8.
    pub narrow_scalars: bool,
    pub big_endian: bool,
}

impl<'a> Scanner<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, layout: Layout::default() }
    }

    /// Skips white space and comments.
    pub(super) fn skip_space(&mut self) {
        loop {
            let rest = &self.bytes[self.at..];
            let blank = rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
            let rest = &rest[blank..];
            self.at += blank;
            if rest.starts_with(b"//") {
                self.at += rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
            } else if rest.starts_with(b"/*") {
                self.at += rest.windows(2).position(|pair| pair == b"*/").map_or(rest.len(), |at| at + 2);
            } else {
                return;
            }
        }
    }

    /// Next byte after white space; `None` at the end.
    pub(super) fn peek(&mut self) -> Option<u8> {
        self.skip_space();
        self.bytes.get(self.at).copied()
    }

    /// Consumes a byte if it is next after white space.
    pub(super) fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    pub(super) fn need(&mut self, byte: u8, expected: &'static str) -> Result<(), ResultFault> {
        if self.take(byte) { Ok(()) } else { Err(self.fault(expected)) }
    }

    /// Fault at the current position.
    pub(super) fn fault(&self, expected: &'static str) -> ResultFault {
        if self.at >= self.bytes.len() {
            return ResultFault::Truncated { within: expected.to_owned() };
        }
        ResultFault::Syntax { at: self.at, expected }
    }

    /// Word up to white space or a delimiter; a quoted text is one word. Empty at a delimiter.
    pub(super) fn word(&mut self) -> &'a str {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let length = if rest.first() == Some(&b'"') {
            rest[1..].iter().position(|&b| b == b'"').map_or(rest.len(), |end| end + 2)
        } else {
            rest.iter().position(|b| b.is_ascii_whitespace() || b"{}();".contains(b)).unwrap_or(rest.len())
        };
        self.at += length;
        std::str::from_utf8(&rest[..length]).unwrap_or_default()
    }

    pub(super) fn number(&mut self, expected: &'static str) -> Result<f64, ResultFault> {
        let before = self.at;
        let word = self.word();
        word.parse().map_err(|_| {
            self.at = if word.is_empty() { self.at } else { before };
            self.fault(expected)
        })
    }

    pub(super) fn count(&mut self, expected: &'static str) -> Result<usize, ResultFault> {
        let before = self.at;
        let word = self.word();
        word.parse().map_err(|_| {
            self.at = if word.is_empty() { self.at } else { before };
            self.fault(expected)
        })
    }

    /// Values with this number of components each, without their count.
    pub(super) fn floats(
        &mut self,
        count: usize,
        components: usize,
        what: &'static str,
    ) -> Result<Vec<f64>, ResultFault> {
        if count == 0 && self.peek() != Some(b'(') {
            return Ok(Vec::new());
        }
        self.need(b'(', what)?;
        let total = count.saturating_mul(components);
        if !self.layout.binary {
            let mut values = Vec::new();
            for _ in 0..count {
                values.extend(self.tuple(components, what)?);
            }
            self.need(b')', what)?;
            return Ok(values);
        }
        let size = if self.layout.narrow_scalars { 4 } else { 8 };
        let bytes = self.raw(total.saturating_mul(size), what)?;
        let float = |bytes: &[u8]| match (bytes, self.layout.big_endian) {
            (&[a, b, c, d], false) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (&[a, b, c, d], true) => f64::from(f32::from_be_bytes([a, b, c, d])),
            (&[a, b, c, d, e, f, g, h], false) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            (&[a, b, c, d, e, f, g, h], true) => f64::from_be_bytes([a, b, c, d, e, f, g, h]),
            _ => f64::NAN,
        };
        let values = bytes.chunks_exact(size).map(float).collect();
        self.need(b')', what)?;
        Ok(values)
    }

    /// A scalar, or a tuple in parentheses.
    pub(super) fn tuple(&mut self, components: usize, what: &'static str) -> Result<Vec<f64>, ResultFault> {
        if components == 1 {
            return Ok(vec![self.number(what)?]);
        }
        self.need(b'(', what)?;
        let values = (0..components).map(|_| self.number(what)).collect::<Result<Vec<f64>, _>>()?;
        self.need(b')', what)?;
        Ok(values)
    }

    /// Labels with their count.
    pub(super) fn labels(&mut self, what: &'static str) -> Result<Vec<i64>, ResultFault> {
        let count = self.count(what)?;
        if count == 0 && self.peek() != Some(b'(') {
            return Ok(Vec::new());
        }
        self.need(b'(', what)?;
        let labels = if self.layout.binary {
            let size = if self.layout.wide_labels { 8 } else { 4 };
            let bytes = self.raw(count.saturating_mul(size), what)?;
            let label = |bytes: &[u8]| match (bytes, self.layout.big_endian) {
                (&[a, b, c, d], false) => i64::from(i32::from_le_bytes([a, b, c, d])),
                (&[a, b, c, d], true) => i64::from(i32::from_be_bytes([a, b, c, d])),
                (&[a, b, c, d, e, f, g, h], false) => i64::from_le_bytes([a, b, c, d, e, f, g, h]),
                (&[a, b, c, d, e, f, g, h], true) => i64::from_be_bytes([a, b, c, d, e, f, g, h]),
                _ => -1,
            };
            bytes.chunks_exact(size).map(label).collect()
        } else {
            (0..count).map(|_| self.count(what).map(|label| label as i64)).collect::<Result<Vec<i64>, _>>()?
        };
        self.need(b')', what)?;
        Ok(labels)
    }

    fn raw(&mut self, length: usize, what: &'static str) -> Result<&'a [u8], ResultFault> {
        let end = self.at.checked_add(length).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or_else(|| ResultFault::Truncated { within: what.to_owned() })?;
        let bytes = &self.bytes[self.at..end];
        self.at = end;
        Ok(bytes)
    }
}
