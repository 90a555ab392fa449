//! Atomic files: a file appears at its path completely or not at all.

use super::hidden::{locked, make_hidden, remove_left};
use super::staged::Staged;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

/// File under a temporary name in the target's folder; `commit` moves it there, dropping it removes it.
#[derive(Debug)]
pub struct AtomicFile {
    file: Option<BufWriter<File>>,
    /// Lock that marks the temporary file as in use.
    lock: Option<File>,
    temporary: PathBuf,
    target: PathBuf,
    /// Bytes written since the last background flush.
    waiting: usize,
    flusher: Option<Flusher>,
}

/// Bytes after which a background flush starts, so that the final flush is short.
const BEGIN_AFTER: usize = 256 << 20;

/// Background thread that flushes a file's data while more is written.
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

    /// Waits for the disk. Errors reported here are not reported again.
    fn finish(self) -> io::Result<()> {
        drop(self.begin);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the thread that waits for the disk failed")))
    }
}

impl AtomicFile {
    /// Creates a temporary file next to `target`.
    ///
    /// # Errors
    /// The operating system reports an error.
    pub fn create(target: &Path) -> io::Result<Self> {
        if target.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        remove_left(target, "part", |left| drop(fs::remove_file(left)));
        let make = |path: &Path| OpenOptions::new().write(true).create_new(true).open(path);
        let (temporary, file) = make_hidden(target, "part", make)?;
        Ok(Self {
            lock: locked(file.try_clone()),
            file: Some(BufWriter::with_capacity(1 << 18, file)),
            temporary,
            target: target.to_path_buf(),
            waiting: 0,
            flusher: None,
        })
    }

    /// Flushes all buffers, so that a full disk can no longer make `commit` fail.
    ///
    /// # Errors
    /// The operating system reports an error.
    pub fn complete(&mut self) -> io::Result<()> {
        if let Some(file) = self.file.take() {
            let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
            self.flusher.take().map_or(Ok(()), Flusher::finish)?;
            // Otherwise a crash of the machine could leave an empty file under the new name.
            file.sync_data()?;
        }
        Ok(())
    }

    /// Flushes the file and moves it to its target, replacing an earlier file. [`OutputSet::place`](super::OutputSet::place) flushes
    /// the new name, too.
    ///
    /// # Errors
    /// The operating system reports an error.
    pub fn commit(self) -> io::Result<()> {
        self.stage()?.place()
    }

    /// Flushes the file, which then only has to be moved to its target.
    pub(in crate::file) fn stage(mut self) -> io::Result<Staged> {
        self.complete()?;
        Ok(Staged::file(std::mem::take(&mut self.temporary), self.target.clone(), self.lock.take()))
    }

    /// Starts a background flush, unless one is in progress.
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
            drop((self.file.take(), self.lock.take()));
            // Failures are ignored, and the target is unchanged.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

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
    fn what_killed_runs_left_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let long_ago = std::time::SystemTime::now() - Duration::from_secs(3600);
        let names = [
            ".out.vtu.123-0.part",
            ".out.vtu.99-17.part",
            ".other.vtu.123-0.part",
            ".out.vtu.123.part",
            ".out.vtu.1-x.part",
        ];
        for name in names.into_iter().chain([".out.vtu.7-0.part"]) {
            File::create(path(name)).unwrap().set_modified(long_ago).unwrap();
        }
        // One file is young, one is locked.
        let young = path(".out.vtu.8-0.part");
        File::create(&young).unwrap();
        let held = locked(File::open(path(".out.vtu.7-0.part"))).unwrap();
        let other = AtomicFile::create(&path("out.vtu")).unwrap();
        File::open(&other.temporary).unwrap().set_modified(long_ago).unwrap();
        AtomicFile::create(&path("out.vtu")).unwrap().commit().unwrap();
        other.commit().unwrap();
        let left: Vec<bool> = names.iter().map(|name| path(name).exists()).collect();
        assert_eq!(left, [false, false, true, true, true]);
        assert!(young.exists() && path(".out.vtu.7-0.part").exists());
        drop(held);
    }

    #[test]
    fn refuses_folders_and_missing_folders() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(AtomicFile::create(folder.path()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        let missing = folder.path().join("missing/out.vtu");
        assert_eq!(AtomicFile::create(&missing).unwrap_err().kind(), io::ErrorKind::NotFound);
    }
}
