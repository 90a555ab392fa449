//! Options for block meshing, shared by all commands that mesh networks.

use super::exit::Failure;
use super::limits::size;
use super::log;
use super::network::NetworkArgs;
use super::numbers::number;
use crate::pipeline::{Estimate, MeshPlan, RunReport, TooLarge};
use crate::report::advice::advice;
use anastomesh_io::network::NetworkFile;
use anastomesh_io::results::read_lengths;
use anastomesh_skeleton::resolution::{FOLLOW, RHO};
use anastomesh_skeleton::{BadSize, NodeSizes, SizeAt, SizeField};
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Value of `--size-at`.
#[derive(Clone, Debug, PartialEq)]
pub enum SizeArg {
    /// Factor at bifurcations.
    Forks(f64),
    /// Name of a node array.
    Array(String),
}

impl FromStr for SizeArg {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(text.parse().map_or_else(|_| Self::Array(text.to_owned()), Self::Forks))
    }
}

impl fmt::Display for SizeArg {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Forks(factor) => write!(f, "{factor}"),
            Self::Array(name) => write!(f, "{name}"),
        }
    }
}

impl SizeArg {
    /// Size field as far as known before the network is read.
    fn planned(&self) -> Option<SizeAt> {
        match self {
            Self::Forks(factor) => Some(SizeAt::Forks(*factor)),
            Self::Array(name) => NodeSizes::new(name, &[]).ok().map(SizeAt::Nodes),
        }
    }
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Blocks")]
pub struct BlockArgs {
    /// Resolution: grid cells across the thinnest vessel of a block; larger is finer
    #[arg(long, default_value_t = RHO, allow_negative_numbers = true, value_parser = number)]
    pub rho: f64,
    /// Dependence of edge lengths on the vessel radius: 1 proportional, 0 uniform within a block
    #[arg(long, default_value_t = FOLLOW, allow_negative_numbers = true, value_parser = number)]
    pub follow: f64,
    /// Aspect ratio of tetrahedra along tubes between bifurcations and caps: 1 to 20
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true, value_parser = number)]
    pub stretch: f64,
    /// Factor on edge lengths at bifurcations, 0.25 to 1, or a node array of factors. Array values below 1 refine
    /// bifurcations, values above 1 stretch tubes
    #[arg(long, value_name = "FACTOR|ARRAY", allow_negative_numbers = true)]
    pub size_at: Option<SizeArg>,
    /// Edge lengths on an earlier mesh (`.vtu`). Edges are shorter where `--array` has less than the resolution gives
    #[arg(long, value_name = "FILE", conflicts_with = "size_at", requires = "array")]
    pub sizes_from: Option<PathBuf>,
    /// Array of `--sizes-from`: an edge length for each point or each cell
    #[arg(long, value_name = "NAME", requires = "sizes_from")]
    pub array: Option<String>,
    /// Memory limit, such as 2GiB or 500MB (default: 2GiB)
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub memory: Option<u64>,
    /// Move overlapping vessels apart before meshing, in at most N iterations
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "200")]
    pub refine: Option<usize>,
    /// Mesh without the failed blocks, list them, and exit with code 4
    #[arg(long)]
    pub keep_going: bool,
}

impl BlockArgs {
    /// Prints advice.
    pub fn advise(&self, run: &RunReport, invalid: bool) {
        for line in self.advice(run, invalid) {
            log::note(&line);
        }
    }

    /// Options that may help.
    pub fn advice(&self, run: &RunReport, invalid: bool) -> Vec<String> {
        advice(run, invalid, self.refine.is_some(), self.rho)
    }

    /// Memory limit in bytes.
    pub fn memory(&self) -> u64 {
        self.memory.unwrap_or(MeshPlan::default().memory)
    }

    /// Checks that regions around the lumen fit into the memory limit, if one is given.
    pub fn regions_fit(&self, estimate: &Estimate) -> Result<(), TooLarge> {
        match self.memory {
            Some(memory) if estimate.regions_bytes > memory => Err(TooLarge::Regions { estimate: *estimate, memory }),
            _ => Ok(()),
        }
    }

    /// Plan of these options. `fuse`: vessels that still overlap after refinement are meshed as one lumen.
    pub fn plan(&self, fuse: bool) -> MeshPlan {
        MeshPlan {
            rho: self.rho,
            follow: self.follow,
            stretch: self.stretch,
            size_at: self.size_at.as_ref().and_then(SizeArg::planned),
            memory: self.memory(),
            fuse: self.refine.is_some() && fuse,
            keep_going: self.keep_going,
            ..MeshPlan::default()
        }
    }

    /// Reads the network and the requested edge lengths, which it puts into the plan.
    pub fn read(&self, network: &NetworkArgs, any_radii: bool, plan: &mut MeshPlan) -> Result<NetworkFile, Failure> {
        if let (Some(path), Some(array)) = (&self.sizes_from, &self.array) {
            plan.size_at = Some(SizeAt::Field(size_field(path, array)?));
        }
        let Some(SizeArg::Array(array)) = &self.size_at else { return network.file(any_radii) };
        let options = network.options(any_radii).node_array(Some(array.clone()));
        let file = network.file_with(&options)?;
        plan.size_at = Some(sizes(array, &file)?);
        Ok(file)
    }

    /// Options that the mesh depends on, as command-line text. It does not depend on the refinement if the network was meshed
    /// as given.
    pub fn typed(&self, is_refined: bool) -> String {
        let refine = self.refine.filter(|_| is_refined).map_or_else(String::new, |n| format!(" --refine {n}"));
        let stretch = if self.stretch == 1.0 { String::new() } else { format!(" --stretch {}", self.stretch) };
        let size = match (&self.size_at, &self.sizes_from, &self.array) {
            (Some(size), ..) => format!(" --size-at {size}"),
            (None, Some(path), Some(array)) => format!(" --sizes-from {} --array {array}", path.display()),
            _ => String::new(),
        };
        format!("--rho {} --follow {}{stretch}{size}{refine}", self.rho, self.follow)
    }
}

/// Size field of a node array of the file.
fn sizes(array: &str, file: &NetworkFile) -> Result<SizeAt, Failure> {
    let sizes = NodeSizes::new(array, &file.node_values).map_err(|BadSize { node, value }| {
        Failure::input(format!(
            "--size-at {array}: node {} has the value {value}: give finite numbers above zero (1: no change)",
            file.names.of(node)
        ))
    });
    sizes.map(SizeAt::Nodes)
}

/// Size field of an array on an earlier mesh.
pub fn size_field(path: &Path, array: &str) -> Result<SizeField, Failure> {
    let (points, lengths) = read_lengths(path, array).map_err(|e| Failure::input(e.to_string()))?;
    SizeField::new(array, &points, &lengths).map_err(|e| Failure::input(format!("{}: {e}", path.display())))
}
