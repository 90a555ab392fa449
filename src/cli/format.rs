//! Mesh format option, shared by commands that write meshes.

use super::exit::Failure;
use anastomesh_io::volume::MeshFormat;
use std::num::NonZeroUsize;
use std::path::Path;

#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub struct FormatArgs {
    /// Format of the mesh, overriding the extension: vtu, pvtu, msh (Gmsh 4.1), msh2 (Gmsh 2.2, text), medit, openfoam,
    /// simvascular, npy or tetgen
    #[arg(long, value_name = "FORMAT", value_parser = named)]
    pub format: Option<MeshFormat>,
    /// Write the prisms and pyramids of layers as whole cells, with their layer as cell data `layer` (VTU and PVTU), or without (MSH)
    #[arg(long)]
    pub prisms: bool,
    /// Divide the mesh into N balanced parts for parallel solvers: `processor` folders (.foam), pieces (.pvtu) or partitions
    /// (.msh) with ghost cells
    #[arg(long, value_name = "N")]
    pub parts: Option<NonZeroUsize>,
}

fn named(name: &str) -> Result<MeshFormat, String> {
    let known = || MeshFormat::names().collect::<Vec<_>>().join(", ");
    MeshFormat::named(name).ok_or_else(|| format!("known formats: {}", known()))
}

impl FormatArgs {
    /// Returns the format of an output file.
    pub fn of(self, path: &Path) -> Result<MeshFormat, Failure> {
        let format = match self.format {
            Some(format) => format,
            None => MeshFormat::of(path).map_err(|e| Failure::input(e.to_string()))?,
        };
        if self.prisms && !matches!(format, MeshFormat::Vtu | MeshFormat::Pvtu | MeshFormat::Msh | MeshFormat::Msh2) {
            return Err(Failure::usage("--prisms is not supported by this format: use .vtu, .pvtu or .msh"));
        }
        self.check_parts(format)?;
        Ok(format)
    }

    fn check_parts(self, format: MeshFormat) -> Result<(), Failure> {
        if self.parts.is_some() && !format.has_parts() {
            return Err(Failure::usage(NO_PARTS));
        }
        if self.parts.is_some() && self.prisms {
            return Err(Failure::usage(
                "--parts does not combine with --prisms; OpenFOAM cases have prisms in any case",
            ));
        }
        Ok(())
    }
}

/// Message about a format without parts.
pub const NO_PARTS: &str = "--parts is not supported by this format: use .foam, .pvtu or .msh";
