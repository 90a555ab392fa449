//! Floor 3: readers and writers, one file per format.

mod atomic;
mod bits;
mod counted;
#[cfg(test)]
mod cut_source;
mod file_error;
pub mod medit;
#[cfg(test)]
mod medit_tests;
pub mod mesh_file;
pub mod msh;
mod msh_read;
mod msh_surfaces;
pub mod network;
mod packed;
pub mod pvtu;
mod pvtu_folder;
mod pvtu_plan;
mod pvtu_read;
#[cfg(test)]
mod pvtu_tests;
#[cfg(test)]
mod source_tests;
pub mod surface;
pub mod tetgen;
mod text;
pub mod vtk_xml;
pub mod vtu;
mod vtu_blocks;
mod vtu_pieces;
mod vtu_read;

pub use file_error::FileError;
pub use text::TextFault;

/// Writes a text file: whole or not at all.
///
/// # Errors
/// What the operating system reports.
pub fn write_text(path: &std::path::Path, text: &str) -> std::io::Result<()> {
    use std::io::Write as _;
    let mut file = atomic::AtomicFile::create(path)?;
    file.write_all(text.as_bytes())?;
    file.commit()
}
