//! Whole files: read, written so that they appear complete or not at all, and known by their extension.

use super::asked::Asked;
use super::atomic::AtomicFile;
use super::error::FileError;
use anastomesh_mesh::progress::Progress;
use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The bytes of a file that is not empty.
pub fn read_bytes<F: Error>(path: &Path) -> Result<Vec<u8>, FileError<F>> {
    if path.is_dir() {
        return Err(FileError::read(path)(io::ErrorKind::IsADirectory.into()));
    }
    let bytes = std::fs::read(path).map_err(FileError::read(path))?;
    if bytes.trim_ascii().is_empty() {
        return Err(FileError::Empty { path: path.to_path_buf() });
    }
    Ok(bytes)
}

/// Writes a file that appears whole or not at all.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut AtomicFile) -> io::Result<()>) -> io::Result<()> {
    let mut file = AtomicFile::create(path)?;
    write(&mut file)?;
    file.commit()
}

/// Writes a text file: whole or not at all.
///
/// # Errors
/// What the operating system reports.
pub fn write_text(path: &Path, text: &str) -> io::Result<()> {
    write_bytes(path, text.as_bytes())
}

/// Writes a file of these bytes: whole or not at all.
///
/// # Errors
/// What the operating system reports.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_whole(path, |file| file.write_all(bytes))
}

/// Makes sure that a text file can be written, and leaves nothing behind.
///
/// # Errors
/// What the operating system reports.
pub fn ensure_text_writable(path: &Path) -> io::Result<()> {
    AtomicFile::create(path).map(drop)
}

/// A file's path, and what writes what it holds.
pub type Writing<'a> = (PathBuf, &'a dyn Fn(&mut dyn Write) -> io::Result<()>);

/// Writes several files that belong together: each is complete before the first of them appears, in the order given.
pub fn write_all_whole<F: Error>(files: &[Writing], progress: &dyn Progress) -> Result<(), FileError<F>> {
    let mut complete = Vec::with_capacity(files.len());
    for (path, write) in files {
        let make = || {
            let mut file = AtomicFile::create(path)?;
            write(&mut Asked { out: &mut file, progress })?;
            file.complete()?;
            Ok(file)
        };
        complete.push(make().map_err(FileError::write(path))?);
    }
    for (file, (path, _)) in complete.into_iter().zip(files) {
        file.commit().map_err(FileError::write(path))?;
    }
    Ok(())
}

/// Makes sure that every cell names existing points.
pub fn ensure_sound<F: Error, const N: usize>(
    path: &Path,
    cells: &[[u32; N]],
    points: usize,
) -> Result<(), FileError<F>> {
    match unsound(cells, points) {
        Some(cell) => Err(FileError::BadMesh { path: path.to_path_buf(), cell }),
        None => Ok(()),
    }
}

/// The first cell that names a point that does not exist.
pub fn unsound<const N: usize>(cells: &[[u32; N]], points: usize) -> Option<usize> {
    cells.iter().position(|cell| cell.iter().any(|&v| v as usize >= points))
}

/// The extension of a path in lower case.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// The format that a path asks for by its extension.
pub fn by_extension<T: Copy>(path: &Path, formats: &[(&str, T)]) -> Option<T> {
    let extension = extension(path);
    formats.iter().find(|(known, _)| *known == extension).map(|&(_, format)| format)
}
