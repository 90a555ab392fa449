//! Atomic piece folder: appears completely, together with its index file, or not at all.

use crate::file::{AtomicFile, Contents, OutputSet, Staged, is_hidden_name, locked, make_hidden, remove_left};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Folder under a temporary name next to its target; [`OutputSet::place`] moves it there, dropping it removes it.
#[derive(Debug)]
pub(in crate::volume) struct PieceFolder {
    temporary: PathBuf,
    /// Lock that marks the temporary folder as in use.
    lock: Option<File>,
    target: PathBuf,
    /// Common start of its file names.
    stem: String,
}

impl PieceFolder {
    /// Folder for the pieces of `index`: its path without the extension.
    fn target_of(index: &Path) -> io::Result<(PathBuf, String)> {
        let stem = index.file_stem().and_then(|stem| stem.to_str());
        let stem = stem.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the name is no Unicode text"))?;
        Ok((index.with_file_name(stem), stem.to_owned()))
    }

    /// Checks that the folder can be created or replaced: it contains only pieces of an earlier mesh.
    pub(in crate::volume) fn ensure_replaceable(index: &Path) -> io::Result<()> {
        let (target, stem) = Self::target_of(index)?;
        let taken = |what: &str| {
            let text = format!("the pieces go into the folder {}, but {what}", target.display());
            Err(io::Error::new(io::ErrorKind::AlreadyExists, text))
        };
        let entries = match fs::read_dir(&target) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => return taken("a file of that name exists"),
            Err(error) => return Err(error),
        };
        for entry in entries {
            if !is_piece(&entry?.file_name(), &stem) {
                return taken("it holds other things");
            }
        }
        Ok(())
    }

    /// Creates a new temporary folder.
    pub(super) fn create(index: &Path) -> io::Result<Self> {
        Self::ensure_replaceable(index)?;
        let (target, stem) = Self::target_of(index)?;
        remove_left(&target, "part", |left| remove_pieces(left, &stem));
        let (temporary, ()) = make_hidden(&target, "part", |path| fs::create_dir(path))?;
        Ok(Self { lock: locked(File::open(&temporary)), temporary, target, stem })
    }

    /// Path of a piece in the temporary folder.
    pub(super) fn piece(&self, number: usize) -> PathBuf {
        self.temporary.join(piece_name(&self.stem, number))
    }

    /// Final path of a piece, relative to the folder of the index.
    pub(super) fn source(&self, number: usize) -> String {
        format!("{}/{}", self.stem, piece_name(&self.stem, number))
    }

    /// Finishes the folder and its index, which then only have to be moved to their targets.
    pub(super) fn stage(mut self, index: AtomicFile, path: &Path) -> io::Result<OutputSet> {
        let contents = PiecesOf { index: path.to_path_buf(), stem: self.stem.clone() };
        let temporary = std::mem::take(&mut self.temporary);
        let folder = Staged::folder(temporary, self.target.clone(), self.lock.take(), Box::new(contents));
        let mut outputs = OutputSet::one(folder);
        outputs.add(index)?;
        Ok(outputs)
    }
}

/// Pieces of an index.
#[derive(Debug)]
struct PiecesOf {
    index: PathBuf,
    stem: String,
}

impl Contents for PiecesOf {
    fn ensure_replaceable(&self, _: &Path) -> io::Result<()> {
        PieceFolder::ensure_replaceable(&self.index)
    }

    fn remove(&self, folder: &Path) {
        remove_pieces(folder, &self.stem);
    }
}

impl Drop for PieceFolder {
    fn drop(&mut self) {
        if !self.temporary.as_os_str().is_empty() {
            remove_pieces(&self.temporary, &self.stem);
        }
    }
}

fn piece_name(stem: &str, number: usize) -> String {
    format!("{stem}_{number:04}.vtu")
}

/// True for the file name of a piece.
fn is_piece(name: &std::ffi::OsStr, stem: &str) -> bool {
    let number = name.to_str().and_then(|name| name.strip_prefix(stem)?.strip_prefix('_')?.strip_suffix(".vtu"));
    number.is_some_and(|digits| digits.len() >= 4 && digits.bytes().all(|b| b.is_ascii_digit()))
}

/// True for the file name of an incomplete piece.
fn is_part(name: &std::ffi::OsStr, stem: &str) -> bool {
    let piece = name.to_str().and_then(|name| name.strip_prefix('.')?.find(".vtu.").map(|end| &name[1..end + 5]));
    piece.is_some_and(|piece| is_piece(piece.as_ref(), stem) && is_hidden_name(name, piece, "part"))
}

/// Removes a folder of pieces; a folder with other files is kept.
fn remove_pieces(folder: &Path, stem: &str) {
    // Failures are ignored, and no target is affected.
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_piece(&entry.file_name(), stem) || is_part(&entry.file_name(), stem) {
            let _ = fs::remove_file(entry.path());
        }
    }
    let _ = fs::remove_dir(folder);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn made(index: &Path, text: &str) -> (PieceFolder, AtomicFile) {
        let mut file = AtomicFile::create(index).unwrap();
        file.write_all(text.as_bytes()).unwrap();
        let folder = PieceFolder::create(index).unwrap();
        fs::write(folder.piece(0), text).unwrap();
        (folder, file)
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn appears_only_when_committed_and_replaces() {
        let parent = tempfile::tempdir().unwrap();
        let index = parent.path().join("a.b.pvtu");
        drop(made(&index, "dropped"));
        assert!(names(parent.path()).is_empty());
        for text in ["first", "second"] {
            let (folder, file) = made(&index, text);
            assert_eq!(folder.source(0), "a.b/a.b_0000.vtu");
            folder.stage(file, &index).unwrap().place().unwrap();
            assert_eq!(names(parent.path()), ["a.b", "a.b.pvtu"]);
            assert_eq!(fs::read_to_string(parent.path().join("a.b/a.b_0000.vtu")).unwrap(), text);
        }
    }

    #[test]
    fn what_was_there_comes_back_when_the_index_cannot_be_moved() {
        let parent = tempfile::tempdir().unwrap();
        let index = parent.path().join("out.pvtu");
        let (folder, file) = made(&index, "first");
        folder.stage(file, &index).unwrap().place().unwrap();
        let (folder, file) = made(&index, "second");
        fs::remove_file(&index).unwrap();
        fs::create_dir(&index).unwrap();
        assert!(folder.stage(file, &index).unwrap().place().is_err());
        assert_eq!(names(parent.path()), ["out", "out.pvtu"]);
        assert_eq!(fs::read_to_string(parent.path().join("out/out_0000.vtu")).unwrap(), "first");
    }

    #[test]
    fn what_a_killed_run_left_is_removed() {
        let parent = tempfile::tempdir().unwrap();
        let long_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(3600);
        for name in [".out.12-0.part", ".out.12-1.part"] {
            let left = parent.path().join(name);
            fs::create_dir(&left).unwrap();
            fs::write(left.join("out_0000.vtu"), "whole").unwrap();
            fs::write(left.join(".out_0001.vtu.12-0.part"), "half").unwrap();
            File::open(&left).unwrap().set_modified(long_ago).unwrap();
        }
        // A file from elsewhere.
        let theirs = parent.path().join(".out.12-1.part/notes.txt");
        fs::write(&theirs, "mine").unwrap();
        File::open(theirs.parent().unwrap()).unwrap().set_modified(long_ago).unwrap();
        drop(PieceFolder::create(&parent.path().join("out.pvtu")).unwrap());
        assert_eq!(names(parent.path()), [".out.12-1.part"]);
        assert_eq!(names(theirs.parent().unwrap()), ["notes.txt"]);
    }

    #[test]
    fn names_of_pieces() {
        let is = |name: &str| is_piece(name.as_ref(), "o_1");
        assert!(is("o_1_0000.vtu") && is("o_1_12345.vtu"));
        assert!(!is("o_1_000.vtu") && !is("o_1_000x.vtu") && !is("o_0000.vtu") && !is("o_1_0000.vtp"));
    }
}
