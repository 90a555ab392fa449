//! How VTK's files are written: arguments of every verb that writes some.

use anastomesh_io::volume::GridOptions;

#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = "VTU and PVTU")]
pub struct GridArgs {
    /// Round coordinates to 32 bits: files are smaller, and what was checked are the exact ones
    #[arg(long)]
    float32: bool,
    /// Cells of the grid; with `tets` the boundary goes into a file of its own, `MESH_boundary.vtp`
    #[arg(long, value_enum, default_value_t = Cells::All)]
    cells: Cells,
    /// How arrays stand in the file
    #[arg(long, value_enum, default_value_t = Compress::Zlib)]
    compress: Compress,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Cells {
    /// Tetrahedra, then the triangles of the boundary
    All,
    /// Tetrahedra alone
    Tets,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Compress {
    /// Compressed with zlib
    Zlib,
    /// As they are
    None,
}

impl GridArgs {
    /// The options of a writer.
    pub fn options(self) -> GridOptions {
        GridOptions::default()
            .float32(self.float32)
            .tets_alone(self.cells == Cells::Tets)
            .raw(self.compress == Compress::None)
    }
}
