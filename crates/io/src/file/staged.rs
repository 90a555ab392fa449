//! Complete output under a temporary name: its move to the target, and back.

use super::hidden::make_hidden;
use std::fmt::Debug;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Files that the writer of a folder may replace.
pub trait Contents: Debug + Send {
    /// Checks that the target is missing, or a folder without other files.
    fn ensure_replaceable(&self, target: &Path) -> io::Result<()>;

    /// Removes the files and the folder, unless it holds other files. Failures are ignored.
    fn remove(&self, folder: &Path);
}

/// Position of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Position {
    /// The new output has its temporary name, and the earlier one is at the target.
    Staged,
    /// The earlier output has its hidden name, and nothing is at the target.
    SetAside,
    /// The new output is at the target.
    Placed,
}

/// Complete file or folder under a temporary name. Dropping it removes it, unless it is at its target.
#[derive(Debug)]
pub struct Staged {
    temporary: PathBuf,
    target: PathBuf,
    /// Lock that marks the temporary name as in use.
    lock: Option<File>,
    /// Contents of a folder; `None` for a file.
    contents: Option<Box<dyn Contents>>,
    /// Hidden name of the earlier output. The extension `old` keeps it from [`remove_left`](super::remove_left).
    earlier: Option<PathBuf>,
    /// True if the hidden name is a hard link to the earlier file.
    is_linked: bool,
    position: Position,
}

impl Staged {
    /// Creates the entry of a file.
    pub fn file(temporary: PathBuf, target: PathBuf, lock: Option<File>) -> Self {
        let (contents, earlier, is_linked, position) = (None, None, false, Position::Staged);
        Self { temporary, target, lock, contents, earlier, is_linked, position }
    }

    /// Creates the entry of a folder.
    pub fn folder(temporary: PathBuf, target: PathBuf, lock: Option<File>, contents: Box<dyn Contents>) -> Self {
        let mut staged = Self::file(temporary, target, lock);
        staged.contents = Some(contents);
        staged
    }

    /// Path of the output after the move.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Path of the output before the move.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Flushes a folder, so that its files are complete after a loss of power. Files are flushed when they are staged.
    pub fn complete(&self) -> io::Result<()> {
        if self.contents.is_some() { sync_tree(&self.temporary) } else { Ok(()) }
    }

    /// Gives the earlier output a hidden name: a hard link, or a reserved name for [`Staged::place`].
    ///
    /// The last file of a set needs none, as its move replaces the earlier file in one step.
    pub fn keep_earlier(&mut self, is_last: bool) -> io::Result<()> {
        let reserved = match &self.contents {
            Some(contents) => {
                contents.ensure_replaceable(&self.target)?;
                if !self.target.exists() {
                    return Ok(());
                }
                make_hidden(&self.target, "old", |old| fs::create_dir(old))?
            }
            None if is_last => return Ok(()),
            None => {
                // A broken symbolic link is an earlier file, too.
                match self.target.symlink_metadata() {
                    Ok(data) if data.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
                    Ok(_) => {}
                    Err(_) => return Ok(()),
                }
                let linked = make_hidden(&self.target, "old", |old| fs::hard_link(&self.target, old));
                self.is_linked = linked.is_ok();
                linked.or_else(|_| make_hidden(&self.target, "old", |old| File::create_new(old).map(drop)))?
            }
        };
        self.earlier = Some(reserved.0);
        Ok(())
    }

    /// Moves the output to its target.
    pub fn place(&mut self) -> io::Result<()> {
        if cfg!(windows) {
            // Windows cannot move an open file.
            self.lock = None;
        }
        if let (Some(old), false) = (&self.earlier, self.is_linked) {
            if self.contents.is_some() && exchange(&self.temporary, &self.target).is_ok() {
                self.position = Position::Placed;
                return self.hide_exchanged();
            }
            fs::rename(&self.target, old)?;
            self.position = Position::SetAside;
        }
        fs::rename(&self.temporary, &self.target)?;
        self.position = Position::Placed;
        Ok(())
    }

    /// Moves the earlier folder to its hidden name, from the temporary name of the new one.
    fn hide_exchanged(&mut self) -> io::Result<()> {
        let Some(old) = &self.earlier else { return Ok(()) };
        let hidden = fs::rename(&self.temporary, old);
        if hidden.is_err() {
            match exchange(&self.temporary, &self.target) {
                Ok(()) => self.position = Position::Staged,
                Err(_) => self.earlier = Some(self.temporary.clone()),
            }
        }
        hidden
    }

    /// Restores the earlier state of the target. After a failure, the earlier output keeps its hidden name.
    pub fn take_back(&mut self) -> io::Result<()> {
        if self.position == Position::Staged {
            self.drop_earlier();
            return Ok(());
        }
        let blocks_target = self.earlier.is_none() || self.contents.is_some();
        if self.position == Position::Placed && blocks_target {
            fs::rename(&self.target, &self.temporary)?;
            self.position = Position::SetAside;
        }
        if let Some(old) = &self.earlier {
            fs::rename(old, &self.target)?;
            self.earlier = None;
        }
        // A replaced new file has no name any more.
        self.position = Position::Staged;
        Ok(())
    }

    /// Removes the earlier output, or its hidden name if it is still at the target. If that fails, a later run does so.
    pub fn drop_earlier(&mut self) {
        let Some(old) = self.earlier.take() else { return };
        match &self.contents {
            Some(contents) if self.position == Position::Placed => contents.remove(&old),
            Some(_) => drop(fs::remove_dir(&old)),
            None => drop(fs::remove_file(&old)),
        }
        if is_there(&old) {
            // The extension marks it as stale for `remove_left`.
            let unused = |stale: &Path| if is_there(stale) { Err(io::ErrorKind::AlreadyExists.into()) } else { Ok(()) };
            let _ = make_hidden(&self.target, "part", |stale| unused(stale).and_then(|()| fs::rename(&old, stale)));
        }
    }

    /// Sentence about a target that [`Staged::take_back`] could not restore.
    pub fn unrestored(&self) -> String {
        let target = self.target.display();
        match &self.earlier {
            Some(old) => format!("{target} could not be restored: its earlier version is {}", old.display()),
            None => format!("{target} is new and could not be removed"),
        }
    }
}

/// True for a file or folder, and for a broken symbolic link.
fn is_there(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

/// Flushes all files below a folder. One call for the whole file system takes much less time than one per file.
#[cfg(target_os = "linux")]
fn sync_tree(folder: &Path) -> io::Result<()> {
    Ok(rustix::fs::syncfs(File::open(folder)?)?)
}

/// Flushes all files below a folder.
#[cfg(not(target_os = "linux"))]
fn sync_tree(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            sync_tree(&entry.path())?;
        } else {
            // Windows flushes only files that are open for writing.
            File::options().append(true).open(entry.path())?.sync_data()?;
        }
    }
    Ok(())
}

/// Flushes the names in a folder. Failures are ignored, as its files are complete under either name. Windows has no such call.
pub fn sync_names(folder: &Path) {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

/// Exchanges the names of two folders in one step.
#[cfg(target_os = "linux")]
fn exchange(a: &Path, b: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, a, CWD, b, RenameFlags::EXCHANGE)?)
}

/// Other systems move the earlier folder aside first.
#[cfg(not(target_os = "linux"))]
fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

impl Drop for Staged {
    fn drop(&mut self) {
        if self.position == Position::Placed {
            return;
        }
        // Failures are ignored, and the target is unchanged.
        drop(self.lock.take());
        match &self.contents {
            Some(contents) => contents.remove(&self.temporary),
            None => drop(fs::remove_file(&self.temporary)),
        }
    }
}
