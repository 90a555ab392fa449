//! Tables of nodes and edges, with `;`, `,` or tabs between columns: two files, or one with an empty line between them.

mod error;
mod partner;
mod read;

pub use error::{CsvError, Table};
pub(super) use partner::partner;
pub(super) use read::{read, read_tables};
