//! Arrays of a folder, by name.

use super::array::Array;
use super::error::{NpyError, NpyFault};
use crate::file::FileError;
use anastomesh_mesh::geometry::Point3;
use std::collections::BTreeMap;
use std::error::Error;
use std::io;
use std::path::Path;

/// Extension of array folders.
const EXTENSION: &str = "npyd";

/// Undecoded files of a folder; only requested arrays are read.
#[derive(Clone, Debug, Default)]
pub struct Arrays {
    files: BTreeMap<String, Vec<u8>>,
}

/// True if a path has the extension of an array folder.
pub fn is_folder(path: &Path) -> bool {
    crate::file::extension(path) == EXTENSION
}

/// True if an array folder has an array of this name.
pub fn holds(folder: &Path, array: &str) -> bool {
    is_folder(folder) && folder.join(file(array)).is_file()
}

fn file(name: &str) -> String {
    format!("{name}.npy")
}

impl Arrays {
    /// Files by name, from any source.
    pub fn of(files: &[(&str, &[u8])]) -> Self {
        Self { files: files.iter().map(|&(name, bytes)| (name.to_owned(), bytes.to_vec())).collect() }
    }

    /// Reads the existing ones of the named arrays, and one other file.
    ///
    /// # Errors
    /// `Read` with the error of the operating system.
    pub fn read<F: Error>(folder: &Path, names: &[&str], other: Option<&str>) -> Result<Self, FileError<F>> {
        // Gives the reason if the folder does not exist.
        std::fs::read_dir(folder).map_err(FileError::read(folder))?;
        let mut files = BTreeMap::new();
        for name in names.iter().map(|name| file(name)).chain(other.map(ToOwned::to_owned)) {
            match std::fs::read(folder.join(&name)) {
                Ok(bytes) => drop(files.insert(name, bytes)),
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => return Err(FileError::read(&folder.join(name))(error)),
            }
        }
        Ok(Self { files })
    }

    /// Contents of a file that is not an array, if it exists.
    pub fn other(&self, name: &str) -> Option<&[u8]> {
        self.files.get(name).map(Vec::as_slice)
    }

    /// True if an array exists.
    pub fn has(&self, name: &str) -> bool {
        self.files.contains_key(&file(name))
    }

    /// Reads an optional array, which is empty if missing.
    pub fn if_there<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Self, &str) -> Result<Vec<T>, NpyError>,
    ) -> Result<Vec<T>, NpyError> {
        if self.has(name) { read(self, name) } else { Ok(Vec::new()) }
    }

    /// Existing ones of these names.
    pub fn present(&self, names: &[&str]) -> Vec<String> {
        names.iter().filter(|name| self.has(name)).map(ToString::to_string).collect()
    }

    /// Number of columns of an existing array.
    pub fn columns(&self, name: &str) -> Result<usize, NpyError> {
        Ok(self.array(name)?.columns())
    }

    fn array(&self, name: &str) -> Result<Array<'_>, NpyError> {
        let bytes = self.files.get(&file(name)).ok_or_else(|| NpyFault::Missing.of(file(name)))?;
        Array::read(bytes).map_err(|fault| fault.of(file(name)))
    }

    /// Reads an array of floats.
    pub fn floats<const N: usize>(&self, name: &str) -> Result<Vec<[f64; N]>, NpyError> {
        self.array(name)?.floats().map_err(|fault| fault.of(file(name)))
    }

    /// Reads an array with one float per row, without checks.
    pub fn values(&self, name: &str) -> Result<Vec<f64>, NpyError> {
        Ok(self.floats::<1>(name)?.into_iter().flatten().collect())
    }

    /// Reads an array of points with finite coordinates.
    pub fn points(&self, name: &str) -> Result<Vec<Point3>, NpyError> {
        let rows = self.floats::<3>(name)?;
        if rows.len() >= u32::MAX as usize {
            return Err(NpyFault::TooMany { found: rows.len() }.of(file(name)));
        }
        match rows.iter().position(|row| !row.iter().all(|x| x.is_finite())) {
            Some(row) => Err(NpyFault::NotFinite { row }.of(file(name))),
            None => Ok(rows.into_iter().map(Point3::from).collect()),
        }
    }

    /// Reads an array of row indices into another array with `count` rows.
    pub fn indices<const N: usize>(
        &self,
        name: &str,
        (of, count): (&'static str, usize),
    ) -> Result<Vec<[u32; N]>, NpyError> {
        let fault = |fault: NpyFault| fault.of(file(name));
        let rows = self.array(name)?.ints::<N>().map_err(fault)?;
        if rows.len() >= u32::MAX as usize {
            return Err(fault(NpyFault::TooMany { found: rows.len() }));
        }
        let outside = |index: &i64| *index < 0 || *index >= count as i64;
        let astray = rows.iter().enumerate().find_map(|(row, ids)| Some((row, ids.iter().copied().find(outside)?)));
        match astray {
            Some((row, index)) => Err(fault(NpyFault::Index { row, index, of, count })),
            None => Ok(rows.into_iter().map(|row| row.map(|index| index as u32)).collect()),
        }
    }

    /// Reads an array of labels for the rows of another array; `None` if missing.
    pub fn labels(&self, name: &str, (of, wanted): (&'static str, usize)) -> Result<Option<Vec<i32>>, NpyError> {
        if !self.has(name) {
            return Ok(None);
        }
        let fault = |fault: NpyFault| fault.of(file(name));
        let rows = self.array(name)?.ints::<1>().map_err(fault)?;
        ensure_rows(name, rows.len(), (of, wanted))?;
        let narrow = |(row, value): (usize, i64)| {
            i32::try_from(value).map_err(|_| fault(NpyFault::NoLabel { row, value: value.to_string() }))
        };
        rows.into_iter().flatten().enumerate().map(narrow).collect::<Result<_, _>>().map(Some)
    }
}

/// Checks that an array has as many rows as another one.
pub fn ensure_rows(name: &str, found: usize, (of, wanted): (&'static str, usize)) -> Result<(), NpyError> {
    if found == wanted { Ok(()) } else { Err(NpyFault::Rows { found, of, wanted }.of(file(name))) }
}
