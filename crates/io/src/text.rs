//! Parsing of words and numbers in text files, with line numbers.

use anastomesh_mesh::geometry::Point3;
use std::fmt;

/// Position in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// Line number, from 1.
    Line(usize),
    /// Byte offset, from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Errors of a text file. Lines are numbered from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TextFault {
    /// A word is not a number.
    #[error("line {line}: expected {what}, found '{text}': correct it")]
    NotANumber {
        /// Line of the file, from 1.
        line: usize,
        /// Expected item.
        what: &'static str,
        /// Text found.
        text: String,
    },
    /// A coordinate is infinite or NaN.
    #[error("line {line}: {what} is '{text}', not a finite number: correct it")]
    NotFinite {
        /// Line of the file, from 1.
        line: usize,
        /// Name of the number.
        what: &'static str,
        /// Text found.
        text: String,
    },
    /// A number is out of range.
    #[error("line {line}: {what} is {value}, which is too small or too large: correct it")]
    OutOfRange {
        /// Line of the file, from 1.
        line: usize,
        /// Name of the number.
        what: &'static str,
        /// Value found.
        value: i64,
    },
    /// A count exceeds the rest of the file.
    #[error(
        "line {line}: {what} is {count}, more than the rest of the file contains; \
         correct it, or copy the file again if it is truncated"
    )]
    CountTooLarge {
        /// Line of the file, from 1.
        line: usize,
        /// Counted item.
        what: &'static str,

        /// Number that was found.
        count: i64,
    },
    /// A line ends before it is complete.
    #[error("line {line} ends before {missing}: complete it")]
    LineTooShort {
        /// Line of the file, from 1.
        line: usize,
        /// Missing item.
        missing: &'static str,
    },
    /// The file ends before it is complete.
    #[error("line {line}: the file ends before {missing}: a count is wrong, or the file is truncated")]
    CutShort {
        /// Last line.
        line: usize,

        /// Missing item.
        missing: &'static str,
    },
    /// The file has more data than announced.
    #[error("line {line} exceeds the counts of the file: correct the counts, or remove the line")]
    Surplus {
        /// Line of the file, from 1.
        line: usize,
    },
}

/// Cursor over the words of a text.
#[derive(Clone, Debug)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    /// True if `#` starts a comment.
    comments: bool,
}

impl<'a> Words<'a> {
    /// Starts at the beginning of a text, after an optional byte order mark.
    pub(super) fn new(bytes: &'a [u8], comments: bool) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Self { bytes, at: 0, line: 1, comments }
    }

    /// Starts at a given line of a longer text.
    pub(super) fn from_line(bytes: &'a [u8], line: usize) -> Self {
        Self { bytes, at: 0, line, comments: false }
    }

    /// Line of the last word read.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Number of remaining bytes.
    pub(super) fn rest(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Skips spaces and a comment up to the end of the line.
    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.at) {
            if self.comments && byte == b'#' {
                while self.bytes.get(self.at).is_some_and(|&b| b != b'\n') {
                    self.at += 1;
                }
            } else if byte == b'\n' || !byte.is_ascii_whitespace() {
                return;
            } else {
                self.at += 1;
            }
        }
    }

    /// Takes the next word of the line.
    pub(super) fn word_here(&mut self) -> Option<&'a [u8]> {
        self.skip_blanks();
        let rest = &self.bytes[self.at..];
        let ends = |&b: &u8| b.is_ascii_whitespace() || (self.comments && b == b'#');
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        self.at += length;
        (length > 0).then(|| &rest[..length])
    }

    /// Takes the next word of this or a later line.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(word) = self.word_here() {
                return Some(word);
            }
            if !self.newline() {
                return None;
            }
        }
    }

    /// Moves past the end of the line; returns false at the end of the file.
    fn newline(&mut self) -> bool {
        self.skip_blanks();
        let there = self.at < self.bytes.len();
        if there {
            self.at += 1;
            self.line += 1;
        }
        there
    }

    /// Takes the rest of the line, without its end and a comment.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let ends = |&b: &u8| b == b'\n' || (self.comments && b == b'#');
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    /// Skips the rest of the line.
    pub(super) fn skip_line(&mut self) {
        while self.word_here().is_some() {}
        self.newline();
    }

    /// Returns the next word without moving.
    pub(super) fn peek(&self) -> Option<&'a [u8]> {
        self.clone().word()
    }

    /// Checks that no word follows.
    pub(super) fn expect_end(&mut self) -> Result<(), TextFault> {
        if self.word().is_some() { Err(TextFault::Surplus { line: self.line }) } else { Ok(()) }
    }

    /// Takes the next word, which is required.
    pub(super) fn need(&mut self, what: &'static str) -> Result<&'a [u8], TextFault> {
        self.word().ok_or(TextFault::CutShort { line: self.line, missing: what })
    }

    /// Takes the next word of the line, which is required.
    pub(super) fn need_here(&mut self, what: &'static str) -> Result<&'a [u8], TextFault> {
        match self.word_here() {
            Some(word) => Ok(word),
            None if self.at >= self.bytes.len() => Err(TextFault::CutShort { line: self.line, missing: what }),
            None => Err(TextFault::LineTooShort { line: self.line, missing: what }),
        }
    }

    /// Parses a word as a number.
    pub(super) fn as_float(&self, word: &[u8], what: &'static str) -> Result<f64, TextFault> {
        std::str::from_utf8(word).ok().and_then(|w| w.parse().ok()).ok_or_else(|| self.not_a_number(word, what))
    }

    /// Parses a word as a finite number.
    pub(super) fn as_finite(&self, word: &[u8], what: &'static str) -> Result<f64, TextFault> {
        let value = self.as_float(word, what)?;
        if value.is_finite() {
            return Ok(value);
        }
        Err(TextFault::NotFinite { line: self.line, what, text: shown(word) })
    }

    /// Parses a word as an integer; some programs write `1.0`.
    pub(super) fn as_integer(&self, word: &[u8], what: &'static str) -> Result<i64, TextFault> {
        if let Some(value) = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok()) {
            return Ok(value);
        }
        let value = self.as_float(word, what)?;
        let integral = value.fract() == 0.0 && value.abs() < 1e15;
        if integral { Ok(value as i64) } else { Err(self.not_a_number(word, what)) }
    }

    /// Parses a word as a marker or label.
    pub(super) fn as_marker(&self, word: &[u8], what: &'static str) -> Result<i32, TextFault> {
        let value = self.as_integer(word, what)?;
        i32::try_from(value).map_err(|_| TextFault::OutOfRange { line: self.line, what, value })
    }

    fn not_a_number(&self, word: &[u8], what: &'static str) -> TextFault {
        TextFault::NotANumber { line: self.line, what, text: shown(word) }
    }

    /// Takes the next number of the line.
    pub(super) fn float_here(&mut self, what: &'static str) -> Result<f64, TextFault> {
        let word = self.need_here(what)?;
        self.as_float(word, what)
    }

    /// Takes the next finite number of the line.
    pub(super) fn finite_here(&mut self, what: &'static str) -> Result<f64, TextFault> {
        let word = self.need_here(what)?;
        self.as_finite(word, what)
    }

    /// Takes the next marker or label of the line.
    pub(super) fn marker_here(&mut self, what: &'static str) -> Result<i32, TextFault> {
        let word = self.need_here(what)?;
        self.as_marker(word, what)
    }

    /// Takes the next count of the line, as in [`Self::count`]; 0 at the end of the line.
    pub(super) fn count_here(&mut self, what: &'static str, least: usize) -> Result<usize, TextFault> {
        self.word_here().map_or(Ok(0), |word| self.as_count(word, what, least))
    }

    /// Takes the next flag of the line; false at the end of the line.
    pub(super) fn flag_here(&mut self, what: &'static str) -> Result<bool, TextFault> {
        self.word_here().map_or(Ok(false), |word| Ok(self.as_integer(word, what)? != 0))
    }

    /// Takes the next number of this or a later line.
    pub(super) fn finite(&mut self, what: &'static str) -> Result<f64, TextFault> {
        let word = self.need(what)?;
        self.as_finite(word, what)
    }

    /// Takes the next three numbers.
    pub(super) fn point(&mut self) -> Result<Point3, TextFault> {
        Ok(Point3::new(self.finite("coordinate x")?, self.finite("coordinate y")?, self.finite("coordinate z")?))
    }

    /// Takes the next three numbers of the line.
    pub(super) fn point_here(&mut self) -> Result<Point3, TextFault> {
        let mut point = Point3::origin();
        for (axis, what) in ["coordinate x", "coordinate y", "coordinate z"].into_iter().enumerate() {
            point[axis] = self.finite_here(what)?;
        }
        Ok(point)
    }

    /// Takes the next integer of this or a later line.
    pub(super) fn integer(&mut self, what: &'static str) -> Result<i64, TextFault> {
        let word = self.need(what)?;
        self.as_integer(word, what)
    }

    /// Takes the count of items with at least `least` bytes each. The count never exceeds the rest of the file.
    pub(super) fn count(&mut self, what: &'static str, least: usize) -> Result<usize, TextFault> {
        let word = self.need(what)?;
        self.as_count(word, what, least)
    }

    /// Parses a word as the count of items with at least `least` bytes each.
    fn as_count(&self, word: &[u8], what: &'static str, least: usize) -> Result<usize, TextFault> {
        let count = self.as_integer(word, what)?;
        let line = self.line;
        if count < 0 {
            return Err(TextFault::OutOfRange { line, what, value: count });
        }
        // The last item needs no separator; ids are u32.
        let most = ((self.bytes.len() - self.at + 1) / least.max(1)).min(u32::MAX as usize - 1);
        if count as u64 > most as u64 {
            return Err(TextFault::CountTooLarge { line, what, count });
        }
        Ok(count as usize)
    }
}

/// Zero-based index of a number that counts from `first`, if it is below `count`.
pub(super) fn from_first(number: i64, first: u32, count: usize) -> Option<u32> {
    let index = number.checked_sub(first.into()).and_then(|index| usize::try_from(index).ok());
    index.filter(|&index| index < count).map(|index| index as u32)
}

/// Start of a word, for a message.
pub(super) fn shown(word: &[u8]) -> String {
    String::from_utf8_lossy(word).chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_know_their_lines() {
        let mut words = Words::new(b"\xef\xbb\xbfone # two\n\n three\r\nfour", true);
        assert_eq!(words.word(), Some(&b"one"[..]));
        assert_eq!(words.word_here(), None);
        assert_eq!((words.word(), words.line()), (Some(&b"three"[..]), 3));
        assert_eq!(words.word_here(), None);
        assert_eq!((words.word(), words.line()), (Some(&b"four"[..]), 4));
        assert_eq!(words.word(), None);
        assert!(words.expect_end().is_ok());
    }

    #[test]
    fn counts_are_bounded_by_the_file() {
        let count = |text: &[u8]| Words::new(text, true).count("a count", 2);
        assert_eq!(count(b"2 a b"), Ok(2));
        assert_eq!(count(b"2.0 a b"), Ok(2));
        assert!(matches!(count(b"4 a b"), Err(TextFault::CountTooLarge { line: 1, count: 4, .. })));
        assert!(matches!(count(b"99999999999999 a"), Err(TextFault::CountTooLarge { .. })));
        assert!(matches!(count(b"-1 a b"), Err(TextFault::OutOfRange { value: -1, .. })));
        assert!(matches!(count(b"1.5 a b"), Err(TextFault::NotANumber { .. })));
        assert!(matches!(count(b"# nothing"), Err(TextFault::CutShort { .. })));
    }

    #[test]
    fn only_finite_numbers_are_coordinates() {
        for text in ["nan", "inf", "-infinity", "1e999"] {
            let fault = Words::new(text.as_bytes(), true).finite("coordinate x").unwrap_err();
            assert!(matches!(fault, TextFault::NotFinite { line: 1, .. }), "{text}");
        }
        assert!(matches!(Words::new(b"1,5", true).finite("coordinate x"), Err(TextFault::NotANumber { .. })));
    }
}
