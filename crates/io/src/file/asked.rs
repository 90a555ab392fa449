//! Cancellable output stream.

use anastomesh_mesh::progress::{Progress, ask};
use std::io::{self, Seek, SeekFrom, Write};

/// Checks for cancellation before each write; a cancelled file does not appear.
pub struct Asked<'a, W> {
    pub out: W,
    pub progress: &'a dyn Progress,
}

impl<W: Write> Write for Asked<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        ask(self.progress)?;
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl<W: Seek> Seek for Asked<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.out.seek(to)
    }
}
