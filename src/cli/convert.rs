//! `anastomesh convert`: conversion of file formats, and of volume meshes to their boundary.

use std::path::{Path, PathBuf};
use std::{fmt, iter};

use serde::Serialize;

use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::fidelity::conclude;
use super::format::{FormatArgs, NO_PARTS};
use super::grid::GridArgs;
use super::hint;
use super::kind::{FileKind, OpenedMesh, boundary_of};
use super::limits;
use super::log;
use super::progress::Bars;
use super::stop::{NOTHING_KEPT, Stop};
use crate::report::rows::row;
use crate::report::verdict::Verdict;
use anastomesh_io::OutputSet;
use anastomesh_io::network::{NetworkOptions, ensure_tree_writable, read_network, write_tree};
use anastomesh_io::npy;
use anastomesh_io::surface::{
    SurfaceFormat, ensure_boundary_writable, read_surface, write_boundary_watched, write_surface,
};
use anastomesh_io::volume::{MeshFormat, MeshNotes, WriteOptions, ensure_writable_as, stage_mesh, stage_regions};
use anastomesh_mesh::boundary::{BoundaryPart, BoundarySurface};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::source::{MeshSource, SourceCounts};
use anastomesh_mesh::units::{counted, tetrahedra};
use anastomesh_network::directed;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Input file. Volume mesh: .vtu, .pvtu, .msh, .mesh, .ele, .npyd. Surface: .stl, .ply, .obj, .off. Network: .swc, .vtp,
    /// .vtk, .am, .csv, .graphml, .gxl, .net, .json, .vmv, .h5, .npyd, .in, .edge
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Output file. For a volume mesh: a mesh format, or a surface format for its boundary. For a surface: .stl, .ply, .obj,
    /// .off, .glb, .3mf, .vtp. For a network: .vtp, .npyd or, for a tree, .swc
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    format: FormatArgs,
    /// Write only the wall (patch 1) of the boundary, without inlets and outlets
    #[arg(long)]
    no_caps: bool,
    /// Write each region to a file beside the output, too: `OUT_lumen.vtu`, `OUT_wall.vtu`, …. Points and cells have their
    /// numbers in the whole mesh (`GlobalNodeID`, `GlobalElementID`)
    #[arg(long)]
    split_regions: bool,
    /// Memory limit for VTU files of `mesh`, which are then read block by block. Other files are loaded completely
    #[arg(long, value_name = "SIZE", default_value = "2GiB", value_parser = limits::size)]
    memory: u64,
    #[command(flatten)]
    grid: GridArgs,
    #[command(flatten)]
    common: Common,
}

/// Conversion that needs meshing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{from} cannot be converted to {to}{}", instead(*.from, *.to))]
struct Unlike {
    from: FileKind,
    to: FileKind,
}

fn instead(from: FileKind, to: FileKind) -> &'static str {
    match (from, to) {
        (FileKind::Network, FileKind::Mesh) => "; use `anastomesh mesh`",
        (FileKind::Network, FileKind::Surface) => "; use `anastomesh surface`",
        (FileKind::Surface, FileKind::Mesh) => "; use `anastomesh tetrahedralize`",
        _ => "",
    }
}

/// Output of `--json`.
#[derive(Serialize)]
struct Output {
    program: &'static str,
    from: FileKind,
    to: FileKind,
    #[serde(flatten)]
    counts: Written,
    /// Files of the regions.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    regions: Vec<PathBuf>,
}

/// Size of the written data.
#[derive(Serialize)]
#[serde(untagged)]
enum Written {
    Mesh { points: usize, tets: usize, boundary_faces: usize },
    Surface { points: usize, triangles: usize },
    Network { nodes: usize, edges: usize },
}

impl Written {
    /// Size of a mesh.
    fn of(mesh: &dyn MeshSource) -> Self {
        let SourceCounts { points, tets, boundary } = mesh.counts();
        Self::Mesh { points, tets, boundary_faces: boundary }
    }
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&match *self {
            Self::Mesh { points, tets, boundary_faces } => {
                let (points, faces) = (counted(points, "point"), counted(boundary_faces, "boundary face"));
                row("mesh", &format!("{}, {points}, {faces}", tetrahedra(tets)))
            }
            Self::Surface { points, triangles } => {
                row("surface", &format!("{}, {}", counted(points, "point"), counted(triangles, "triangle")))
            }
            Self::Network { nodes, edges } => {
                row("network", &format!("{}, {}", counted(nodes, "node"), counted(edges, "edge")))
            }
        })
    }
}

/// Converts a file.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let from = FileKind::of(&args.input, "convert")?;
    let to = args.target(from)?;
    let pool = thread_pool(args.common.threads)?;
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(args.common.quiet, args.common.progress, stop.clone());
    stop.keep();
    let (counts, regions) = pool.install(|| match from {
        FileKind::Mesh => args.convert_mesh(to, &bars),
        FileKind::Surface => args.convert_surface(&bars).map(|counts| (counts, Vec::new())),
        FileKind::Network => args.convert_network().map(|counts| (counts, Vec::new())),
    })?;
    if args.common.json {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
        print(true, &Output { program, from, to, counts, regions }, String::new)?;
    } else if !args.common.quiet {
        let files: Vec<&Path> = iter::once(&args.output).chain(&regions).map(PathBuf::as_path).collect();
        log::result(&format!("{counts}{}", ended(&files).rows(&[])));
    }
    Ok(conclude(&args.common, &Verdict::good("converted")))
}

impl Args {
    /// Kind of the output; checks that it can be written.
    fn target(&self, from: FileKind) -> Result<FileKind, Failure> {
        let path = &self.output;
        // A .vtp file contains a network or a surface, depending on the input.
        let to = match FileKind::of(path, "convert") {
            _ if self.format.format.is_some() => FileKind::Mesh,
            _ if npy::is_folder(path) => from,
            // Some surface formats can only be written.
            Ok(FileKind::Network) | Err(_) if from != FileKind::Network => FileKind::Surface,
            found => found?,
        };
        match (from, to) {
            (FileKind::Mesh, FileKind::Mesh) => {
                ensure_writable_as(self.format.of(path)?, path).map_err(|e| e.to_string())
            }
            (FileKind::Mesh | FileKind::Surface, FileKind::Surface) => {
                ensure_boundary_writable(path).map_err(|e| e.to_string())
            }
            (FileKind::Network, FileKind::Network) => ensure_tree_writable(path).map_err(|e| e.to_string()),
            (from, to) => return Err(Failure::usage(Unlike { from, to }.to_string())),
        }
        .map_err(Failure::input)?;
        if self.format.parts.is_some() && to != FileKind::Mesh {
            return Err(Failure::usage(NO_PARTS));
        }
        if self.split_regions && (from, to) != (FileKind::Mesh, FileKind::Mesh) {
            return Err(Failure::usage("--split-regions needs a volume mesh as input and as output"));
        }
        Ok(to)
    }

    /// Returns the files of the regions, too.
    fn convert_mesh(&self, to: FileKind, bars: &Bars) -> Result<(Written, Vec<PathBuf>), Failure> {
        let stopped = |failure| if bars.is_cancelled() { Failure::stopped(NOTHING_KEPT) } else { failure };
        let mut opened = OpenedMesh::open(&self.input, self.memory).map_err(stopped)?;
        if to == FileKind::Surface {
            opened.label_boundary();
        }
        let (mesh, notes) = ((opened.source(), self.kept_midpoints(&opened, to)?), opened.notes());
        if !self.split_regions {
            return Ok((self.write(mesh, notes, to, bars)?, Vec::new()));
        }
        let regions = stage_regions(&self.output, mesh.0, notes, self.grid.options(), bars);
        let (regions, mut outputs) = regions.map_err(|e| failed(&e, bars))?;
        outputs.append(self.stage(mesh, notes, bars)?);
        outputs.place()?;
        Ok((Written::of(mesh.0), regions))
    }

    /// Midpoints to write: those of a second-order mesh, if the output can hold them. Warns if it cannot.
    fn kept_midpoints<'a>(&self, opened: &'a OpenedMesh, to: FileKind) -> Result<Option<&'a SecondOrder>, Failure> {
        let Some(second) = opened.second_order() else { return Ok(None) };
        let divides = self.format.prisms || self.format.parts.is_some();
        if to == FileKind::Mesh && !divides {
            let format = self.format.of(&self.output)?;
            let is_coupled = format == MeshFormat::SimVascular && !opened.notes().regions.is_empty();
            if format.has_second_order() && !is_coupled {
                return Ok(Some(second));
            }
        }
        log::warning(&format!(
            "{}: midpoints of second-order elements left out: the output is linear",
            self.output.display()
        ));
        Ok(None)
    }

    /// Writes the mesh under a temporary name.
    fn stage(
        &self,
        (mesh, second): (&dyn MeshSource, Option<&SecondOrder>),
        notes: &MeshNotes,
        bars: &Bars,
    ) -> Result<OutputSet, Failure> {
        let remark = |text: &str| bars.note(&format!("{}: {text}", self.output.display()));
        let options = WriteOptions::default()
            .format(self.format.format)
            .memory((self.memory / 4) as usize)
            .grid(self.grid.options())
            .prisms(self.format.prisms)
            .parts(self.format.parts)
            .second_order(second)
            .remark(&remark as &dyn Fn(&str));
        stage_mesh(&options, &self.output, mesh, notes, bars).map_err(|e| failed(&e, bars))
    }

    fn write(
        &self,
        (mesh, second): (&dyn MeshSource, Option<&SecondOrder>),
        notes: &MeshNotes,
        to: FileKind,
        bars: &Bars,
    ) -> Result<Written, Failure> {
        if to == FileKind::Mesh {
            self.stage((mesh, second), notes, bars)?.place()?;
            return Ok(Written::of(mesh));
        }
        let faces = if self.no_caps { BoundaryPart::Wall } else { BoundaryPart::Whole };
        let surface = BoundarySurface::new(mesh, faces)
            .map_err(|e| failed(&format!("{}: {e}; run `anastomesh check`", self.input.display()), bars))?;
        write_boundary_watched(&self.output, &surface, notes, bars).map_err(|e| failed(&e, bars))?;
        let SourceCounts { points, boundary, .. } = surface.counts();
        Ok(Written::Surface { points, triangles: boundary })
    }

    fn convert_surface(&self, bars: &Bars) -> Result<Written, Failure> {
        let mesh = read_surface(&self.input).map_err(|e| failed(&e, bars))?;
        if SurfaceFormat::of(&self.output).is_ok() {
            write_surface(&self.output, &mesh).map_err(|e| failed(&e, bars))?;
            return Ok(Written::Surface { points: mesh.points.len(), triangles: mesh.triangles.len() });
        }
        self.write((&boundary_of(mesh), None), &MeshNotes::default(), FileKind::Surface, bars)
    }

    fn convert_network(&self) -> Result<Written, Failure> {
        // Conversion accepts radii that are invalid for meshing.
        let options = NetworkOptions::default().any_radii(true);
        let file = read_network(&self.input, &options).map_err(|e| Failure::input(hint::of_file(&e)))?;
        let network = directed(&file.skeleton);
        write_tree(&self.output, &network, &[]).map_err(|e| Failure::input(e.to_string()))?;
        Ok(Written::Network { nodes: network.nodes.len(), edges: network.edges.len() })
    }
}

fn failed(error: &dyn fmt::Display, bars: &Bars) -> Failure {
    if bars.is_cancelled() { Failure::stopped(NOTHING_KEPT) } else { Failure::input(error.to_string()) }
}
