//! Files that have their name only when they are whole.

use std::io::{self, Write};
use std::path::Path;

/// A file beside `path` that goes unless it is given its name. Others who may read the folder may read it.
pub(super) fn part_of(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    let mut part = tempfile::Builder::new();
    part.prefix("anastomesh.part-");
    #[cfg(unix)]
    part.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    part.tempfile_in(folder)
}

/// Writes a file that has its name only when it is whole.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut part = part_of(path)?;
    part.write_all(bytes)?;
    part.as_file().sync_all()?;
    part.persist(path).map(drop).map_err(|e| e.error)
}
