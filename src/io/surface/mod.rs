//! Triangle surfaces in files: OFF, PLY, STL and OBJ.

mod content;
mod faces;
mod obj;
mod off;
mod ply;
mod ply_head;
mod stl;
#[cfg(test)]
mod tests;

pub use content::{SurfaceContent, SurfaceNote};

use super::file_error::{FileError, ensure_sound, extension, read_bytes, write_whole};
use super::text::TextFault;
use crate::mesh::TriMesh;
use crate::mesh::facets::FacetError;
use std::fmt;
use std::io::{self, Write};
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

impl SurfaceFormat {
    /// The format that a file name asks for by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` when no format has the extension.
    pub fn of(path: &Path) -> Result<Self, SurfaceFileError> {
        match extension(path).as_str() {
            "off" => Ok(Self::Off),
            "ply" => Ok(Self::Ply),
            "stl" => Ok(Self::Stl),
            "obj" => Ok(Self::Obj),
            _ => Err(FileError::UnknownFormat { path: path.to_path_buf(), known: ".off, .ply, .stl, .obj" }),
        }
    }
}

/// Why a surface file could not be read or written.
pub type SurfaceFileError = FileError<SurfaceFault>;

/// Where something stands in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// In a line, numbered from 1.
    Line(usize),
    /// At a byte, numbered from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why the content of a file is no triangle surface. Faces are numbered as the format numbers points: from 1 in OBJ, else
/// from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceFault {
    /// Its words are not those of the format.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// A face has too few corners, or in a format that knows only triangles too many.
    #[error("{place}: face {face} has {corners} corners, which make no triangle: correct or remove it")]
    NotATriangle {
        /// The first such face.
        face: usize,
        /// How many corners it has.
        corners: i64,
        /// Where it stands.
        place: Place,
    },
    /// A face with more than three corners has no triangulation.
    #[error("{place}: face {face} cannot be cut into triangles: {fault}")]
    Polygon {
        /// The first such face.
        face: usize,
        /// Where it stands.
        place: Place,
        /// Why.
        #[source]
        fault: FacetError,
    },
    /// A face names a point that does not exist.
    #[error("{place}: face {face} names the point {index}, but there are {points} points, the first is {first}")]
    BadIndex {
        /// The first such face.
        face: usize,
        /// What it names.
        index: i64,
        /// How many points there are.
        points: usize,
        /// The number of the first point in this format.
        first: u32,
        /// Where it stands.
        place: Place,
    },
    /// A coordinate of a binary file is infinite or not a number.
    #[error("byte {byte}: point {point} has a coordinate that is infinite or not a number: correct it")]
    NotFinite {
        /// The first such point.
        point: usize,
        /// Where it stands.
        byte: usize,
    },
    /// The file is of a kind of the format that is not read.
    #[error("{place}: '{found}' is a variant that is not read: save it as {instead}")]
    Variant {
        /// What is there.
        found: String,
        /// Where it stands.
        place: Place,
        /// What would be read.
        instead: &'static str,
    },
    /// A word of the format is missing.
    #[error("{place}: '{found}' stands where {expected} has to be: correct it, or give the file its right extension")]
    Unexpected {
        /// What is there.
        found: String,
        /// What had to be there.
        expected: &'static str,
        /// Where it stands.
        place: Place,
    },
    /// Something that every such file has is not there.
    #[error("{what} is missing: write the file again")]
    Missing {
        /// What.
        what: &'static str,
    },
    /// A binary file does not have the length that its counts say.
    #[error(
        "the counts of the file announce at least {announced} bytes, it has {found}: \
         it was not written or copied completely, or its counts are wrong"
    )]
    Length {
        /// What is announced.
        announced: u64,
        /// How long it is.
        found: u64,
    },
    /// There are no faces.
    #[error("there is no face in it, only {points} points: a surface is needed")]
    NoFaces {
        /// How many points there are.
        points: usize,
    },
}

/// Reads a surface from a file, in the format that its extension names. Triangles and points keep their order; nothing
/// is joined, dropped or turned over (only STL, which stores no common points, has its equal corners joined). A face with
/// more than three corners becomes triangles in its place ([`crate::mesh::facets`]).
///
/// # Errors
/// `UnknownFormat`, `Read` with the system's reason, `Empty`, or `Content` with what is wrong.
pub fn read_surface(path: &Path) -> Result<TriMesh, SurfaceFileError> {
    read_surface_as(path, SurfaceFormat::of(path)?)
}

/// As [`read_surface`], in this format whatever the extension.
///
/// # Errors
/// As [`read_surface`].
pub fn read_surface_as(path: &Path, format: SurfaceFormat) -> Result<TriMesh, SurfaceFileError> {
    Ok(read_content_as(path, format)?.mesh)
}

/// As [`read_surface_as`], with what the file says beside the surface.
///
/// # Errors
/// As [`read_surface`].
pub fn read_content_as(path: &Path, format: SurfaceFormat) -> Result<SurfaceContent, SurfaceFileError> {
    let bytes = read_bytes(path)?;
    read_content_from(&bytes, format).map_err(|fault| FileError::Content { path: path.to_path_buf(), fault })
}

/// Reads a surface from the bytes of a file.
///
/// # Errors
/// When the bytes are no such file, or it is incomplete.
pub fn read_surface_from(bytes: &[u8], format: SurfaceFormat) -> Result<TriMesh, SurfaceFault> {
    Ok(read_content_from(bytes, format)?.mesh)
}

/// As [`read_surface_from`], with what the file says beside the surface.
///
/// # Errors
/// As [`read_surface_from`].
pub fn read_content_from(bytes: &[u8], format: SurfaceFormat) -> Result<SurfaceContent, SurfaceFault> {
    let content = match format {
        SurfaceFormat::Off => off::read(bytes)?,
        SurfaceFormat::Ply => ply::read(bytes)?,
        SurfaceFormat::Stl => stl::read(bytes)?,
        SurfaceFormat::Obj => obj::read(bytes)?,
    };
    if content.mesh.triangles.is_empty() {
        return Err(SurfaceFault::NoFaces { points: content.mesh.points.len() });
    }
    Ok(content)
}

/// Writes a surface to a file, in the format that its extension names; the file appears whole or not at all. Every
/// coordinate comes back bit for bit: PLY is written in binary with doubles, and STL in binary only when every
/// coordinate fits into the 32-bit floats of that variant, otherwise as text.
///
/// # Errors
/// `UnknownFormat`, `BadMesh` when a triangle names a point that does not exist, or `Write` with the reason.
pub fn write_surface(path: &Path, mesh: &TriMesh) -> Result<(), SurfaceFileError> {
    let format = SurfaceFormat::of(path)?;
    ensure_sound(path, &mesh.triangles, mesh.points.len())?;
    write_whole(path, |file| write_format(file, format, mesh))
}

fn write_format(out: &mut impl Write, format: SurfaceFormat, mesh: &TriMesh) -> io::Result<()> {
    match format {
        SurfaceFormat::Off => off::write(out, mesh),
        SurfaceFormat::Ply => ply::write(out, mesh),
        SurfaceFormat::Stl => stl::write(out, mesh),
        SurfaceFormat::Obj => obj::write(out, mesh),
    }
}
