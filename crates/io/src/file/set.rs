//! Outputs of a run that appear together or not at all.

use super::atomic::AtomicFile;
use super::error::OutputError;
use super::staged::{Staged, sync_names};
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

/// Complete files and folders under temporary names. [`OutputSet::place`] moves all to their paths, dropping removes them.
///
/// A kill of the process between two moves can still leave new files beside earlier ones, as can a loss of power before
/// [`OutputSet::place`] returns. Each file is complete then.
///
/// ```
/// use anastomesh_io::OutputSet;
///
/// let folder = tempfile::tempdir()?;
/// let [mesh, table] = ["a.vtu", "a.csv"].map(|name| folder.path().join(name));
/// let mut outputs = OutputSet::default();
/// outputs.add_bytes(&mesh, b"mesh")?;
/// outputs.add_bytes(&table, b"table")?;
/// assert!(!mesh.exists() && !table.exists());
/// outputs.place()?;
/// assert!(mesh.exists() && table.exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "outputs are removed unless they are placed"]
#[derive(Debug, Default)]
pub struct OutputSet {
    /// Outputs in the order of their moves.
    staged: Vec<Staged>,
}

impl OutputSet {
    /// Creates a set of one output.
    pub(crate) fn one(staged: Staged) -> Self {
        Self { staged: vec![staged] }
    }

    /// Flushes a file and makes a set of it.
    pub(in crate::file) fn of(file: AtomicFile) -> io::Result<Self> {
        file.stage().map(Self::one)
    }

    /// Flushes a file and adds it.
    ///
    /// # Errors
    /// The operating system reports an error.
    pub fn add(&mut self, file: AtomicFile) -> io::Result<()> {
        self.staged.push(file.stage()?);
        Ok(())
    }

    /// Writes a file with these bytes under a temporary name and adds it.
    ///
    /// # Errors
    /// The operating system reports an error.
    pub fn add_bytes(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = AtomicFile::create(path)?;
        file.write_all(bytes)?;
        self.add(file)
    }

    /// Adds the outputs of another set, which are placed after those of this set.
    pub fn append(&mut self, mut other: Self) {
        self.staged.append(&mut other.staged);
    }

    /// Returns the temporary path of the output for `target`. Its data can be read there before it is placed.
    pub fn temporary(&self, target: &Path) -> Option<&Path> {
        self.staged.iter().find(|staged| staged.target() == target).map(Staged::temporary)
    }

    /// Moves all outputs to their paths and replaces earlier ones. Contents are on the disk before, and the new names after it.
    /// On failure, all earlier outputs are restored.
    ///
    /// # Errors
    /// The operating system reports an error. Its text names each earlier output that could not be restored, with the
    /// hidden file beside its path that holds it. Later runs do not remove that file.
    pub fn place(mut self) -> Result<(), OutputError> {
        let last = self.staged.len().saturating_sub(1);
        let complete = self.each(|_, staged| staged.complete());
        let kept = complete.and_then(|()| self.each(|i, staged| staged.keep_earlier(i == last)));
        // No other work between these moves: a kill between them would leave some outputs new and others old.
        match kept.and_then(|()| self.each(|_, staged| staged.place())) {
            Ok(()) => {
                let folders: BTreeSet<&Path> =
                    self.staged.iter().filter_map(|staged| staged.target().parent()).collect();
                folders.into_iter().for_each(sync_names);
                self.staged.iter_mut().for_each(Staged::drop_earlier);
                Ok(())
            }
            Err(error) => {
                let back = |staged: &mut Staged| staged.take_back().err().map(|_| staged.unrestored());
                let unrestored: Vec<String> = self.staged.iter_mut().rev().filter_map(back).collect();
                Err(error.with_unrestored(&unrestored))
            }
        }
    }

    /// Applies a step to all outputs, until one fails.
    fn each(&mut self, step: impl Fn(usize, &mut Staged) -> io::Result<()>) -> Result<(), OutputError> {
        self.staged.iter_mut().enumerate().try_for_each(|(i, staged)| {
            step(i, staged).map_err(|source| OutputError { path: staged.target().to_path_buf(), source })
        })
    }
}

#[cfg(test)]
#[path = "set_tests.rs"]
mod tests;
