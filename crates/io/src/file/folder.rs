//! Atomic folders: a folder of files appears completely or not at all.

use super::atomic::AtomicFile;
use super::hidden::{locked, make_hidden, remove_left};
use super::set::OutputSet;
use super::staged::{Contents, Staged};
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// Folder under a temporary name next to its target. [`OutputSet::place`] moves it there, dropping it removes it.
#[derive(Debug)]
pub struct AtomicFolder {
    temporary: PathBuf,
    /// Lock that marks the temporary folder as in use.
    lock: Option<File>,
    target: PathBuf,
    ours: Ours,
}

/// Predicate for files of a writer, by their path within the folder with `/` as separator.
pub type Ours = fn(&str) -> bool;

impl AtomicFolder {
    /// Checks that the folder can be created or replaced: it contains only files of earlier runs. Other files, such as
    /// solver results, are never removed.
    pub fn ensure_replaceable(target: &Path, ours: Ours) -> io::Result<()> {
        let taken = |text: String| Err(io::Error::new(io::ErrorKind::AlreadyExists, text));
        match fs::metadata(target) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(error),
            Ok(data) if !data.is_dir() => {
                return taken("a folder is to be written, and a file of its name exists".into());
            }
            Ok(_) => {}
        }
        match files_in(target)?.into_iter().find(|(name, _)| !ours(name)) {
            Some((name, _)) => taken(format!("the folder exists and also holds {name}, which is not replaced")),
            None => Ok(()),
        }
    }

    /// Creates a new temporary folder.
    pub fn create(target: &Path, ours: Ours) -> io::Result<Self> {
        Self::ensure_replaceable(target, ours)?;
        remove_left(target, "part", |left| remove_ours(left, |name| ours(name) || is_part(name)));
        let (temporary, ()) = make_hidden(target, "part", |path| fs::create_dir(path))?;
        Ok(Self { lock: locked(File::open(&temporary)), temporary, target: target.to_path_buf(), ours })
    }

    /// Creates a file in the folder.
    pub fn file(&self, name: &str) -> io::Result<AtomicFile> {
        AtomicFile::create(&self.place(name)?)
    }

    /// Creates a file without waiting for the disk. The folder is flushed as a whole.
    pub fn quick_file(&self, name: &str) -> io::Result<BufWriter<File>> {
        Ok(BufWriter::with_capacity(1 << 18, File::create(self.place(name)?)?))
    }

    /// Writes a small file without waiting for the disk, as [`quick_file`](Self::quick_file).
    pub fn put(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        fs::write(self.place(name)?, bytes)
    }

    /// Copies a file of the folder to another name.
    pub fn copy(&self, name: &str, to: &str) -> io::Result<()> {
        fs::copy(self.temporary.join(name), self.place(to)?).map(drop)
    }

    fn place(&self, name: &str) -> io::Result<PathBuf> {
        debug_assert!((self.ours)(name), "{name} could not be replaced");
        let path = self.temporary.join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        Ok(path)
    }

    /// Finishes the folder, which then only has to be moved to its target.
    pub fn stage(mut self) -> OutputSet {
        let temporary = std::mem::take(&mut self.temporary);
        let ours = Box::new(self.ours);
        OutputSet::one(Staged::folder(temporary, self.target.clone(), self.lock.take(), ours))
    }
}

impl Contents for Ours {
    fn ensure_replaceable(&self, target: &Path) -> io::Result<()> {
        AtomicFolder::ensure_replaceable(target, *self)
    }

    fn remove(&self, folder: &Path) {
        remove_ours(folder, self);
    }
}

impl Drop for AtomicFolder {
    fn drop(&mut self) {
        if !self.temporary.as_os_str().is_empty() {
            remove_ours(&self.temporary, self.ours);
        }
    }
}

/// All files below a folder, with names as in [`Ours`].
fn files_in(folder: &Path) -> io::Result<Vec<(String, PathBuf)>> {
    let (mut found, mut pending) = (Vec::new(), vec![(String::new(), folder.to_path_buf())]);
    while let Some((name, folder)) = pending.pop() {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let own = entry.file_name();
            let name = if name.is_empty() {
                own.to_string_lossy().into_owned()
            } else {
                format!("{name}/{}", own.to_string_lossy())
            };
            // Symbolic links count as files.
            if entry.file_type()?.is_dir() {
                pending.push((name, entry.path()));
            } else {
                found.push((name, entry.path()));
            }
        }
    }
    Ok(found)
}

/// True for the name of an incomplete file.
fn is_part(name: &str) -> bool {
    name.rsplit('/')
        .next()
        .is_some_and(|own| own.starts_with('.') && Path::new(own).extension().is_some_and(|e| e == "part"))
}

/// Removes a writer's files and the folders that become empty. Failures are ignored.
fn remove_ours(folder: &Path, ours: impl Fn(&str) -> bool) {
    let files = files_in(folder).unwrap_or_default();
    let mut folders: Vec<&Path> = vec![folder];
    for (_, path) in files.iter().filter(|(name, _)| ours(name)) {
        let _ = fs::remove_file(path);
    }
    for (_, path) in &files {
        folders.extend(path.ancestors().skip(1).take_while(|above| *above != folder));
    }
    folders.sort_by_key(|folder| std::cmp::Reverse(folder.as_os_str().len()));
    folders.dedup();
    for folder in folders {
        let _ = fs::remove_dir(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn ours(name: &str) -> bool {
        matches!(name, "a" | "sub/b" | "sub/deep/c")
    }

    fn made(target: &Path, text: &str) -> AtomicFolder {
        let folder = AtomicFolder::create(target, ours).unwrap();
        for name in ["a", "sub/b", "sub/deep/c"] {
            let mut file = folder.file(name).unwrap();
            file.write_all(text.as_bytes()).unwrap();
            file.commit().unwrap();
        }
        folder.put("sub/b", text.as_bytes()).unwrap();
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = files_in(folder).unwrap().into_iter().map(|(name, _)| name).collect();
        names.sort();
        names
    }

    #[test]
    fn appears_only_when_committed_and_replaces() {
        let parent = tempfile::tempdir().unwrap();
        let target = parent.path().join("case.foam");
        drop(made(&target, "dropped"));
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0);
        for text in ["first", "second"] {
            made(&target, text).stage().place().unwrap();
            assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 1);
            assert_eq!(names(&target), ["a", "sub/b", "sub/deep/c"]);
            assert_eq!(fs::read_to_string(target.join("sub/deep/c")).unwrap(), text);
        }
    }

    #[test]
    fn what_others_have_put_there_stays() {
        let parent = tempfile::tempdir().unwrap();
        let target = parent.path().join("case.foam");
        made(&target, "first").stage().place().unwrap();
        let folder = made(&target, "second");
        fs::create_dir(target.join("100")).unwrap();
        fs::write(target.join("100/U"), "result").unwrap();
        let error = folder.stage().place().unwrap_err();
        assert!(error.to_string().contains("also holds 100/U"), "{error}");
        assert_eq!(fs::read_to_string(target.join("a")).unwrap(), "first");
        assert!(AtomicFolder::create(&target, ours).is_err());
        let file = parent.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(AtomicFolder::ensure_replaceable(&file, ours).is_err());
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 2);
    }

    #[test]
    fn what_a_killed_run_left_is_removed() {
        let parent = tempfile::tempdir().unwrap();
        let left = parent.path().join(".case.foam.12-0.part");
        fs::create_dir_all(left.join("sub")).unwrap();
        fs::write(left.join("a"), "whole").unwrap();
        fs::write(left.join("sub/.b.12-0.part"), "half").unwrap();
        let long_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(3600);
        File::open(&left).unwrap().set_modified(long_ago).unwrap();
        drop(AtomicFolder::create(&parent.path().join("case.foam"), ours).unwrap());
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0);
    }
}
