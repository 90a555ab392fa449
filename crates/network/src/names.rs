//! Names of nodes in reports.

/// Returns the name of a node in its file, given by its index in the input.
pub type NameOf<'a> = &'a dyn Fn(u32) -> String;
