//! Surface formats and their file extensions.

use super::error::SurfaceFileError;
use crate::file::{FileError, by_extension};
use std::path::Path;

/// Format of surface files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurfaceFormat {
    /// Geomview object file format, `.off`; colours, normals and texture coordinates are ignored.
    Off,
    /// Polygon file format, `.ply`: text, or binary in either byte order.
    Ply,
    /// Stereolithography, `.stl`: text or binary. Equal corners are merged, as it has no shared vertices.
    Stl,
    /// Wavefront, `.obj`: vertices and faces; groups, objects or materials are markers; everything else is ignored.
    Obj,
    /// VTK poly data, `.vtp`: polygons. The extension alone stands for a network, so the format must be named.
    Vtp,
}

/// Extensions in lower case.
const EXTENSIONS: [(&str, SurfaceFormat); 4] = [
    ("off", SurfaceFormat::Off),
    ("ply", SurfaceFormat::Ply),
    ("stl", SurfaceFormat::Stl),
    ("obj", SurfaceFormat::Obj),
];

impl SurfaceFormat {
    /// Format of a file name, by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` if no format has the extension.
    pub fn of(path: &Path) -> Result<Self, SurfaceFileError> {
        let (kind, known) = ("surface", ".off, .ply, .stl, .obj");
        let unknown = || FileError::UnknownFormat { path: path.to_path_buf(), kind, known };
        by_extension(path, &EXTENSIONS).ok_or_else(unknown)
    }
}
