//! Cursor in a legacy VTK file, whose keyword lines are text even with binary arrays.

use super::error::VtkLegacyError;
use crate::text::Place;
use crate::text::shown;

pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// True if arrays are binary.
    pub binary: bool,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), at: 0, binary: false }
    }

    /// Current position, for a message.
    pub(super) fn place(&self) -> Place {
        self.place_of(self.at)
    }

    pub(super) fn place_of(&self, at: usize) -> Place {
        if self.binary {
            return Place::Byte(at);
        }
        Place::Line(self.bytes[..at].split(|&b| b == b'\n').count())
    }

    /// Takes the rest of the line; `None` at the end of the file.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        Some(rest[..length].trim_ascii_end())
    }

    /// Takes the next non-blank line as words, with its position.
    pub(super) fn keywords(&mut self) -> Option<(Place, Vec<String>)> {
        loop {
            let at = self.at;
            let line = self.line()?;
            let words: Vec<String> =
                line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).map(shown_whole).collect();
            if !words.is_empty() {
                return Some((self.place_of(at), words));
            }
        }
    }

    /// True if the next non-blank line starts with a word.
    pub(super) fn next_is(&self, word: &[u8]) -> bool {
        let rest = self.bytes[self.at..].trim_ascii_start();
        rest.get(..word.len()).is_some_and(|w| w.eq_ignore_ascii_case(word))
            && rest.get(word.len()).is_none_or(u8::is_ascii_whitespace)
    }

    /// Takes `length` bytes.
    pub(super) fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let taken = self.bytes[self.at..].get(..length)?;
        self.at += length;
        Some(taken)
    }

    /// Takes `count` words as one slice.
    pub(super) fn take_words(&mut self, count: usize) -> Option<&'a [u8]> {
        // Each word has at least one byte and a separator.
        if count > self.bytes.len() - self.at {
            return None;
        }
        let (start, mut left, mut inside) = (self.at, count, false);
        let mut end = start;
        while left > 0 || inside {
            let space = self.bytes.get(end).is_none_or(u8::is_ascii_whitespace);
            if !space && !inside {
                if left == 0 {
                    break;
                }
                left -= 1;
            }
            inside = !space;
            if end >= self.bytes.len() {
                break;
            }
            end += 1;
        }
        self.at = end;
        (left == 0).then(|| &self.bytes[start..end])
    }

    /// Skips a block that ends with a blank line.
    pub(super) fn skip_block(&mut self) {
        while self.line().is_some_and(|line| !line.is_empty()) {}
    }

    /// Error of a keyword line.
    pub(super) fn bad(place: Place, words: &[String], needed: &'static str) -> VtkLegacyError {
        let keyword = words.first().map(|w| shown(w.as_bytes())).unwrap_or_default();
        VtkLegacyError::BadKeyword { place, keyword, needed }
    }
}

/// Word of a line, with invalid UTF-8 replaced.
fn shown_whole(word: &[u8]) -> String {
    String::from_utf8_lossy(word).into_owned()
}
