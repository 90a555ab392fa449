//! Mesh format option, shared by commands that write meshes.

use super::exit::Failure;
use anastomesh_io::volume::MeshFormat;
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
        Ok(format)
    }
}
