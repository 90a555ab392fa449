//! The format of a mesh where its extension is not to tell: an argument of every verb that writes meshes.

use super::exit::Failure;
use anastomesh_io::volume::MeshFormat;
use std::path::Path;

#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub struct FormatArgs {
    /// Format of the mesh, whatever its extension: vtu, pvtu, msh (Gmsh 4.1), msh2 (Gmsh 2.2, text; programs that read it want
    /// .msh), medit, openfoam, simvascular, npy or tetgen
    #[arg(long, value_name = "FORMAT", value_parser = named)]
    pub format: Option<MeshFormat>,
}

fn named(name: &str) -> Result<MeshFormat, String> {
    let known = || MeshFormat::names().collect::<Vec<_>>().join(", ");
    MeshFormat::named(name).ok_or_else(|| format!("what is known is {}", known()))
}

impl FormatArgs {
    /// The format in which a file is written.
    pub fn of(self, path: &Path) -> Result<MeshFormat, Failure> {
        match self.format {
            Some(format) => Ok(format),
            None => MeshFormat::of(path).map_err(|e| Failure::input(e.to_string())),
        }
    }
}
