//! Options of VTK files, shared by commands that write them.

use anastomesh_io::volume::GridOptions;

#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = "VTU and PVTU")]
pub struct GridArgs {
    /// Round coordinates to 32 bits for smaller files; the check uses the exact coordinates
    #[arg(long)]
    float32: bool,
    /// Cells of the grid; with `tets`, the boundary is written to `MESH_boundary.vtp`
    #[arg(long, value_enum, default_value_t = Cells::All)]
    cells: Cells,
    /// Compression of arrays
    #[arg(long, value_enum, default_value_t = Compress::Zlib)]
    compress: Compress,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Cells {
    /// Tetrahedra and boundary triangles
    All,
    /// Tetrahedra only
    Tets,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Compress {
    /// Zlib
    Zlib,
    /// No compression
    None,
}

impl GridArgs {
    /// Options of the writer.
    pub fn options(self) -> GridOptions {
        GridOptions::default()
            .float32(self.float32)
            .tets_alone(self.cells == Cells::Tets)
            .raw(self.compress == Compress::None)
    }
}
