//! Cursor over the sections and numbers of a text or binary MSH file.

use super::error::MshFault;

/// Versions with different section contents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    /// Versions 2 to 2.2, as text.
    Two,
    /// Version 4.1.
    Four,
}

/// Position in the file.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    binary: bool,
}

impl<'a> Cursor<'a> {
    /// Starts at the beginning of a file.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, binary: false }
    }

    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Takes the rest of the line as text.
    pub(super) fn line(&mut self) -> Result<&'a str, MshFault> {
        let rest = self.rest();
        let length = rest.iter().position(|&b| b == b'\n').ok_or(MshFault::CutShort)?;
        self.at += length + 1;
        std::str::from_utf8(&rest[..length]).map(str::trim).map_err(|_| self.bad())
    }

    /// Error of an unexpected item at this position.
    pub(super) fn bad(&self) -> MshFault {
        MshFault::BadNumber { byte: self.at }
    }

    /// Takes the next word of a text.
    fn word(&mut self) -> Result<&'a str, MshFault> {
        let rest = self.rest();
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).ok_or(MshFault::CutShort)?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).ok_or(MshFault::CutShort)?;
        let word = std::str::from_utf8(&rest[start..start + length]).map_err(|_| self.bad())?;
        self.at += start + length;
        Ok(word)
    }

    /// Takes the next number: bytes in a binary file, a word in a text.
    fn number<T: std::str::FromStr, const W: usize>(&mut self, of: impl Fn([u8; W]) -> T) -> Result<T, MshFault> {
        if self.binary {
            let (taken, rest) = self.rest().split_first_chunk().ok_or(MshFault::CutShort)?;
            self.at = self.bytes.len() - rest.len();
            return Ok(of(*taken));
        }
        let word = self.word()?;
        word.parse().map_err(|_| self.bad())
    }

    pub(super) fn int(&mut self) -> Result<i32, MshFault> {
        self.number(i32::from_le_bytes)
    }

    pub(super) fn size(&mut self) -> Result<u64, MshFault> {
        self.number(u64::from_le_bytes)
    }

    /// Takes the next `N` sizes or tags.
    pub(super) fn sizes<const N: usize>(&mut self) -> Result<[u64; N], MshFault> {
        let mut sizes = [0; N];
        for size in &mut sizes {
            *size = self.size()?;
        }
        Ok(sizes)
    }

    pub(super) fn float(&mut self) -> Result<f64, MshFault> {
        self.number(f64::from_le_bytes)
    }

    /// Skips numbers.
    pub(super) fn skip_floats(&mut self, count: usize) -> Result<(), MshFault> {
        (0..count).try_for_each(|_| self.float().map(drop))
    }

    /// Moves to the next section and returns its name; `None` at the end of the file.
    pub(super) fn next_section(&mut self) -> Result<Option<&'a str>, MshFault> {
        let Some(start) = self.rest().iter().position(|b| !b.is_ascii_whitespace()) else { return Ok(None) };
        self.at += start;
        match self.line()?.strip_prefix('$') {
            Some(name) => Ok(Some(name)),
            None => Err(self.bad()),
        }
    }

    /// Moves past the line that ends a section.
    pub(super) fn finish_section(&mut self, name: &str) -> Result<(), MshFault> {
        let end = format!("$End{name}");
        let found =
            self.rest().windows(end.len()).position(|window| window == end.as_bytes()).ok_or(MshFault::CutShort)?;
        self.at += found + end.len();
        Ok(())
    }

    /// Reads the format section and returns the version.
    pub(super) fn read_format(&mut self) -> Result<Version, MshFault> {
        let line = self.line()?;
        let mut words = line.split_whitespace();
        let version = words.next().unwrap_or_default();
        let (binary, width) = (words.next() == Some("1"), words.next());
        match (version, binary) {
            ("4.1", _) => {}
            ("2" | "2.1" | "2.2", false) => return Ok(Version::Two),
            ("2" | "2.1" | "2.2", true) => {
                return Err(MshFault::UnsupportedVersion { version: format!("{version}, binary") });
            }
            _ => return Err(MshFault::UnsupportedVersion { version: version.chars().take(20).collect() }),
        }
        if binary {
            self.binary = true;
            if width != Some("8") || self.int()? != 1 {
                return Err(MshFault::UnsupportedVersion { version: "4.1, other byte order or width".into() });
            }
        }
        Ok(Version::Four)
    }
}
