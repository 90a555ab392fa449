//! Node and edge tables with `;`, `,` or tab as delimiter, in two files or in one file with an empty line between.

mod error;
mod partner;
mod read;

pub use error::{CsvError, Table};
pub(super) use partner::partner;
pub(super) use read::{read, read_tables};
