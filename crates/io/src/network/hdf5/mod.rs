//! HDF5 files of vascpy and `VessMorphoVis`: sections of points, or a SONATA table of segments.

mod arrays;
mod error;
mod read;

pub use error::Hdf5Error;
pub(super) use read::read;
