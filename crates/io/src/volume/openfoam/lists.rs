//! Binary lists of labels at fixed positions in a file.

use super::head;
use std::io::{self, Seek, SeekFrom, Write};

/// Label list in a file with random access.
pub(super) struct LabelList<F> {
    file: F,
    /// Offset of the first label.
    start: u64,
    /// End of the last label.
    end: u64,
    /// Current file offset.
    at: u64,
    /// Bytes of the last labels, kept to use their memory again.
    bytes: Vec<u8>,
}

impl<F: Write + Seek> LabelList<F> {
    /// Starts a file that contains this list only. `path` is that in its header.
    pub(super) fn alone(mut file: F, path: &str, note: &str, labels: u64) -> io::Result<Self> {
        file.write_all(head::binary("labelList", path, note).as_bytes())?;
        Self::begin(file, labels)
    }

    /// Starts the corners of faces, after the list of each face's offset. `vertices` are the numbers of vertices of all
    /// faces, in order; their sum is `corners`.
    pub(super) fn corners(
        mut file: F,
        (path, note): (&str, &str),
        (faces, corners): (u64, u64),
        vertices: impl Iterator<Item = u32>,
    ) -> io::Result<Self> {
        write!(file, "{}{}\n(", head::binary("faceCompactList", path, note), faces + 1)?;
        let mut offset = 0;
        let offsets = vertices.map(|vertices| {
            offset += vertices;
            offset
        });
        write_labels(&mut file, std::iter::once(0).chain(offsets))?;
        file.write_all(b")\n")?;
        Self::begin(file, corners)
    }

    fn begin(mut file: F, labels: u64) -> io::Result<Self> {
        write!(file, "{labels}\n(")?;
        let start = file.stream_position()?;
        Ok(Self { file, start, end: start + 4 * labels, at: start, bytes: Vec::new() })
    }

    /// Writes consecutive labels from this position in the list.
    pub(super) fn put(&mut self, first: u64, labels: &[u32]) -> io::Result<()> {
        let place = self.start + 4 * first;
        if place != self.at {
            self.file.seek(SeekFrom::Start(place))?;
        }
        self.bytes.clear();
        self.bytes.extend(labels.iter().flat_map(|label| label.to_le_bytes()));
        self.at = place + self.bytes.len() as u64;
        self.file.write_all(&self.bytes)
    }

    /// Ends the list and returns the file.
    pub(super) fn finish(mut self) -> io::Result<F> {
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(b")\n")?;
        self.file.flush()?;
        Ok(self.file)
    }
}

fn write_labels(out: &mut impl Write, labels: impl Iterator<Item = u32>) -> io::Result<()> {
    /// Number of bytes per write.
    const AT_A_TIME: usize = 1 << 18;
    let mut bytes = Vec::with_capacity(AT_A_TIME);
    for label in labels {
        bytes.extend_from_slice(&label.to_le_bytes());
        if bytes.len() >= AT_A_TIME {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)
}
