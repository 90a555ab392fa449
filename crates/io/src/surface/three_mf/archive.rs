//! Streaming ZIP writer with deflate compression. The output does not depend on the time.

use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};

const LOCAL_HEAD: u32 = 0x0403_4B50;
const CENTRAL_HEAD: u32 = 0x0201_4B50;
const END: u32 = 0x0605_4B50;
/// First format version with deflate.
const NEEDED: u16 = 20;
const DEFLATE: u16 = 8;
/// 1 January 1980, the first day of the format.
const DAY: u16 = 0x0021;

/// Archive under construction.
pub(super) struct Archive<W: Write + Seek> {
    out: W,
    /// Start of the archive in the stream.
    start: u64,
    entries: Vec<Entry>,
}

struct Entry {
    name: &'static str,
    at: u32,
    crc: u32,
    packed: u32,
    size: u32,
}

impl<W: Write + Seek> Archive<W> {
    pub(super) fn new(mut out: W) -> io::Result<Self> {
        let start = out.stream_position()?;
        Ok(Self { out, start, entries: Vec::new() })
    }

    /// Adds an entry.
    pub(super) fn add(
        &mut self,
        name: &'static str,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let at = self.position()?;
        let mut entry = Entry { name, at, crc: 0, packed: 0, size: 0 };
        // Unknown values are overwritten afterwards.
        self.out.write_all(&entry.local_head())?;
        self.out.write_all(name.as_bytes())?;
        let first = self.position()?;
        let encoder = DeflateEncoder::new(&mut self.out, Compression::fast());
        let mut counted = BufWriter::with_capacity(1 << 16, Counted { out: encoder, crc: Crc::new(), size: 0 });
        fill(&mut counted)?;
        let Counted { out: encoder, crc, size } = counted.into_inner().map_err(io::IntoInnerError::into_error)?;
        encoder.finish()?;
        let end = self.position()?;
        entry.packed = end - first;
        (entry.crc, entry.size) = (crc.sum(), u32::try_from(size).map_err(|_| too_large())?);
        self.out.seek(SeekFrom::Start(self.start + u64::from(at)))?;
        self.out.write_all(&entry.local_head())?;
        self.out.seek(SeekFrom::Start(self.start + u64::from(end)))?;
        self.entries.push(entry);
        Ok(())
    }

    /// Writes the central directory.
    pub(super) fn finish(mut self) -> io::Result<()> {
        let at = self.position()?;
        for entry in &self.entries {
            self.out.write_all(&entry.central_head())?;
            self.out.write_all(entry.name.as_bytes())?;
        }
        let (size, count) = (self.position()? - at, self.entries.len() as u16);
        let mut end = END.to_le_bytes().to_vec();
        // Single disk, no comment.
        end.extend([0, 0, count, count].map(u16::to_le_bytes).as_flattened());
        end.extend([size, at].map(u32::to_le_bytes).as_flattened());
        end.extend([0; 2]);
        self.out.write_all(&end)
    }

    fn position(&mut self) -> io::Result<u32> {
        u32::try_from(self.out.stream_position()? - self.start).map_err(|_| too_large())
    }
}

fn too_large() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, "3MF holds at most 4 GiB; write PLY or STL")
}

impl Entry {
    fn local_head(&self) -> Vec<u8> {
        let mut head = LOCAL_HEAD.to_le_bytes().to_vec();
        self.append_common(&mut head);
        head
    }

    fn central_head(&self) -> Vec<u8> {
        let mut head = CENTRAL_HEAD.to_le_bytes().to_vec();
        head.extend(NEEDED.to_le_bytes());
        self.append_common(&mut head);
        // No comment, first disk, no attributes.
        head.extend([0; 10]);
        head.extend(self.at.to_le_bytes());
        head
    }

    /// Appends the common part of both headers.
    fn append_common(&self, head: &mut Vec<u8>) {
        for n in [NEEDED, 0, DEFLATE, 0, DAY] {
            head.extend(n.to_le_bytes());
        }
        for n in [self.crc, self.packed, self.size] {
            head.extend(n.to_le_bytes());
        }
        for n in [self.name.len() as u16, 0] {
            head.extend(n.to_le_bytes());
        }
    }
}

/// Counts bytes and computes their CRC.
struct Counted<W> {
    out: W,
    crc: Crc,
    size: u64,
}

impl<W: Write> Write for Counted<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = self.out.write(bytes)?;
        self.crc.update(&bytes[..taken]);
        self.size += taken as u64;
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn entries_stand_where_the_list_says() {
        // The archive may start anywhere in the stream.
        let mut out = Cursor::new(b"before".to_vec());
        out.set_position(6);
        let mut archive = Archive::new(&mut out).unwrap();
        archive.add("a.txt", |entry| entry.write_all(b"anastomosis ")).unwrap();
        archive.add("b/c", |entry| (0..1000).try_for_each(|_| entry.write_all(b"mesh"))).unwrap();
        archive.finish().unwrap();
        let bytes = out.into_inner().split_off(6);
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let end = bytes.len() - 22;
        assert_eq!(word(end), END as usize);
        let mut at = word(end + 16);
        for (name, text) in [("a.txt", b"anastomosis ".to_vec()), ("b/c", b"mesh".repeat(1000))] {
            assert_eq!(word(at), CENTRAL_HEAD as usize);
            let (local, length) = (word(at + 42), name.len());
            assert_eq!(&bytes[at + 46..at + 46 + length], name.as_bytes());
            assert_eq!(bytes[local + 4..local + 30], bytes[at + 6..at + 32], "both heads say the same");
            let (crc, packed, size) = (word(at + 16), word(at + 20), word(at + 24));
            let first = local + 30 + length;
            let mut raw = Vec::new();
            let mut decoder = flate2::read::DeflateDecoder::new(&bytes[first..first + packed]);
            std::io::Read::read_to_end(&mut decoder, &mut raw).unwrap();
            let mut sum = Crc::new();
            sum.update(&raw);
            assert_eq!((raw.len(), sum.sum() as usize), (size, crc));
            assert_eq!(raw, text);
            at += 46 + length;
        }
        assert_eq!(at, end);
    }
}
