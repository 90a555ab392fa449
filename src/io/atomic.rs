//! Files that appear at their path whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

/// A file under a temporary name in the folder of its target; `commit` moves it there, dropping it removes it.
#[derive(Debug)]
pub(super) struct AtomicFile {
    file: Option<BufWriter<File>>,
    temporary: PathBuf,
    target: PathBuf,
    /// Bytes since the disk was last told to begin.
    waiting: usize,
    flusher: Option<Flusher>,
}

/// After so many bytes the disk begins to write, while the program goes on: else all of it waits for the end.
const BEGIN_AFTER: usize = 256 << 20;

/// Makes a file's bytes reach the disk while more are written.
#[derive(Debug)]
struct Flusher {
    begin: SyncSender<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl Flusher {
    fn new(file: &File) -> io::Result<Self> {
        let file = file.try_clone()?;
        let (begin, asked) = sync_channel::<()>(1);
        let thread = std::thread::Builder::new().spawn(move || asked.iter().try_for_each(|()| file.sync_data()))?;
        Ok(Self { begin, thread })
    }

    /// Waits for the disk. What it reports here it will not report again.
    fn finish(self) -> io::Result<()> {
        drop(self.begin);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the thread that waits for the disk failed")))
    }
}

impl AtomicFile {
    /// Opens a new temporary file beside `target`.
    pub(super) fn create(target: &Path) -> io::Result<Self> {
        if target.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        let make = |path: &Path| OpenOptions::new().write(true).create_new(true).open(path);
        let (temporary, file) = make_hidden(target, "part", make)?;
        Ok(Self {
            file: Some(BufWriter::with_capacity(1 << 18, file)),
            temporary,
            target: target.to_path_buf(),
            waiting: 0,
            flusher: None,
        })
    }

    /// Writes out what is buffered: afterwards no full disk can be in the way of `commit`.
    pub(super) fn complete(&mut self) -> io::Result<()> {
        if let Some(file) = self.file.take() {
            let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
            self.flusher.take().map_or(Ok(()), Flusher::finish)?;
            // Without this a crash of the machine could leave the new name on an empty file.
            file.sync_data()?;
        }
        Ok(())
    }

    /// Writes out what is buffered and moves the file to its target, replacing what was there.
    pub(super) fn commit(mut self) -> io::Result<()> {
        self.complete()?;
        fs::rename(&self.temporary, &self.target)?;
        self.temporary = PathBuf::new();
        Ok(())
    }

    /// Makes the disk begin; it may be busy with what it was told before.
    fn begin(&mut self) -> io::Result<()> {
        if self.flusher.is_none() {
            self.flusher = Some(Flusher::new(self.open()?.get_ref())?);
        }
        if let Some(flusher) = &self.flusher {
            let _ = flusher.begin.try_send(());
        }
        Ok(())
    }

    fn open(&mut self) -> io::Result<&mut BufWriter<File>> {
        self.file.as_mut().ok_or_else(|| io::Error::from(io::ErrorKind::BrokenPipe))
    }
}

/// Makes something under a hidden name beside `target` that nothing has yet.
pub(super) fn make_hidden<T>(
    target: &Path,
    kind: &str,
    make: impl Fn(&Path) -> io::Result<T>,
) -> io::Result<(PathBuf, T)> {
    let name = target.file_name().ok_or_else(|| io::Error::from(io::ErrorKind::InvalidInput))?;
    let mut attempt = 0_u32;
    loop {
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{attempt}.{kind}", std::process::id()));
        let path = target.with_file_name(hidden);
        match make(&path) {
            Ok(made) => return Ok((path, made)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 1000 => attempt += 1,
            Err(error) => return Err(error),
        }
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.open()?.write(bytes)?;
        self.waiting += written;
        if self.waiting >= BEGIN_AFTER {
            self.waiting = 0;
            self.begin()?;
        }
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.open()?.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
        self.open()?.seek(to)
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if !self.temporary.as_os_str().is_empty() {
            drop(self.file.take());
            // Nothing can be done about a failure here, and the target is untouched.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn appears_only_when_committed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.vtu");
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"half").unwrap();
        assert!(!path.exists());
        drop(file);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"whole").unwrap();
        file.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn refuses_folders_and_missing_folders() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(AtomicFile::create(folder.path()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        let missing = folder.path().join("missing/out.vtu");
        assert_eq!(AtomicFile::create(&missing).unwrap_err().kind(), io::ErrorKind::NotFound);
    }
}
