//! Which formats of surfaces there are, and which of them a path asks for.

use super::error::SurfaceFileError;
use crate::file::{FileError, by_extension};
use std::path::Path;

/// A format of surface files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurfaceFormat {
    /// Geomview's object file format, `.off`; colours, normals and texture coordinates are passed over.
    Off,
    /// Polygon file format, `.ply`: text, or binary of either byte order.
    Ply,
    /// Stereolithography, `.stl`: text or binary. It has no common vertices: corners at the same place become one.
    Stl,
    /// Wavefront, `.obj`: vertices and faces; everything else is passed over.
    Obj,
}

/// Extensions, in lower case.
const EXTENSIONS: [(&str, SurfaceFormat); 4] = [
    ("off", SurfaceFormat::Off),
    ("ply", SurfaceFormat::Ply),
    ("stl", SurfaceFormat::Stl),
    ("obj", SurfaceFormat::Obj),
];

impl SurfaceFormat {
    /// The format that a file name asks for by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` when no format has the extension.
    pub fn of(path: &Path) -> Result<Self, SurfaceFileError> {
        let (kind, known) = ("format that is known here", ".off, .ply, .stl, .obj");
        let unknown = || FileError::UnknownFormat { path: path.to_path_buf(), kind, known };
        by_extension(path, &EXTENSIONS).ok_or_else(unknown)
    }
}
