//! What is typed.

use super::format::{InputFormat, StreamFormat};
use crate::cli::common::Common;
use crate::cli::layers::LayerArgs;
use crate::cli::page::ReportArgs;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A closed surface (.off, .ply, .stl, .obj), a complex of facets (TetGen's .poly, .smesh), points (.node), or any of
    /// these as arrays (.npyd, a folder); `-` for standard input
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Where the mesh goes: .vtu, .pvtu (pieces), .msh (Gmsh 4.1), .mesh (Medit), .ele (TetGen's files .node .ele .face
    /// .edge .neigh), .npyd (a folder of `NumPy`'s arrays); `-` for standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Format of the input, whatever its extension
    #[arg(long, value_name = "FORMAT")]
    pub from: Option<InputFormat>,
    /// Format of standard output
    #[arg(long, value_name = "FORMAT")]
    pub to: Option<StreamFormat>,
    /// Add no points but those that the surface needs, and leave the shape of tetrahedra as it is
    #[arg(long, conflicts_with_all = ["max_radius_edge", "min_dihedral", "max_volume", "size", "tetgen"])]
    pub no_refine: bool,
    /// Bound on circumradius over shortest edge, as far as the boundary allows
    #[arg(long, value_name = "RATIO", conflicts_with = "tetgen", allow_negative_numbers = true)]
    pub max_radius_edge: Option<f64>,
    /// Bound on the smallest dihedral angle in degrees, as far as the boundary allows
    #[arg(long, value_name = "DEGREES", conflicts_with = "tetgen", allow_negative_numbers = true)]
    pub min_dihedral: Option<f64>,
    /// Bound on the volume of a tetrahedron; exit 1 when it is not met
    #[arg(long, value_name = "VOLUME", conflicts_with = "tetgen", allow_negative_numbers = true)]
    pub max_volume: Option<f64>,
    /// Length of edges inside (default: as the surface has them nearby)
    #[arg(long, value_name = "LENGTH", conflicts_with = "tetgen", allow_negative_numbers = true)]
    pub size: Option<f64>,
    /// The input is a complex: facets may lie inside, dangle, and meet by threes (always so for .poly and .smesh)
    #[arg(long)]
    pub plc: bool,
    /// The triangles of the input may be split, as TetGen does without Y
    #[arg(long, conflicts_with = "tetgen")]
    pub split: bool,
    /// First orient the triangles and join what is there twice, bit for bit
    #[arg(long)]
    pub repair: bool,
    /// Refuse what is otherwise left out with a note: facets and segments outside of what is filled or in a hole, bytes
    /// behind the last triangle of a binary STL
    #[arg(long)]
    pub strict: bool,
    /// Check the input and stop
    #[arg(long)]
    pub check_only: bool,
    /// TetGen's switches instead of these options, such as pYq1.4a0.1
    #[arg(long, value_name = "SWITCHES", allow_hyphen_values = true)]
    pub tetgen: Option<String>,
    #[command(flatten)]
    pub layers: LayerArgs,
    #[command(flatten)]
    pub report: ReportArgs,
    #[command(flatten)]
    pub common: Common,
}
