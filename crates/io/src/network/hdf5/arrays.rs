//! Lists of numbers in an HDF5 file.

use super::error::Hdf5Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, H5Type, Hdf5File};

/// Size of one list at most, per byte of the file: deflate compresses no further.
const EXPANSION: usize = 1032;

/// Opens a file.
///
/// # Errors
/// [`Hdf5Error::File`].
pub(super) fn open(bytes: &[u8]) -> Result<Hdf5File, Hdf5Error> {
    let options = hdf5_reader::OpenOptions::default().with_max_read_bytes(bytes.len().saturating_mul(EXPANSION));
    Hdf5File::from_bytes_with_options(bytes, options).map_err(|error| Hdf5Error::File { reason: error.to_string() })
}

/// A list by its name, with rows of equal length.
pub(super) struct List<T> {
    pub columns: usize,
    pub values: Vec<T>,
}

impl<T> List<T> {
    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.values.len() / self.columns.max(1)
    }

    pub(super) fn rows(&self) -> std::slice::ChunksExact<'_, T> {
        self.values.chunks_exact(self.columns.max(1))
    }
}

/// Reads a list of real numbers; `None` if the group has none of that name.
///
/// # Errors
/// It cannot be read, or is not a list of numbers.
pub(super) fn reals(group: &Group, name: &str) -> Result<Option<List<f64>>, Hdf5Error> {
    numbers(group, name, |dataset| match dataset.dtype() {
        Datatype::FloatingPoint { size: 4, .. } => converted(dataset, |x: f32| f64::from(x)),
        Datatype::FloatingPoint { .. } => converted(dataset, |x: f64| x),
        _ => Ok(integers(dataset)?.into_iter().map(|x| x as f64).collect()),
    })
}

/// Reads a list of whole numbers; `None` if the group has none of that name.
///
/// # Errors
/// It cannot be read, or is not a list of whole numbers.
pub(super) fn wholes(group: &Group, name: &str) -> Result<Option<List<i64>>, Hdf5Error> {
    numbers(group, name, integers)
}

fn integers(dataset: &Dataset) -> hdf5_reader::error::Result<Vec<i64>> {
    let Datatype::FixedPoint { size, signed, .. } = dataset.dtype() else { return converted(dataset, |x: i64| x) };
    match (size, signed) {
        (1, true) => converted(dataset, |x: i8| x.into()),
        (1, false) => converted(dataset, |x: u8| x.into()),
        (2, true) => converted(dataset, |x: i16| x.into()),
        (2, false) => converted(dataset, |x: u16| x.into()),
        (4, true) => converted(dataset, |x: i32| x.into()),
        (4, false) => converted(dataset, |x: u32| x.into()),
        // Beyond the largest number no node exists.
        (8, false) => converted(dataset, |x: u64| i64::try_from(x).unwrap_or(i64::MAX)),
        _ => converted(dataset, |x: i64| x),
    }
}

fn converted<T: H5Type, U>(dataset: &Dataset, number: impl Fn(T) -> U) -> hdf5_reader::error::Result<Vec<U>> {
    Ok(dataset.read_array::<T>()?.into_iter().map(number).collect())
}

fn numbers<T>(
    group: &Group,
    name: &str,
    read: impl Fn(&Dataset) -> hdf5_reader::error::Result<Vec<T>>,
) -> Result<Option<List<T>>, Hdf5Error> {
    let failed = |error: hdf5_reader::error::Error| Hdf5Error::List { list: name.into(), reason: error.to_string() };
    let (_, datasets) = group.members().map_err(failed)?;
    let Some(dataset) = datasets.into_iter().find(|dataset| dataset.name() == name) else { return Ok(None) };
    let columns = match *dataset.shape() {
        [_] => 1,
        [_, columns] if columns > 0 => columns as usize,
        _ => {
            return Err(Hdf5Error::Shape {
                list: name.into(),
                found: dataset.shape().to_vec(),
                expected: "rows".into(),
            });
        }
    };
    Ok(Some(List { columns, values: read(&dataset).map_err(failed)? }))
}
