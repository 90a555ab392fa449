//! Reading and atomic writing of whole files, and file extensions.

use super::asked::Asked;
use super::atomic::AtomicFile;
use super::error::FileError;
use super::set::OutputSet;
use anastomesh_mesh::progress::Progress;
use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Reads a non-empty file.
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

/// Writes a file atomically.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut AtomicFile) -> io::Result<()>) -> io::Result<()> {
    stage_whole(path, write)?.place().map_err(|error| error.source)
}

/// Writes a file under a temporary name, completely and to the disk.
pub fn stage_whole(path: &Path, write: impl FnOnce(&mut AtomicFile) -> io::Result<()>) -> io::Result<OutputSet> {
    let mut file = AtomicFile::create(path)?;
    write(&mut file)?;
    OutputSet::of(file)
}

/// Writes a text file atomically.
///
/// # Errors
/// The operating system reports an error.
pub fn write_text(path: &Path, text: &str) -> io::Result<()> {
    write_bytes(path, text.as_bytes())
}

/// Writes a file with these bytes atomically.
///
/// # Errors
/// The operating system reports an error.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_whole(path, |file| file.write_all(bytes))
}

/// Checks that a text file can be written, without side effects.
///
/// # Errors
/// The operating system reports an error.
pub fn ensure_text_writable(path: &Path) -> io::Result<()> {
    AtomicFile::create(path).map(drop)
}

/// Path of a file and the function that writes its contents.
pub type Writing<'a> = (PathBuf, &'a dyn Fn(&mut dyn Write) -> io::Result<()>);

/// Writes a set of files under temporary names, in the given order.
pub fn stage_all<F: Error>(files: &[Writing], progress: &dyn Progress) -> Result<OutputSet, FileError<F>> {
    let mut outputs = OutputSet::default();
    for (path, write) in files {
        let staged = stage_whole(path, |out| write(&mut Asked { out, progress }));
        outputs.append(staged.map_err(FileError::write(path))?);
    }
    Ok(outputs)
}

/// Checks that all cells refer to existing points.
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

/// First cell that refers to a missing point.
pub fn unsound<const N: usize>(cells: &[[u32; N]], points: usize) -> Option<usize> {
    cells.iter().position(|cell| cell.iter().any(|&v| v as usize >= points))
}

/// Extension of a path in lower case.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Format of a path, by its extension.
pub fn by_extension<T: Copy>(path: &Path, formats: &[(&str, T)]) -> Option<T> {
    let extension = extension(path);
    formats.iter().find(|(known, _)| *known == extension).map(|&(_, format)| format)
}
