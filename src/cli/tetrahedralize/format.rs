//! Formats by extension or by name, and where the mesh goes.

use std::path::{Path, PathBuf};

use crate::cli::exit::Failure;
use anastomesh_io::surface::SurfaceFormat;
use anastomesh_io::tetgen::{MeshFamily, PlcFormat};
use anastomesh_io::volume::{MeshFormat, ensure_writable};

/// A format that can be read.
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
    /// `TetGen`'s points
    Node,
    /// `TetGen`'s complexes of facets
    Poly,
    /// `TetGen`'s complexes of simple facets
    Smesh,
    /// Arrays of `NumPy`, a folder
    Npyd,
}

/// A format that can be written to a stream.
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
    /// The format that was named, or that of the extension.
    pub fn of(path: &Path, named: Option<Self>) -> Result<Self, Failure> {
        if let Some(format) = named {
            return Ok(format);
        }
        if is_stream(path) {
            return Err(Failure::usage("standard input has no extension: name its format with --from"));
        }
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match <Self as clap::ValueEnum>::from_str(&extension, true) {
            Ok(format) => Ok(format),
            Err(_) => Err(Failure::input(format!(
                "{}: the extension names no format that is read here \
                 (known: .off, .ply, .stl, .obj, .node, .poly, .smesh, .npyd); name the format with --from",
                path.display()
            ))),
        }
    }

    /// Whether such a file holds a complex of facets by its nature.
    pub fn is_complex(self) -> bool {
        matches!(self, Self::Poly | Self::Smesh)
    }

    /// As a format of surfaces.
    pub fn surface(self) -> Option<SurfaceFormat> {
        match self {
            Self::Off => Some(SurfaceFormat::Off),
            Self::Ply => Some(SurfaceFormat::Ply),
            Self::Stl => Some(SurfaceFormat::Stl),
            Self::Obj => Some(SurfaceFormat::Obj),
            Self::Node | Self::Poly | Self::Smesh | Self::Npyd => None,
        }
    }

    /// As a format of complexes.
    pub fn complex(self) -> Option<PlcFormat> {
        match self {
            Self::Poly => Some(PlcFormat::Poly),
            Self::Smesh => Some(PlcFormat::Smesh),
            _ => None,
        }
    }
}

/// Whether a path stands for a standard stream.
pub fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// Where the mesh goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// To a file.
    File(PathBuf),
    /// To `TetGen`'s family of files.
    Family(PathBuf),
    /// To standard output.
    Stream(MeshFormat),
}

impl Target {
    /// The target that was typed, where something can be written.
    pub fn of(path: &Path, named: Option<StreamFormat>) -> Result<Self, Failure> {
        if is_stream(path) {
            return match named {
                Some(StreamFormat::Vtu) => Ok(Self::Stream(MeshFormat::Vtu)),
                Some(StreamFormat::Msh) => Ok(Self::Stream(MeshFormat::Msh)),
                Some(StreamFormat::Msh2) => Ok(Self::Stream(MeshFormat::Msh2)),
                Some(StreamFormat::Mesh) => Ok(Self::Stream(MeshFormat::Medit)),
                None => Err(Failure::usage("standard output has no extension: name its format with --to")),
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

    /// Makes sure that none of the files of the input is replaced.
    pub fn ensure_apart(&self, input: &[PathBuf]) -> Result<(), Failure> {
        let base = match self {
            Self::Family(base) => base,
            Self::File(path) if input.contains(path) => {
                return Err(Failure::usage(format!(
                    "{} is the input and would be replaced: name another output",
                    path.display()
                )));
            }
            _ => return Ok(()),
        };
        match MeshFamily::paths(base).iter().find(|written| input.contains(written)) {
            Some(written) => Err(Failure::usage(format!(
                "{} belongs to the input and would be replaced: name another output, such as {}",
                written.display(),
                base.with_extension("1.ele").display()
            ))),
            None => Ok(()),
        }
    }
}
