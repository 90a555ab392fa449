//! Words and numbers of text files, with the line that each stands in.

use anastomesh_mesh::geometry::Point3;
use std::fmt;

/// Where something stands in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// In a line, numbered from 1.
    Line(usize),
    /// At a byte, numbered from 0.
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

/// What can be wrong with the words of a text file. Lines are numbered from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TextFault {
    /// Something else stands where a number has to be.
    #[error("line {line}: '{text}' stands where {what} has to be: correct it")]
    NotANumber {
        /// Line of the file, from 1.
        line: usize,
        /// What had to be there.
        what: &'static str,
        /// What is there.
        text: String,
    },
    /// A coordinate is infinite or not a number.
    #[error("line {line}: {what} is '{text}'; it must be a finite number: correct it")]
    NotFinite {
        /// Line of the file, from 1.
        line: usize,
        /// What the number is.
        what: &'static str,
        /// What is there.
        text: String,
    },
    /// A number is beyond what its place can hold.
    #[error("line {line}: {what} is {value}, which is too small or too large: correct it")]
    OutOfRange {
        /// Line of the file, from 1.
        line: usize,
        /// What the number is.
        what: &'static str,
        /// The number.
        value: i64,
    },
    /// A count says more than the rest of the file can hold.
    #[error(
        "line {line}: {what} is {count}, more than the rest of the file can hold; \
         correct it, or write or copy the file again if it is cut short"
    )]
    CountTooLarge {
        /// Line of the file, from 1.
        line: usize,
        /// What is counted.
        what: &'static str,

        /// Number that was found.
        count: i64,
    },
    /// A line ends before everything is in it.
    #[error("line {line} ends before {missing}: complete it")]
    LineTooShort {
        /// Line of the file, from 1.
        line: usize,
        /// Missing item.
        missing: &'static str,
    },
    /// The file ends before it is complete.
    #[error(
        "line {line}: the file ends before {missing}: a count in it is wrong, or it was not written or copied completely"
    )]
    CutShort {
        /// The last line.
        line: usize,

        /// Missing item.
        missing: &'static str,
    },
    /// There is more in the file than it says.
    #[error("line {line} lies behind all that the counts of the file announce: correct the counts or remove it")]
    Surplus {
        /// Line of the file, from 1.
        line: usize,
    },
}

/// A place in a text.
#[derive(Clone, Debug)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    /// Whether `#` begins a comment.
    comments: bool,
}

impl<'a> Words<'a> {
    /// The beginning of a text; a byte order mark is passed over.
    pub(super) fn new(bytes: &'a [u8], comments: bool) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Self { bytes, at: 0, line: 1, comments }
    }

    /// A text that begins at a line of a longer one.
    pub(super) fn from_line(bytes: &'a [u8], line: usize) -> Self {
        Self { bytes, at: 0, line, comments: false }
    }

    /// The line of the word that was read last.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// How many bytes are left.
    pub(super) fn rest(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Passes over blanks and a comment, up to the end of the line.
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

    /// The next word of this line.
    pub(super) fn word_here(&mut self) -> Option<&'a [u8]> {
        self.skip_blanks();
        let rest = &self.bytes[self.at..];
        let ends = |&b: &u8| b.is_ascii_whitespace() || (self.comments && b == b'#');
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        self.at += length;
        (length > 0).then(|| &rest[..length])
    }

    /// The next word, in this line or below.
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

    /// Moves behind the end of the line; false at the end of the file.
    fn newline(&mut self) -> bool {
        self.skip_blanks();
        let there = self.at < self.bytes.len();
        if there {
            self.at += 1;
            self.line += 1;
        }
        there
    }

    /// Passes over the rest of the line.
    pub(super) fn skip_line(&mut self) {
        while self.word_here().is_some() {}
        self.newline();
    }

    /// The next word without moving to it.
    pub(super) fn peek(&self) -> Option<&'a [u8]> {
        self.clone().word()
    }

    /// Nothing may follow.
    pub(super) fn expect_end(&mut self) -> Result<(), TextFault> {
        if self.word().is_some() { Err(TextFault::Surplus { line: self.line }) } else { Ok(()) }
    }

    /// The next word, which has to exist.
    pub(super) fn need(&mut self, what: &'static str) -> Result<&'a [u8], TextFault> {
        self.word().ok_or(TextFault::CutShort { line: self.line, missing: what })
    }

    /// The next word of this line, which has to exist.
    pub(super) fn need_here(&mut self, what: &'static str) -> Result<&'a [u8], TextFault> {
        match self.word_here() {
            Some(word) => Ok(word),
            None if self.at >= self.bytes.len() => Err(TextFault::CutShort { line: self.line, missing: what }),
            None => Err(TextFault::LineTooShort { line: self.line, missing: what }),
        }
    }

    /// What a word is as a number.
    pub(super) fn as_float(&self, word: &[u8], what: &'static str) -> Result<f64, TextFault> {
        std::str::from_utf8(word).ok().and_then(|w| w.parse().ok()).ok_or_else(|| self.not_a_number(word, what))
    }

    /// What a word is as a finite number.
    pub(super) fn as_finite(&self, word: &[u8], what: &'static str) -> Result<f64, TextFault> {
        let value = self.as_float(word, what)?;
        if value.is_finite() {
            return Ok(value);
        }
        Err(TextFault::NotFinite { line: self.line, what, text: shown(word) })
    }

    /// What a word is as an integer; some programs write `1.0`.
    pub(super) fn as_integer(&self, word: &[u8], what: &'static str) -> Result<i64, TextFault> {
        if let Some(value) = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok()) {
            return Ok(value);
        }
        let value = self.as_float(word, what)?;
        let integral = value.fract() == 0.0 && value.abs() < 1e15;
        if integral { Ok(value as i64) } else { Err(self.not_a_number(word, what)) }
    }

    /// The word as a marker or label.
    pub(super) fn as_marker(&self, word: &[u8], what: &'static str) -> Result<i32, TextFault> {
        let value = self.as_integer(word, what)?;
        i32::try_from(value).map_err(|_| TextFault::OutOfRange { line: self.line, what, value })
    }

    fn not_a_number(&self, word: &[u8], what: &'static str) -> TextFault {
        TextFault::NotANumber { line: self.line, what, text: shown(word) }
    }

    /// The next number of this line.
    pub(super) fn float_here(&mut self, what: &'static str) -> Result<f64, TextFault> {
        let word = self.need_here(what)?;
        self.as_float(word, what)
    }

    /// The next finite number of this line.
    pub(super) fn finite_here(&mut self, what: &'static str) -> Result<f64, TextFault> {
        let word = self.need_here(what)?;
        self.as_finite(word, what)
    }

    /// The next word of this line as a marker or label.
    pub(super) fn marker_here(&mut self, what: &'static str) -> Result<i32, TextFault> {
        let word = self.need_here(what)?;
        self.as_marker(word, what)
    }

    /// The next word of this line as a count, as in [`Self::count`]; 0 at the end of the line.
    pub(super) fn count_here(&mut self, what: &'static str, least: usize) -> Result<usize, TextFault> {
        self.word_here().map_or(Ok(0), |word| self.as_count(word, what, least))
    }

    /// The next word of this line as a number that says whether there is something; no at the end of the line.
    pub(super) fn flag_here(&mut self, what: &'static str) -> Result<bool, TextFault> {
        self.word_here().map_or(Ok(false), |word| Ok(self.as_integer(word, what)? != 0))
    }

    /// The next number, in this line or below.
    pub(super) fn finite(&mut self, what: &'static str) -> Result<f64, TextFault> {
        let word = self.need(what)?;
        self.as_finite(word, what)
    }

    /// The next three numbers.
    pub(super) fn point(&mut self) -> Result<Point3, TextFault> {
        Ok(Point3::new(self.finite("coordinate x")?, self.finite("coordinate y")?, self.finite("coordinate z")?))
    }

    /// The next three numbers of this line.
    pub(super) fn point_here(&mut self) -> Result<Point3, TextFault> {
        let mut point = Point3::origin();
        for (axis, what) in ["coordinate x", "coordinate y", "coordinate z"].into_iter().enumerate() {
            point[axis] = self.finite_here(what)?;
        }
        Ok(point)
    }

    /// The next integer, in this line or below.
    pub(super) fn integer(&mut self, what: &'static str) -> Result<i64, TextFault> {
        let word = self.need(what)?;
        self.as_integer(word, what)
    }

    /// The next word as a count of things that take at least `least` bytes each: never more than the file can hold.
    pub(super) fn count(&mut self, what: &'static str, least: usize) -> Result<usize, TextFault> {
        let word = self.need(what)?;
        self.as_count(word, what, least)
    }

    /// A word as a count of things that take at least `least` bytes each.
    fn as_count(&self, word: &[u8], what: &'static str, least: usize) -> Result<usize, TextFault> {
        let count = self.as_integer(word, what)?;
        let line = self.line;
        if count < 0 {
            return Err(TextFault::OutOfRange { line, what, value: count });
        }
        // The last thing needs no separator behind it; ids are u32.
        let most = ((self.bytes.len() - self.at + 1) / least.max(1)).min(u32::MAX as usize - 1);
        if count as u64 > most as u64 {
            return Err(TextFault::CountTooLarge { line, what, count });
        }
        Ok(count as usize)
    }
}

/// The index of what is numbered from `first` on, if there are so many.
pub(super) fn from_first(number: i64, first: u32, count: usize) -> Option<u32> {
    let index = number.checked_sub(first.into()).and_then(|index| usize::try_from(index).ok());
    index.filter(|&index| index < count).map(|index| index as u32)
}

/// The beginning of a word, for a message.
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
