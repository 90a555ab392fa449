//! TetGen's files of points and edges: `.node` and `.edge` with one name.

mod read;

pub use read::EdgeFileError;
pub(super) use read::{files, read};
