//! Hidden names beside a target, for temporary and earlier versions.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Creates something under a new hidden name next to `target`.
pub fn make_hidden<T>(target: &Path, kind: &str, make: impl Fn(&Path) -> io::Result<T>) -> io::Result<(PathBuf, T)> {
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

/// Locks a file or folder while it is in use. If locking fails, it cannot be detected as stale either.
pub fn locked(opened: io::Result<File>) -> Option<File> {
    opened.ok().filter(|file| file.try_lock().is_ok())
}

/// Minimum age of stale files: the run of a younger file may not have locked it yet.
const SETTLED: Duration = Duration::from_secs(10);

/// Removes stale files of killed runs under hidden names next to `target`, which no process locks.
pub fn remove_left(target: &Path, kind: &str, remove: impl Fn(&Path)) {
    let Some(name) = target.file_name().and_then(|name| name.to_str()) else { return };
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_hidden_name(&entry.file_name(), name, kind) && is_left(&entry.path()) {
            remove(&entry.path());
        }
    }
}

/// True for a name created by [`make_hidden`].
pub fn is_hidden_name(hidden: &OsStr, name: &str, kind: &str) -> bool {
    let rest = |hidden: &str| -> Option<bool> {
        let numbers = hidden.strip_prefix('.')?.strip_prefix(name)?.strip_prefix('.')?.strip_suffix(kind)?;
        let (process, attempt) = numbers.strip_suffix('.')?.split_once('-')?;
        Some([process, attempt].iter().all(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit())))
    };
    hidden.to_str().and_then(rest).unwrap_or(false)
}

fn is_left(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let changed = file.metadata().and_then(|data| data.modified()).ok();
    let is_settled = changed.and_then(|changed| changed.elapsed().ok()).is_some_and(|age| age >= SETTLED);
    is_settled && file.try_lock().is_ok()
}
