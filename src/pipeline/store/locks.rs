//! Locks of a work directory. An open file holds a lock, so the system releases it when the program ends or is killed.

use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;
use std::time::Duration;

use super::error::StoreError;
use anastomesh_mesh::progress::{Cancelled, Progress};

/// Interval between attempts to get a lock.
const AGAIN: Duration = Duration::from_millis(20);

/// Mode of a lock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LockMode {
    /// Exclusive: one run holds the lock.
    Alone,
    /// Shared: any number of runs hold the lock, while none holds it exclusively.
    Shared,
}

/// Takes a lock. `None` if another run holds it.
///
/// # Errors
/// The folder cannot be used, or its file system has no locks.
pub(super) fn try_lock(folder: &Path, name: &str, hold: LockMode) -> Result<Option<File>, StoreError> {
    let path = folder.join(name);
    let open = || File::options().write(true).create(true).truncate(false).open(&path);
    let unusable = |source| StoreError::Folder { path: folder.to_path_buf(), source };
    let file = open().map_err(unusable)?;
    let taken = match hold {
        LockMode::Alone => file.try_lock(),
        LockMode::Shared => file.try_lock_shared(),
    };
    if !is_taken(folder, taken)? {
        return Ok(None);
    }
    // Some file systems grant every lock. If a second file gets the lock too, it protects nothing.
    let second = open().map_err(unusable)?;
    if is_taken(folder, second.try_lock())? {
        return Err(StoreError::NoLocks { path: folder.to_path_buf(), why: "it grants one lock twice".into() });
    }
    Ok(Some(file))
}

/// Waits for an exclusive lock, and takes it.
///
/// # Errors
/// Those of [`try_lock`], or the run was cancelled.
pub(super) fn wait_for(folder: &Path, name: &str, progress: &dyn Progress) -> Result<File, StoreError> {
    loop {
        if let Some(lock) = try_lock(folder, name, LockMode::Alone)? {
            return Ok(lock);
        }
        if progress.is_cancelled() {
            return Err(io::Error::other(Cancelled).into());
        }
        std::thread::sleep(AGAIN);
    }
}

/// True if a lock was granted.
fn is_taken(folder: &Path, answer: Result<(), TryLockError>) -> Result<bool, StoreError> {
    match answer {
        Ok(()) => Ok(true),
        Err(TryLockError::WouldBlock) => Ok(false),
        Err(TryLockError::Error(source)) => {
            Err(StoreError::NoLocks { path: folder.to_path_buf(), why: source.to_string() })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_keeps_others_out_until_it_is_dropped() {
        let folder = tempfile::tempdir().expect("a folder");
        let take = |hold| try_lock(folder.path(), "lock", hold).expect("locks");
        let shared = [take(LockMode::Shared), take(LockMode::Shared)];
        assert!(shared.iter().all(Option::is_some) && take(LockMode::Alone).is_none());
        drop(shared);
        let alone = take(LockMode::Alone);
        assert!(alone.is_some() && take(LockMode::Shared).is_none());
        drop(alone);
        assert!(wait_for(folder.path(), "lock", &()).is_ok());
    }

    #[test]
    fn a_file_system_without_locks_is_named() {
        // Answers of NFS without its lock service, and of file systems without locks.
        for kind in [io::ErrorKind::Unsupported, io::ErrorKind::Other] {
            let error = is_taken("there".as_ref(), Err(TryLockError::Error(kind.into()))).expect_err("no locks");
            assert!(matches!(error, StoreError::NoLocks { .. }));
            assert!(
                error.to_string().starts_with("there: the file system of this work directory has no file locks"),
                "{error}"
            );
        }
    }
}
