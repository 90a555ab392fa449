//! Options of the command.

use super::format::{InputFormat, StreamFormat};
use super::seed;
use crate::cli::common::Common;
use crate::cli::layers::LayerArgs;
use crate::cli::numbers::{above_zero, number, of_region};
use crate::cli::order::OrderArgs;
use crate::cli::page::ReportArgs;
use anastomesh_mesh::Point3;
use anastomesh_tet::{Interior, Region, Tetrahedralizer};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Options of `--remesh-surface`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct RemeshArgs {
    /// Maximum distance from the input; `None`: the default.
    pub tolerance: Option<f64>,
}

impl RemeshArgs {
    /// Value that stands for the default tolerance.
    const DEFAULT: &str = "default";

    fn parse(text: &str) -> Result<Self, String> {
        if text == Self::DEFAULT {
            return Ok(Self { tolerance: None });
        }
        Ok(Self { tolerance: Some(above_zero(text)?) })
    }
}

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Closed surface (.off, .ply, .stl, .obj, .vtp), facet complex (.poly, .smesh), points (.node), or a folder of arrays of
    /// these (.npyd); `-` for standard input
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Further surfaces; all surfaces together are a facet complex, with the file names as markers
    #[arg(value_name = "IN")]
    pub others: Vec<PathBuf>,
    /// Output file: .vtu, .pvtu (pieces), .msh (Gmsh 4.1), .mesh (Medit), .ele (TetGen files .node .ele .face .edge
    /// .neigh), .npyd (folder of `NumPy` arrays); `-` for standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Divide the mesh into N balanced parts for parallel solvers: `processor` folders (.foam), pieces (.pvtu) or partitions
    /// (.msh) with ghost cells
    #[arg(long, value_name = "N")]
    pub parts: Option<NonZeroUsize>,
    #[command(flatten)]
    pub order: OrderArgs,
    /// Format of the input, overriding its extension
    #[arg(long, value_name = "FORMAT")]
    pub from: Option<InputFormat>,
    /// Format of standard output
    #[arg(long, value_name = "FORMAT")]
    pub to: Option<StreamFormat>,
    /// Add only points that the surface needs, and do not improve tetrahedra
    #[arg(long, conflicts_with_all = ["max_radius_edge", "min_dihedral", "max_volume", "size", "growth", "tetgen"])]
    pub no_refine: bool,
    /// Maximum ratio of circumradius to shortest edge, as far as the boundary allows
    #[arg(long, value_name = "RATIO", conflicts_with = "tetgen", allow_negative_numbers = true, value_parser = number)]
    pub max_radius_edge: Option<f64>,
    /// Minimum dihedral angle in degrees, as far as the boundary allows
    #[arg(long, value_name = "DEGREES", conflicts_with = "tetgen", allow_negative_numbers = true, value_parser = number)]
    pub min_dihedral: Option<f64>,
    /// Maximum volume of a tetrahedron; exit code 1 if violated
    #[arg(long, value_name = "VOLUME", conflicts_with = "tetgen", allow_negative_numbers = true, value_parser = number)]
    pub max_volume: Option<f64>,
    /// Maximum edge length in the interior (default: any that the growth gives)
    #[arg(long, value_name = "LENGTH", conflicts_with = "tetgen", allow_negative_numbers = true, value_parser = number)]
    pub size: Option<f64>,
    /// Maximum edge lengths on an earlier mesh (`.vtu`). Each place has that of the nearest point with a value
    #[arg(long, value_name = "FILE", requires = "array", conflicts_with_all = ["size", "uniform", "no_refine", "tetgen"])]
    pub sizes_from: Option<PathBuf>,
    /// Array of `--sizes-from`: an edge length for each point or each cell
    #[arg(long, value_name = "NAME", requires = "sizes_from")]
    pub array: Option<String>,
    /// Growth of edge lengths per layer of tetrahedra, away from the surface and from facets; at least 1.1
    #[arg(long, value_name = "FACTOR", default_value_t = Interior::GROWTH, value_parser = number)]
    pub growth: f64,
    /// Fill the interior evenly with the mean edge length of the surface, instead of growing tetrahedra
    #[arg(long, conflicts_with_all = ["growth", "no_refine", "tetgen"])]
    pub uniform: bool,
    /// Maximum edge length in the region with this number; repeat for further regions
    #[arg(long, value_name = "REGION=LENGTH", value_parser = of_region, conflicts_with = "no_refine")]
    pub region_size: Vec<(i32, f64)>,
    /// Growth in the region with this number, below that of --growth; repeat for further regions
    #[arg(long, value_name = "REGION=FACTOR", value_parser = of_region, conflicts_with = "no_refine")]
    pub region_growth: Vec<(i32, f64)>,
    /// Refuse meshes that would have more tetrahedra
    #[arg(long, value_name = "N", default_value_t = Tetrahedralizer::MAX_TETS)]
    pub max_tets: usize,
    /// Treat the input as a facet complex, which may have interior, dangling and non-manifold facets (default for .poly and .smesh)
    #[arg(long)]
    pub plc: bool,
    /// Point in a region: X,Y,Z, then optionally :id=N and :volume=MAX; repeatable
    #[arg(long, value_name = "POINT", allow_hyphen_values = true, value_parser = seed::region)]
    pub region: Vec<Region>,
    /// Point X,Y,Z in a hole of a facet complex; repeatable
    #[arg(long, value_name = "POINT", allow_hyphen_values = true, value_parser = seed::point)]
    pub hole: Vec<Point3>,
    /// Allow splitting of input triangles, as TetGen without -Y
    #[arg(long, conflicts_with = "tetgen")]
    pub split: bool,
    /// Remesh the surface within DIST (default: 0.001 of its diagonal)
    ///
    /// Edges above 40°, corners, edges between markers, and the topology stay. Edge lengths are those of --size or of the
    /// input, and less at curvature.
    #[arg(
        long,
        value_name = "DIST",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = RemeshArgs::DEFAULT,
        conflicts_with_all = ["split", "tetgen", "check_only"],
        value_parser = RemeshArgs::parse
    )]
    pub remesh_surface: Option<RemeshArgs>,
    /// Repair the input first: orient triangles, merge exact duplicates
    #[arg(long)]
    pub repair: bool,
    /// Fail instead of ignoring input: facets and segments outside the filled region or in a hole, and bytes after the last
    /// triangle of a binary STL
    #[arg(long)]
    pub strict: bool,
    /// Only check the input
    #[arg(long)]
    pub check_only: bool,
    /// TetGen switches instead of options, such as pYq1.4a0.1
    #[arg(long, value_name = "SWITCHES", allow_hyphen_values = true)]
    pub tetgen: Option<String>,
    #[command(flatten)]
    pub layers: LayerArgs,
    /// Markers or names of the parts that get layers, comma-separated (default: all). Layers end in rings on flat parts without
    /// layers
    #[arg(
        long,
        value_name = "PARTS",
        value_delimiter = ',',
        requires = "layers",
        help_heading = "Layers",
        allow_hyphen_values = true
    )]
    pub layers_on: Vec<String>,
    /// Numbers of the regions that get layers, comma-separated, such as the fluid (default: all, so that facets between regions
    /// have layers on both sides)
    #[arg(
        long,
        value_name = "REGIONS",
        value_delimiter = ',',
        requires = "layers",
        help_heading = "Layers",
        allow_hyphen_values = true
    )]
    pub layers_in: Vec<i32>,
    #[command(flatten)]
    pub report: ReportArgs,
    #[command(flatten)]
    pub common: Common,
}
