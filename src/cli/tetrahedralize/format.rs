//! Formats by extension or by name, and output targets.

use std::path::{Path, PathBuf};

use crate::cli::exit::Failure;
use crate::cli::hint;
use anastomesh_io::surface::SurfaceFormat;
use anastomesh_io::tetgen::{MeshFamily, PlcFormat};
use anastomesh_io::volume::{MeshFormat, ensure_writable};

/// Input format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum InputFormat {
    /// Geomview OFF
    Off,
    /// PLY, text or binary
    Ply,
    /// STL, text or binary
    Stl,
    /// Wavefront OBJ
    Obj,
    /// VTK poly data
    Vtp,
    /// `TetGen` points
    Node,
    /// `TetGen` facet complex
    Poly,
    /// `TetGen` complex of simple facets
    Smesh,
    /// Folder of `NumPy` arrays
    Npyd,
}

/// Format of standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum StreamFormat {
    /// VTK unstructured grid
    Vtu,
    /// Gmsh 4.1
    Msh,
    /// Gmsh 2.2, text
    Msh2,
    /// Medit
    Mesh,
}

impl InputFormat {
    /// Returns the named format, or that of the extension.
    pub fn of(path: &Path, named: Option<Self>) -> Result<Self, Failure> {
        if let Some(format) = named {
            return Ok(format);
        }
        if is_stream(path) {
            return Err(Failure::usage("standard input has no extension: give its format with --from"));
        }
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match <Self as clap::ValueEnum>::from_str(&extension, true) {
            Ok(format) => Ok(format),
            Err(_) => Err(Failure::input(format!(
                "{}: unrecognised surface extension; known: .off, .ply, .stl, .obj, .vtp, .node, .poly, .smesh, .npyd; give the format \
                 with --from{}",
                path.display(),
                hint::instead_of_surface(path)
            ))),
        }
    }

    /// True if the format is a facet complex.
    pub fn is_complex(self) -> bool {
        matches!(self, Self::Poly | Self::Smesh)
    }

    /// Surface format, if any.
    pub fn surface(self) -> Option<SurfaceFormat> {
        match self {
            Self::Off => Some(SurfaceFormat::Off),
            Self::Ply => Some(SurfaceFormat::Ply),
            Self::Stl => Some(SurfaceFormat::Stl),
            Self::Obj => Some(SurfaceFormat::Obj),
            Self::Vtp => Some(SurfaceFormat::Vtp),
            Self::Node | Self::Poly | Self::Smesh | Self::Npyd => None,
        }
    }

    /// Facet complex format, if any.
    pub fn complex(self) -> Option<PlcFormat> {
        match self {
            Self::Poly => Some(PlcFormat::Poly),
            Self::Smesh => Some(PlcFormat::Smesh),
            _ => None,
        }
    }
}

/// True if a path denotes a standard stream.
pub fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// Output target.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// One file.
    File(PathBuf),
    /// `TetGen` files.
    Family(PathBuf),
    /// Standard output.
    Stream(MeshFormat),
}

impl Target {
    /// Returns the requested target, after checking that it can be written.
    pub fn of(path: &Path, named: Option<StreamFormat>) -> Result<Self, Failure> {
        if is_stream(path) {
            return match named {
                Some(StreamFormat::Vtu) => Ok(Self::Stream(MeshFormat::Vtu)),
                Some(StreamFormat::Msh) => Ok(Self::Stream(MeshFormat::Msh)),
                Some(StreamFormat::Msh2) => Ok(Self::Stream(MeshFormat::Msh2)),
                Some(StreamFormat::Mesh) => Ok(Self::Stream(MeshFormat::Medit)),
                None => Err(Failure::usage("standard output has no extension: give its format with --to")),
            };
        }
        let failed = |e: anastomesh_io::volume::MeshFileError| Failure::input(e.to_string());
        if MeshFormat::of(path).map_err(failed)? != MeshFormat::Tetgen {
            ensure_writable(path).map_err(failed)?;
            return Ok(Self::File(path.to_path_buf()));
        }
        ensure_writable(&path.with_extension("ele")).map_err(failed)?;
        Ok(Self::Family(path.to_path_buf()))
    }

    /// True if a mesh can be written in parts.
    pub fn has_parts(&self) -> bool {
        matches!(self, Self::File(path) if MeshFormat::of(path).is_ok_and(MeshFormat::has_parts))
    }

    /// Format of a single file; `None` for other targets.
    pub fn file_format(&self) -> Option<MeshFormat> {
        match self {
            Self::File(path) => MeshFormat::of(path).ok(),
            Self::Family(_) | Self::Stream(_) => None,
        }
    }

    /// Checks that no input file is overwritten.
    pub fn ensure_apart(&self, input: &[PathBuf]) -> Result<(), Failure> {
        let base = match self {
            Self::Family(base) => base,
            Self::File(path) if input.contains(path) => {
                return Err(Failure::usage(format!(
                    "{} is the input and would be overwritten: give another output",
                    path.display()
                )));
            }
            _ => return Ok(()),
        };
        match MeshFamily::paths(base).iter().find(|written| input.contains(written)) {
            Some(written) => Err(Failure::usage(format!(
                "{} belongs to the input and would be overwritten: give another output, such as {}",
                written.display(),
                base.with_extension("1.ele").display()
            ))),
            None => Ok(()),
        }
    }
}
